"""`simulate`, the entry of the package: checks its arguments, integrates, and returns a trajectory."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kanegen.compiler import build
from kanegen.errors import ArrayError, OptionError, StatusError, quoted, warn
from kanegen.library import Library
from kanegen.linear.names import names_of
from kanegen.model import arguments
from kanegen.model.arguments import Floats
from kanegen.model.arrays import Floats as Doubles
from kanegen.model.system import System
from kanegen.model.values_by_name import finite_in_order
from kanegen.options import STRICT, Progress, Variant, quiet
from kanegen.program import precision as precisions
from kanegen.recursion.outputs import OUTPUTS, available
from kanegen.recursion.outputs.integrators import ROLLOUT
from kanegen.simulation.choice import Problem, choose
from kanegen.simulation.compiled_steps import IN_C
from kanegen.simulation.elements import rate_unit
from kanegen.simulation.events import Crossing, Event, Watch, conditions, require_events
from kanegen.simulation.inputs import Effort, Inputs, InputSource, PrescribedMotion
from kanegen.simulation.limits import warn_outside_limits
from kanegen.simulation.methods import METHODS, Method, chosen_method
from kanegen.simulation.motion import Motion, StateLayout, speeds_are_rates
from kanegen.simulation.running import Record, ReportTime, run
from kanegen.simulation.signals import outputs_in
from kanegen.simulation.stretches import Marks
from kanegen.simulation.trajectory import Trajectory

__all__ = ["METHODS", "OF_MOTION", "simulate"]

OF_MOTION = ("forward_dynamics", "coordinate_rates")
"""Outputs that a simulation needs; tables and files contain the others."""

OF_DRIFTS = ("kinetic_energy", "potential_energy", "momentum")
"""Outputs whose drifts tell about the accuracy of a simulation."""

SMALLEST_ERROR, LARGEST_ERROR = 1e-15, 0.1
"""Errors that may be asked for."""

MANY, LOOSE = 8, 1e-5
"""Number of states from which on single precision may pay, and the error from which on it may do."""

ROWS = 200
"""Number of intervals between the states of a motion of which only the duration is given."""


def simulate(
    model: Library | System,
    x: ArrayLike | Mapping[str, float] | None = None,
    y: ArrayLike | Mapping[str, float] | None = None,
    times: ArrayLike | None = None,
    method: str | None = None,
    *,
    every: float | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    error: float | None = None,
    compensated: bool = False,
    effort: Effort | None = None,
    prescribed: PrescribedMotion | None = None,
    inputs: InputSource | Sequence[InputSource] | None = None,
    hold: str = "zero",
    events: Iterable[Event | str] | Event | str = (),
    outputs: Iterable[str] | str | None = None,
    progress: ReportTime | None = None,
) -> Trajectory:
    """Integrate the motion of a model from one state, or from B of them at once.

    Args:
        model: A library with the output `forward_dynamics`, and `coordinate_rates` if speeds are not the
            rates of coordinates; or a system, for which a library with all that is asked for is built. Fixed
            steps are computed in the precision of its arrays.
        x: (m,) or (B, m) coordinates at the first time, rad, m or 1, (B, m) with fixed steps only; or some by
            name, such as {"pole": 0.3}, where the others are neutral.
        y: (n,) or (B, n) generalized speeds at the first time, rad/s and m/s; or some by name, where the
            others are 0.
        times: (T,) increasing times at which states are wanted, s; the first is that of `x` and `y`. A single
            number is the duration of a motion that begins at 0.
        method: One of `METHODS`; by default "RK4" with a step, and "DOP853" without. With fixed steps, "RK4"
            is of order 4 and has the smallest errors for its cost; "implicit midpoint" of order 2, symmetric
            in time, keeps the energy of a conservative system near its value in long motions, at about 7
            evaluations a step; "leapfrog" of order 2 and "semi-implicit Euler" of order 1 do so only where
            [A] is constant and forces depend on {x} alone, else the energy drifts (docs/accuracy.md has
            figures). Only in C there are "Euler" of order 1, "variational midpoint" of order 2, which keeps
            momenta to rounding, and "linearly implicit" of order 1 for stiff systems. Where nothing acts from
            outside, all but "leapfrog" run in C if the library has their rollouts, as one that is built for a
            system does. SciPy's adaptive methods are "DOP853", explicit and of order 8, and "Radau", implicit
            and of order 5, for stiff systems.
        every: Interval between the states of a motion of which the duration is given, s; by default about a
            200th of it, in whole steps.
        step: Largest fixed step, s; every interval between two times is cut into equal steps.
        tolerance: Relative and absolute error of a step of the adaptive methods, from 1e-13 to 0.1; 1e-10 by
            default.
        error: Error of the trajectory, from 1e-15 to 0.1, in place of method, step and tolerance: of
            coordinates in rad and 1, and of others and of speeds over the largest one of the same unit.
            Motions with ever smaller steps are compared, and the cheapest method that keeps the error is
            taken; for a system also the precision is chosen. What is known stands in the attribute `promise`
            of the trajectory. Where the error cannot be promised up to the end, as in a chaotic motion, there
            is a warning with the time up to which it can.
        compensated: Whether fixed steps are added to the state with Kahan's compensated sum. In long
            simulations the rounding errors of these additions are most of the error, above all in single
            precision.
        effort: Function of t, x and y that returns generalized forces beside loads and gravity, of the shape
            of `y`; none by default.
        prescribed: Function of t that returns (3, p) values, rates and second derivatives of the prescribed
            freedoms. If the library has the output `prescribed_efforts`, their work counts as that of
            efforts.
        inputs: What acts, by name: a freedom for its generalized force (N m, N), a prescribed freedom for its
            value (rad, m), "force.<body>.x", "torque.<body>.x", "point_force.<point>.x" and
            "point_moment.<point>.x" for components of loads (N, N m). A table such as {"pole": "0.5*sin(t)"}
            has numbers, or expressions of t, x.<coordinate> and y.<speed>; the derivatives of a prescribed
            value are formed. The name of a .csv, .parquet or .npz file, or a table with the column "t" (s),
            has values over the time. Several of them act together.
        hold: How values over the time continue to the next one: "zero" keeps them, "linear" draws a line.
        events: Events that are recorded, or end the motion: texts such as "x.pole > pi/2", or `Event`s.
        outputs: Outputs that tables and files of the trajectory contain; by default all of the library but
            accelerations, and energies and momentum for a system.
        progress: Function that is called with the simulated time (s) from time to time.

    Returns:
        The trajectory, up to the event that ended it. An exception that breaks the computation off, also the
        `KeyboardInterrupt` of Ctrl-C, has what was computed so far as its attribute `trajectory`.

    Raises:
        ArrayError: If an array has the wrong shape or type.
        OptionError: If an option or a name does not exist, or does not fit the method or the library, an
            expression cannot be read, or the motion of prescribed freedoms is missing.
        ReadError: If a table cannot be read.
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
    happenings = require_events(events)
    if error is None:
        chosen = chosen_method(method, step, tolerance, compensated)
    else:
        chosen = _open_method(error, method, step, tolerance, compensated)
    moments = _times(times, every, chosen.step if error is None else None)
    library = model if isinstance(model, Library) else library_for(model, happenings, outputs, chosen.name)
    recorded = _recorded(library, outputs, isinstance(model, System))
    _check_library(library, chosen)
    if effort is not None and not callable(effort):
        raise OptionError(f"effort: {effort!r} cannot be called. Give a function of t, x and y.")
    if prescribed is not None and not callable(prescribed):
        raise OptionError(f"prescribed: {prescribed!r} cannot be called. Give a function of t.")
    acting = Inputs.of(library, effort, prescribed, inputs, hold)
    acting.require_span(float(moments[0]), float(moments[-1]))
    crossings = [Crossing.of(event, library) for event in happenings]
    _warn_of_contacts(library)
    first = _first_state(library, x, y)
    promise = None
    if error is not None:
        libraries = _Precisions(library, model if isinstance(model, System) else None, happenings, outputs)
        problem = _problem(libraries, acting, first, moments, error)
        chosen, precision, promise = choose(problem, float(error))
        library = libraries[precision]
        acting = acting.of_library(library)
        first = _first_state(library, *first)
    motion = _Simulation(library, chosen, acting, crossings, recorded)
    found = motion.trajectory(*first, moments, progress or (lambda time: None))
    if promise is None:
        return found
    if not promise.is_kept and promise.kept_until < found.times[-1]:
        warn(promise.refusal)
    return replace(found, promise=promise)


