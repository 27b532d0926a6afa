"""`simulate`, the entry of the package: checks its arguments, integrates, and returns a trajectory."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kanegen.choices import require_one
from kanegen.errors import ArrayError, ModelError, OptionError, quoted
from kanegen.library import Library
from kanegen.model import arguments
from kanegen.model.arguments import Floats
from kanegen.model.arrays import Floats as Doubles
from kanegen.model.numbers import finite
from kanegen.program import precision as precisions
from kanegen.simulation.integration import (
    Leapfrog,
    Step,
    implicit_midpoint,
    integrate_adaptively,
    integrate_fixed,
    runge_kutta,
    semi_implicit_euler,
)
from kanegen.simulation.motion import (
    Effort,
    Motion,
    PrescribedMotion,
    StateLayout,
    speeds_are_rates,
)
from kanegen.simulation.trajectory import Trajectory

ADAPTIVE = ("DOP853", "Radau")
"""Solvers of SciPy: an explicit one of order 8, and an implicit one of order 5 for stiff systems."""

FIXED: dict[str, Callable[[], Step]] = {
    "RK4": lambda: runge_kutta,
    "semi-implicit Euler": lambda: semi_implicit_euler,
    "leapfrog": Leapfrog,
    "implicit midpoint": lambda: implicit_midpoint,
}
"""Functions that return the step of each method with fixed steps."""

METHODS = (*FIXED, *ADAPTIVE)
"""Methods of `simulate`: those with fixed steps, and those with a tolerance."""

OF_MOTION = ("forward_dynamics", "coordinate_rates")
"""Outputs that a simulation needs; tables and files contain the others."""

TOLERANCE = 1e-10
"""Tolerance of the adaptive methods unless another is given."""


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
    prescribed: PrescribedMotion | None = None,
) -> Trajectory:
    """Integrate the motion of a compiled model from one state, or from B of them at once.

    Args:
        library: Library with the output `forward_dynamics`, and `coordinate_rates` if speeds are not the
            rates of coordinates. Fixed steps are computed in the precision of its arrays.
        x: (m,) or (B, m) coordinates at the first time, rad, m or 1; (B, m) with fixed steps only.
        y: (n,) or (B, n) generalized speeds at the first time, rad/s and m/s.
        times: (T,) increasing times at which states are wanted, s; the first is that of `x` and `y`.
        method: One of `METHODS`. With fixed steps, "RK4" is of order 4 and has the smallest errors for its
            cost; "implicit midpoint" of order 2, symmetric in time, keeps the energy of a conservative system
            near its value in long motions, at about 7 evaluations a step; "leapfrog" of order 2 and
            "semi-implicit Euler" of order 1 do so only where [A] is constant and forces depend on {x} alone,
            else the energy drifts (docs/accuracy.md has figures). SciPy's adaptive methods are "DOP853",
            explicit and of order 8, and "Radau", implicit and of order 5, for stiff systems.
        step: Largest fixed step, s; every interval between two times is cut into equal steps.
        tolerance: Relative and absolute error of a step of the adaptive methods, from 1e-13 to 0.1; 1e-10 by
            default.
        compensated: Whether fixed steps are added to the state with Kahan's compensated sum. In long
            simulations the rounding errors of these additions are most of the error, above all in single
            precision.
        effort: Function of t, x and y that returns generalized forces beside loads and gravity, of the shape
            of `y`; none by default.
        prescribed: Function of t that returns (3, p) values, rates and second derivatives of the prescribed
            freedoms. If the library has the output `prescribed_efforts`, their work counts as that of
            efforts.

    Raises:
        ArrayError: If an array has the wrong shape or type.
        OptionError: If an option does not exist, or does not fit the method or the library, or the motion of
            prescribed freedoms is missing.
        MissingError: If an adaptive method is asked for and SciPy is not installed.
        SingularError: If [A] becomes singular or the method gives up; the message has the time.
        StatusError: If accelerations or the state stop being finite, also where the library ignores that; or
            if accelerations may be inaccurate and the library raises on that. One that warns gives one
            warning for all, with the first time.

    Example:
        library = kg.build(system, outputs=("forward_dynamics", "kinetic_energy", "potential_energy"))
        trajectory = kg.simulate(library, [0.1, 0.2], [0.0, 0.0], np.linspace(0, 10, 101), step=1e-3)
        print(trajectory.energy_drift)
    """
    _check_method(method, step, tolerance, compensated, effort)
    _check_library(library, method)
    _check_prescribed(library, prescribed)
    start_x, start_y = _first_state(library, x, y)
    moments = _times(times)
    layout = StateLayout.of(library)
    motion = Motion(library, layout, effort, prescribed)
    start = layout.join(start_x, start_y, np.zeros(start_y.shape[:-1], start_y.dtype))
    states: Floats
    if step is None:
        if start.ndim > 1:
            raise ArrayError(f"x: method {method!r} takes one state, got {len(start)}.")
        states = integrate_adaptively(motion, start, moments, method, tolerance or TOLERANCE)
    else:
        states = integrate_fixed(motion, start, moments, FIXED[method](), step, compensated)
    motion.report_inaccurate()
    inputs: dict[str, Floats] = {}
    if prescribed is not None:
        inputs["prescribed"] = np.array([prescribed(time) for time in moments], start.dtype)
    coordinates = layout.x(states)
    if layout.homogeneous:
        factors = layout.lengths(start_x) / layout.lengths(coordinates)
        coordinates = layout.scaled(coordinates, factors)
    found = coordinates, layout.y(states), states[..., -1]
    if effort is not None:
        rows = zip(moments.tolist(), *found[:2], strict=True)
        inputs["tau"] = np.array([np.broadcast_to(effort(t, x, y), y.shape) for t, x, y in rows], start.dtype)
    setting = f"step {step:g} s" if step is not None else f"tolerance {tolerance or TOLERANCE:g}"
    outputs = tuple(name for name in library.outputs if name not in OF_MOTION)
    return Trajectory(library, moments, *found, motion.evaluations, inputs, f"{method}, {setting}", outputs)


def _check_method(
    method: str, step: float | None, tolerance: float | None, compensated: bool, effort: Effort | None
) -> None:
    """Make sure that the method exists and that its options fit it."""
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
        raise OptionError(f"step: method {method!r} needs a positive number of seconds, got {quoted(step)}.")
    if effort is not None and not callable(effort):
        raise OptionError(f"effort: {effort!r} cannot be called. Give a function of t, x and y.")


def _number(name: str, value: Any) -> float:
    """Return `value` as a float; `name` is that of the argument, for the error message."""
    try:
        return finite(value, name)
    except ModelError as error:
        raise OptionError(str(error)) from None


def _check_library(library: Library, method: str) -> None:
    """Make sure that the library has the outputs and the precision that the method needs."""
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
            f"the arrays of system {library.name!r} hold double-double numbers. Build it with "
            'storage="double".'
        )
    if method in ADAPTIVE and library.storage != "double":
        raise OptionError(
            f"method {method!r} computes with doubles, but the arrays of system {library.name!r} are "
            f'{library.storage!r}. Build it with storage="double", or take fixed steps.'
        )


def _check_prescribed(library: Library, prescribed: PrescribedMotion | None) -> None:
    """Make sure that the motion of prescribed freedoms is given exactly if there are any."""
    names = ", ".join(library.prescribed_names)
    if prescribed is None and names:
        raise OptionError(
            f"system {library.name!r} has prescribed freedoms ({names}). Say how they move: "
            "prescribed=motion, a function of the time that returns values, rates and second derivatives."
        )
    if prescribed is not None and not names:
        raise OptionError(f"prescribed: no freedom of system {library.name!r} is prescribed. Leave it out.")
    if prescribed is not None and not callable(prescribed):
        raise OptionError(f"prescribed: {prescribed!r} cannot be called. Give a function of t.")


def _first_state(library: Library, x: ArrayLike, y: ArrayLike) -> tuple[Floats, Floats]:
    """Return the coordinates and speeds at the first time in the precision of the library's arrays.

    Raises:
        ArrayError: If `x` or `y` has the wrong shape or type, or is not finite.
    """
    dtype = precisions.precision_named(library.storage).dtype
    first = arguments.state("x", x, (len(library.coordinate_names),), dtype)
    second = arguments.companion("y", y, (library.n,), first.shape[:-1], dtype, "x")
    for name, array in (("x", first), ("y", second)):
        if not np.isfinite(array).all():
            raise ArrayError(f"{name}: the first state is not finite.")
    return first, second


def _times(times: ArrayLike) -> Doubles:
    """Return the times as (T,) doubles.

    Raises:
        ArrayError: If there are fewer than two, or they are not finite and increasing.
    """
    moments: Doubles = np.asarray(arguments.floats("times", times, np.dtype(np.float64)), np.float64)
    if moments.ndim != 1 or len(moments) < 2:
        raise ArrayError(f"times: expected at least two in one row, got shape {moments.shape}.")
    if not (np.isfinite(moments).all() and (np.diff(moments) > 0).all()):
        raise ArrayError("times: they must be finite and increase from each to the next.")
    return moments
