"""The one function of the subpackage."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kanegen.choices import require_one
from kanegen.errors import ArrayError, OptionError
from kanegen.library import Library
from kanegen.library.simulation import adaptive, fixed
from kanegen.library.simulation.motion import Effort, Motion, State, Told, speeds_are_rates
from kanegen.library.simulation.steps import Leapfrog, Step, runge_kutta, semi_implicit_euler
from kanegen.library.simulation.trajectory import Trajectory
from kanegen.model import arguments
from kanegen.model.arguments import Floats
from kanegen.model.arrays import Floats as Doubles
from kanegen.program import precision as precisions

ADAPTIVE = ("DOP853", "Radau")
"""Solvers of SciPy: explicit of order 8, and implicit of order 5 for stiff systems."""

METHODS = ("RK4", "semi-implicit Euler", "leapfrog", *ADAPTIVE)
"""What `simulate` can do; the first three take a step, the others a tolerance."""

TOLERANCE = 1e-10


def simulate(
    library: Library,
    x: ArrayLike,
    y: ArrayLike,
    times: ArrayLike,
    method: str = "RK4",
    *,
    step: float | None = None,
    tolerance: float | None = None,
    compensated: bool = False,
    effort: Effort | None = None,
    prescribed: Told | None = None,
) -> Trajectory:
    """The motion of a compiled model from one state, or from B of them.

    Args:
        library: With the output `forward_dynamics`, and `coordinate_rates` where speeds are not rates of
            coordinates. Fixed steps are taken in the precision of its arrays.
        x: (m,) or (B, m) coordinates at the first time, rad, m or 1; B with fixed steps only.
        y: (n,) or (B, n) generalized speeds, rad/s and m/s.
        times: (T,) increasing, s: where states are wanted, the first being that of `x` and `y`.
        method: One of `METHODS`. "RK4" is of order 4; "semi-implicit Euler" of order 1 and "leapfrog" of
            order 2 keep the energy of a conservative system near its value for a very long time.
        step: Largest fixed step, s; every interval of `times` is cut into equal steps.
        tolerance: Relative and absolute error of a step of the adaptive methods, 1e-13 to 0.1; by default
            1e-10.
        compensated: Add fixed steps to the state with Kahan's sum: in long simulations what additions round
            off is most of the error, above all in single precision.
        effort: tau(t, x, y): generalized forces beside gravity, of the shape of `y`; by default none.
        prescribed: told(t): (3, p) values, rates and second derivatives of the prescribed freedoms, where
            there are any. With the output `prescribed_efforts` their work counts as that of efforts.

    Raises:
        ArrayError: If an array has the wrong shape or type.
        OptionError: If an option does not exist, or does not fit the method or the library, or the system
            has prescribed freedoms.
        MissingError: If an adaptive method is asked for and SciPy is not installed.
        SingularError: If [A] becomes singular or the state stops being finite; says when.
    """
    _check(method, step, tolerance, compensated, effort)
    _check_library(library, method)
    _check_prescribed(library, prescribed)
    start_x, start_y = _state(library, x, y)
    moments = _times(times)
    state = State(start_x.shape[-1])
    motion = Motion(library, state, effort, prescribed)
    start = state.join(start_x, start_y, np.zeros(start_y.shape[:-1], start_y.dtype))
    states: Floats
    if step is None:
        if start.ndim > 1:
            raise ArrayError(f"x: method {method!r} takes one state, got {len(start)}.")
        states = adaptive.integrate(motion, start, moments, method, tolerance or TOLERANCE)
    else:
        states = fixed.integrate(motion, start, moments, _fixed(method), step, compensated)
    told = None if prescribed is None else np.array([prescribed(time) for time in moments], start.dtype)
    found = state.x(states), state.y(states), states[..., -1]
    return Trajectory(library, moments, *found, motion.evaluations, told)


def _fixed(method: str) -> Step:
    if method == "leapfrog":
        return Leapfrog()
    return {"RK4": runge_kutta, "semi-implicit Euler": semi_implicit_euler}[method]


def _check(
    method: str, step: float | None, tolerance: float | None, compensated: bool, effort: Effort | None
) -> None:
    require_one("method", method, METHODS)
    if method in ADAPTIVE:
        if step is not None or compensated:
            raise OptionError(
                f"method {method!r} chooses its steps: give a tolerance, not a step or compensated."
            )
        if tolerance is not None and not 1e-13 <= _number("tolerance", tolerance) <= 0.1:
            raise OptionError(f"tolerance: {tolerance!r} is not between 1e-13 and 0.1.")
    elif tolerance is not None:
        raise OptionError(f"method {method!r} has fixed steps: give a step, not a tolerance.")
    elif step is None or not 0 < _number("step", step) < math.inf:
        raise OptionError(f"step: method {method!r} needs a positive number of seconds, got {step!r}.")
    if effort is not None and not callable(effort):
        raise OptionError(f"effort: {effort!r} cannot be called. Give a function of t, x and y.")


def _number(what: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float | np.number):
        raise OptionError(f"{what}: {value!r} is not a number.")
    return float(value)


def _check_library(library: Library, method: str) -> None:
    if not isinstance(library, Library):
        raise OptionError(
            f'{library!r} is no library. Make one with kg.build(system, ("forward_dynamics",)).'
        )
    if "forward_dynamics" not in library.outputs:
        raise OptionError(
            f"system {library.name!r} was built without the output 'forward_dynamics'. It has "
            f"{', '.join(library.outputs)}; ask for more with outputs=(...)."
        )
    if not speeds_are_rates(library):
        if method == "leapfrog":
            raise OptionError("method 'leapfrog' is for speeds that are rates of coordinates. Take 'RK4'.")
        if "coordinate_rates" not in library.outputs:
            raise OptionError(
                f"system {library.name!r} has speeds that are no rates of coordinates, and was built without "
                "the output 'coordinate_rates'. Ask for it with outputs=(...)."
            )
    if library.storage == "double-double":
        raise OptionError(
            f'the arrays of system {library.name!r} hold pairs of doubles. Build it with storage="double".'
        )
    if method in ADAPTIVE and library.storage != "double":
        raise OptionError(
            f"method {method!r} computes with doubles, but the arrays of system {library.name!r} are "
            f'{library.storage!r}. Build it with storage="double", or take fixed steps.'
        )


def _check_prescribed(library: Library, prescribed: Told | None) -> None:
    names = ", ".join(library.prescribed_names)
    if prescribed is None and names:
        raise OptionError(
            f"system {library.name!r} has prescribed freedoms ({names}). Say how they move: prescribed=told, "
            "a function of the time that gives their values, rates and second derivatives."
        )
    if prescribed is not None and not names:
        raise OptionError(f"prescribed: no freedom of system {library.name!r} is prescribed. Leave it out.")
    if prescribed is not None and not callable(prescribed):
        raise OptionError(f"prescribed: {prescribed!r} cannot be called. Give a function of t.")


def _state(library: Library, x: ArrayLike, y: ArrayLike) -> tuple[Floats, Floats]:
    dtype = precisions.precision_named(library.storage).dtype
    first = arguments.state("x", x, (len(library.coordinate_names),), dtype)
    second = arguments.companion("y", y, (library.n,), first.shape[:-1], dtype, "x")
    for name, array in (("x", first), ("y", second)):
        if not np.isfinite(array).all():
            raise ArrayError(f"{name}: the first state is not finite.")
    return first, second


def _times(times: ArrayLike) -> Doubles:
    moments: Doubles = np.asarray(arguments.floats("times", times, np.dtype(np.float64)), np.float64)
    if moments.ndim != 1 or len(moments) < 2:
        raise ArrayError(f"times: expected at least two in one row, got shape {moments.shape}.")
    if not (np.isfinite(moments).all() and (np.diff(moments) > 0).all()):
        raise ArrayError("times: they must be finite and increase from each to the next.")
    return moments