def _open_method(error: float, *given: object) -> Method:
    """Return the method whose steps a library must have where the method is chosen later.

    Raises:
        OptionError: If the error is no number in its range, or another choice is given beside it.
    """
    if any(one not in (None, False) for one in given):
        raise OptionError("error: it chooses method, step and precision. Leave the others out, or the error.")
    is_number = isinstance(error, int | float | np.number) and not isinstance(error, bool)
    if not is_number or not SMALLEST_ERROR <= error <= LARGEST_ERROR:
        raise OptionError(f"error: {quoted(error)} is not between {SMALLEST_ERROR:g} and {LARGEST_ERROR:g}.")
    return Method("RK4", 1.0)


class _Precisions:
    """Libraries of a system in several precisions, each built when it is first needed."""

    def __init__(
        self,
        library: Library,
        system: System | None,
        events: Sequence[Event | str],
        outputs: Iterable[str] | str | None,
    ) -> None:
        """Begin with the library at hand, which is the only one where the system is not given."""
        self._known = {library.storage: library}
        self._system, self._events, self._outputs = system, events, outputs

    def names(self, states: int, error: float) -> tuple[str, ...]:
        """Return the precisions that can be had, the cheapest first.

        Single precision pays where an instruction of C holds several states.
        """
        if self._system is None:
            return tuple(self._known)
        pays = states >= MANY and error >= LOOSE
        return (*(("float",) if pays else ()), "double", "long double")

    def __getitem__(self, precision: str) -> Library:
        """Return the library in a precision."""
        if precision not in self._known and self._system is not None:
            tier = Variant(precision=precision)
            self._known[precision] = library_for(self._system, self._events, self._outputs, "RK4", tier)
        return self._known[precision]


