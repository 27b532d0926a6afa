"""`simulate`, the entry of the package: from a model and a first state to a trajectory."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from kanegen.errors import OptionError, warn
from kanegen.library import Library
from kanegen.model.arguments import Floats
from kanegen.model.arrays import Floats as Doubles
from kanegen.model.system import System
from kanegen.program import precision as precisions
from kanegen.recursion.outputs.integrators import ROLLOUT
from kanegen.simulation.arguments import (
    first_state,
    open_method,
    recorded_outputs,
    require_fitting,
    times_of,
)
from kanegen.simulation.choice import Problem, choose
from kanegen.simulation.elements import rate_unit
from kanegen.simulation.events import Crossing, Event, require_events
from kanegen.simulation.inputs import Effort, Inputs, InputSource, PrescribedMotion
from kanegen.simulation.libraries import Precisions, library_for
from kanegen.simulation.methods import Method, chosen_method
from kanegen.simulation.running import ReportTime
from kanegen.simulation.solver import Solver
from kanegen.simulation.trajectory import Trajectory


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
        method: One of `METHODS`, in any spelling of capitals, blanks, hyphens and underscores; by default
            "RK4" with a step, and "DOP853" without. With fixed steps, "RK4" is of order 4 and has the
            smallest errors for its cost; "implicit_midpoint" of order 2, symmetric in time, keeps the energy
            of a conservative system near its value in long motions, at about 7 evaluations a step;
            "leapfrog" of order 2 and "semi_implicit_euler" of order 1 do so only where [A] is constant and
            forces depend on {x} alone, else the energy drifts (docs/accuracy.md has figures); "extrapolation"
            of order 8, in 17 evaluations a step, needs no SciPy for high accuracy. Only in C there
            are "euler" of order 1, "variational_midpoint" of order 2, which keeps momenta to rounding, and
            "linearly_implicit" of order 2 for stiff systems. All but "leapfrog" and "extrapolation" run in C
            if the library has their rollouts, as one that is built for a system does, unless something that
            acts depends on the state.
            SciPy's adaptive methods are "DOP853", explicit and of order 8, and "Radau", implicit and of order
            5, for stiff systems.
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
            has numbers, expressions of t, x.<coordinate> and y.<speed>, whose derivatives are formed for a
            prescribed value, or functions of t, which return a number, or value, rate and second derivative.
            The name of a .csv, .parquet or .npz file, or a table with the column "t" (s), has values over the
            time. Several of them act together.
        hold: How values over the time continue to the next one: "zero" keeps them, "linear" draws a line.
        events: Events that are recorded, or end the motion: texts such as "x.pole > pi/2", or `Event`s.
        outputs: Outputs that tables and files of the trajectory contain beside energies and momentum, such as
            "point_positions"; by default all of a library but accelerations.
        progress: Function that is called with the simulated time (s) from time to time.

    Returns:
        The trajectory, up to the event that ended it. An exception that breaks the computation off, also the
        `KeyboardInterrupt` of Ctrl-C, has what was computed so far as its attribute `trajectory`.

    Raises:
        ArrayError: If an array has the wrong shape or type.
        OptionError: If an option or a name does not exist, or does not fit the method or the library, an
            expression cannot be read, the motion of prescribed freedoms is missing, or a function of the
            caller fails, whose exception is the cause; the message names the input and the time.
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
        chosen = open_method(error, method, step, tolerance, compensated)
    moments = times_of(times, every, chosen.step if error is None else None)
    library = model if isinstance(model, Library) else library_for(model, happenings, outputs, chosen.name)
    recorded = recorded_outputs(library, outputs, isinstance(model, System))
    require_fitting(library, chosen)
    if effort is not None and not callable(effort):
        raise OptionError(f"effort: {effort!r} cannot be called. Give a function of t, x and y.")
    if prescribed is not None and not callable(prescribed):
        raise OptionError(f"prescribed: {prescribed!r} cannot be called. Give a function of t.")
    acting = Inputs.of(library, effort, prescribed, inputs, hold)
    acting.require_span(float(moments[0]), float(moments[-1]))
    crossings = [Crossing.of(event, library) for event in happenings]
    _warn_of_contacts(library)
    first = first_state(library, x, y)
    if chosen.is_adaptive or error is not None:
        acting = acting.with_turns(moments, *first)
    promise = None
    if error is not None:
        libraries = Precisions(library, model if isinstance(model, System) else None, happenings, outputs)
        problem = _problem(libraries, acting, first, moments, error)
        chosen, precision, promise = choose(problem, float(error))
        library = libraries[precision]
        acting = acting.of_library(library)
        first = first_state(library, *first)
    motion = Solver(library, chosen, acting, crossings, recorded)
    found = motion.trajectory(*first, moments, progress or (lambda time: None))
    if promise is None:
        return found
    if not promise.is_kept and promise.kept_until < found.times[-1]:
        warn(promise.refusal)
    return replace(found, promise=promise)


def _warn_of_contacts(library: Library) -> None:
    """Warn that contacts of a model, which its equations have in `contact_dynamics` alone, do not hold."""
    if contacts := library.source.model.contacts:
        shown = f"{contacts[0]}{', ...' * (len(contacts) > 1)}"
        warn(
            f"the motion of {library.name} is one without its contacts ({shown}): they hold in the output "
            "contact_dynamics alone."
        )


def _problem(
    libraries: Precisions, inputs: Inputs, first: tuple[Floats, Floats], times: Doubles, error: float
) -> Problem:
    """Return the motion whose error is asked for."""
    model, m = inputs.library.source.model, first[0].shape[-1]
    start = np.concatenate([np.asarray(part, np.float64) for part in first], axis=-1)

    def solve(method: Method, precision: str, state: Doubles, moments: Doubles) -> tuple[Doubles, int]:
        """Return the states and the evaluations of a motion, up to where it breaks off."""
        library = libraries[precision]
        motion = Solver(library, method, inputs.of_library(library), (), ())
        dtype = precisions.precision_named(library.storage).dtype
        x, y = (np.ascontiguousarray(part, dtype) for part in (state[..., :m], state[..., m:]))
        states, evaluations = motion.states(x, y, moments)
        return np.asarray(states[..., :-1], np.float64), evaluations

    names = libraries.names(len(start) if start.ndim > 1 else 1, error)
    units = (*model.coordinate_units, *(rate_unit(unit) for unit in model.freedom_units))
    in_c = not inputs.depend_on_state and f"{ROLLOUT}rk4" in inputs.library.source.integrators
    return Problem(solve, start, times, units, names, in_c, inputs.turns.finest, not inputs.are_absent)