def _problem(
    libraries: _Precisions, inputs: Inputs, first: tuple[Floats, Floats], times: Doubles, error: float
) -> Problem:
    """Return the motion whose error is asked for."""
    model, m = inputs.library.source.model, first[0].shape[-1]
    start = np.concatenate([np.asarray(part, np.float64) for part in first], axis=-1)

    def solve(method: Method, precision: str, state: Doubles, moments: Doubles) -> tuple[Doubles, int]:
        """Return the states and the evaluations of a motion, up to where it breaks off."""
        library = libraries[precision]
        motion = _Simulation(library, method, inputs.of_library(library), (), ())
        dtype = precisions.precision_named(library.storage).dtype
        x, y = (np.ascontiguousarray(part, dtype) for part in (state[..., :m], state[..., m:]))
        states, evaluations = motion.states(x, y, moments)
        return np.asarray(states[..., :-1], np.float64), evaluations

    names = libraries.names(len(start) if start.ndim > 1 else 1, error)
    units = (*model.coordinate_units, *(rate_unit(unit) for unit in model.freedom_units))
    in_c = inputs.are_absent and f"{ROLLOUT}rk4" in inputs.library.source.integrators
    return Problem(solve, start, times, units, names, in_c)


class _Simulation:
    """One motion with all that is asked of it, checked."""

    def __init__(
        self,
        library: Library,
        method: Method,
        inputs: Inputs,
        crossings: Sequence[Crossing],
        outputs: tuple[str, ...],
    ) -> None:
        self._library, self._method, self._inputs = library, method, inputs
        self._crossings, self._outputs = crossings, outputs
        self._layout = StateLayout.of(library)
        self._motion = Motion(library, self._layout, inputs)

    def states(self, x: Floats, y: Floats, times: Doubles) -> tuple[Floats, int]:
        """Return (T, ..., k) states and the evaluations of a motion, up to where it breaks off."""
        start = self._layout.join(x, y, np.zeros(y.shape[:-1], y.dtype))
        record = Record([float(times[0])], [start])
        marks = Marks.of(times, self._inputs.breaks)
        with suppress(StatusError):
            integrator = self._method.integrator(self._motion, start)
            run(self._motion, integrator, start, marks, None, record, lambda time: None)
        states = record.arrays[1]
        if self._layout.homogeneous:
            states = self._layout.scaled(states, self._layout.lengths(start) / self._layout.lengths(states))
        return states, self._motion.evaluations

    def trajectory(self, x: Floats, y: Floats, times: Doubles, report_time: ReportTime) -> Trajectory:
        """Return the motion from a first state.

        Raises:
            StatusError: As `simulate`; the error, like that of an interruption, carries the part before it.
        """
        start = self._layout.join(x, y, np.zeros(y.shape[:-1], y.dtype))
        if start.ndim > 1 and self._method.is_adaptive:
            raise ArrayError(f"x: method {self._method.name!r} takes one state, got {len(start)}.")
        if start.ndim > 1 and self._crossings:
            raise OptionError(f"events: a motion with events begins in one state, not in {len(start)}.")
        integrator = self._method.integrator(self._motion, start)
        watch = Watch(self._motion, integrator, self._crossings) if self._crossings else None
        record = Record([float(times[0])], [start])
        marks = Marks.of(times, self._inputs.breaks)
        try:
            run(self._motion, integrator, start, marks, watch, record, report_time)
        except (StatusError, KeyboardInterrupt) as stopped:
            stopped.trajectory = self._made(record)  # type: ignore[union-attr]
            raise
        self._motion.report_inaccurate()
        return self._made(record)

    def _made(self, record: Record) -> Trajectory:
        """Return the trajectory of a record."""
        times, states = record.arrays
        x, y = self._layout.x(states), self._layout.y(states)
        if self._layout.homogeneous:
            factors = self._layout.lengths(x[0]) / self._layout.lengths(x)
            x = self._layout.scaled(x, factors)
        found = Trajectory(
            self._library,
            times,
            x,
            y,
            states[..., -1],
            self._motion.evaluations,
            self._inputs.over(times, x, y),
            str(self._method),
            self._outputs,
            tuple(record.events),
        )
        warn_outside_limits(found)
        return found


def library_for(
    system: System,
    events: Sequence[Event | str] = (),
    outputs: Iterable[str] | str | None = None,
    method: str | None = None,
    tier: Variant | str = STRICT,
    progress: Progress = quiet,
) -> Library:
    """Build a library with all outputs that a simulation of a system needs.

    Args:
        system: The tree.
        events: Events, whose conditions may name outputs.
        outputs: Outputs that are wanted over the time, beside energies and momentum.
        method: Name of a method, whose steps then run in C if there are such.
        tier: Variant of the code, as for `kg.build`.
        progress: Function that is called with the name of each stage.

    Raises:
        OptionError: If there is no system, or no output of a name.
        SingularError: If [A] is singular in every state.
        BuildError: As `kg.build`.

    Example:
        library = library_for(system, ["kinetic_energy > 1"])
    """
    if not isinstance(system, System):
        raise OptionError(
            f'{system!r} is no system and no library. Make one with kg.build(system, ("forward_dynamics",)).'
        )
    can = available(system)
    asked = () if outputs is None else names_of("outputs", outputs)
    rates = () if system.speeds_are_rates else ("coordinate_rates",)
    efforts = [name for name in ("prescribed_efforts",) if name in can]
    named = outputs_in(conditions(events), tuple(OUTPUTS))
    steps = [f"{ROLLOUT}{IN_C[method]}"] if method in IN_C and not system.prescribed else []
    wanted = dict.fromkeys(("forward_dynamics", *rates, *efforts, *OF_DRIFTS, *asked, *named, *steps))
    return build(system, tuple(wanted), tier=tier, progress=progress)


def _recorded(library: Library, outputs: Iterable[str] | str | None, is_built: bool) -> tuple[str, ...]:
    """Return the outputs that tables and files of the trajectory contain."""
    if outputs is not None:
        names = names_of("outputs", outputs)
        for name in names:
            if name not in library.source.outputs:
                raise OptionError(
                    f"system {library.name!r} was built without the output {quoted(name)}. It has "
                    f"{', '.join(library.source.outputs)}; ask for more with outputs=(...)."
                )
        return names
    for_itself = (*OF_MOTION, *(("prescribed_efforts",) if is_built else ()))
    return tuple(name for name in library.source.outputs if name not in for_itself)


def _check_library(library: Library, method: Method) -> None:
    """Make sure that the library has the outputs and the precision that the method needs."""
    if "forward_dynamics" not in library.source.outputs:
        raise OptionError(
            f"system {library.name!r} was built without the output 'forward_dynamics'. It has "
            f"{', '.join(library.source.outputs)}; ask for more with outputs=(...)."
        )
    if not speeds_are_rates(library):
        if method.name == "leapfrog":
            raise OptionError("method 'leapfrog' is for speeds that are rates of coordinates. Take 'RK4'.")
        if "coordinate_rates" not in library.source.outputs:
            raise OptionError(
                f"system {library.name!r} has speeds that are no rates of coordinates, and was built without "
                "the output 'coordinate_rates'. Ask for it with outputs=(...)."
            )
    if library.storage == "double-double":
        raise OptionError(
            f"the arrays of system {library.name!r} hold double-double numbers. Build it with "
            'storage="double".'
        )
    if method.is_adaptive and library.storage != "double":
        raise OptionError(
            f"method {method.name!r} computes with doubles, but the arrays of system {library.name!r} are "
            f'{library.storage!r}. Build it with storage="double", or take fixed steps.'
        )


def _warn_of_contacts(library: Library) -> None:
    """Warn that contacts of a model, which its equations have in `contact_dynamics` alone, do not hold."""
    if contacts := library.source.model.contacts:
        shown = f"{contacts[0]}{', ...' * (len(contacts) > 1)}"
        warn(
            f"the motion of {library.name} is one without its contacts ({shown}): they hold in the output "
            "contact_dynamics alone."
        )


def _first_state(library: Library, x: Any, y: Any) -> tuple[Floats, Floats]:
    """Return the coordinates and speeds at the first time in the precision of the library's arrays.

    Raises:
        ArrayError: If `x` or `y` has the wrong shape or type, or is not finite.
        OptionError: If there is no coordinate or speed of a name.
    """
    dtype = precisions.precision_named(library.storage).dtype
    if x is None or isinstance(x, Mapping):
        neutral = np.zeros(len(library.coordinate_names))
        neutral[[places[0] for places in library.source.model.homogeneous]] = 1.0
        x = finite_in_order("x", x, library.coordinate_names, neutral.tolist())
    if y is None or isinstance(y, Mapping):
        y = finite_in_order("y", y, library.speed_names, [0.0] * library.n)
        batch = np.shape(x)[:-1]
        y = np.broadcast_to(y, (*batch, library.n))
    first = arguments.state("x", x, (len(library.coordinate_names),), dtype)
    second = arguments.companion("y", y, (library.n,), first.shape[:-1], dtype, "x")
    for name, array in (("x", first), ("y", second)):
        if not np.isfinite(array).all():
            raise ArrayError(f"{name}: the first state is not finite.")
    return first, second


def _times(times: ArrayLike | None, every: float | None, step: float | None) -> Doubles:
    """Return the times at which states are wanted, as (T,) doubles.

    Raises:
        ArrayError: If there are fewer than two, or they are not finite and increasing.
        OptionError: If there are none, or a duration is not positive.
    """
    if times is None:
        raise OptionError("times: give a duration in s, or times, such as np.linspace(0, 10, 101).")
    if np.ndim(times) == 0:
        duration = _positive("duration", times)
        return _equal_times(duration, every or _usual_interval(duration, step))
    if every is not None:
        raise OptionError("every: it goes with a duration. With times, leave it out.")
    moments: Doubles = np.asarray(arguments.floats("times", times, np.dtype(np.float64)), np.float64)
    if moments.ndim != 1 or len(moments) < 2:
        raise ArrayError(f"times: expected at least two in one row, got shape {moments.shape}.")
    if not (np.isfinite(moments).all() and (np.diff(moments) > 0).all()):
        raise ArrayError("times: they must be finite and increase from each to the next.")
    return moments


MOST_ROWS = 10_000_000
"""Largest number of states that a duration and an interval may ask for."""


def _usual_interval(duration: float, step: float | None) -> float:
    """Return the interval (s) between states where none is given: whole steps, or a share of the duration."""
    return duration / ROWS if step is None else step * max(1, round(duration / step / ROWS))


def _equal_times(duration: float, every: float) -> Doubles:
    """Return times from 0 to a duration (s) at equal intervals; the last one may be shorter."""
    interval = _positive("every", every)
    count = duration / interval
    if count > MOST_ROWS:
        raise OptionError(
            f"every: {interval!r} s makes more than {MOST_ROWS} states in {duration!r} s. Take a longer "
            "interval."
        )
    whole = round(count) if abs(count - round(count)) < 1e-9 * count else math.floor(count)
    found: Doubles = interval * np.arange(whole + 1.0)
    if whole >= count * (1 - 1e-9):
        found[-1] = duration if whole else 0.0
    return found if found[-1] == duration else np.append(found, duration)


def _positive(name: str, value: Any) -> float:
    """Return a number of seconds.

    Raises:
        OptionError: If it is not positive and finite.
    """
    is_number = isinstance(value, int | float | np.number) and not isinstance(value, bool)
    if not is_number or not 0 < value < math.inf:
        raise OptionError(f"{name}: {quoted(value)} is no positive number of seconds.")
    return float(value)
