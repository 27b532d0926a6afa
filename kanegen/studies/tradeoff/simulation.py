"""Simulations of a study: the time of all evaluations against the error at the end of a motion.

A free motion from one state is integrated by several methods with steps of many sizes. Its reference is
computed in long double with steps far smaller than any of them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from kanegen import library
from kanegen.errors import StatusError
from kanegen.library import Library
from kanegen.measure.timing import LATENCY
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.options import STRICT, Progress, Variant, quiet
from kanegen.reference.states import ranges
from kanegen.simulation import Trajectory, mescd, simulate
from kanegen.studies.bench.states import without_loads_and_parameters
from kanegen.studies.tradeoff.compilation import generate_variant
from kanegen.studies.tradeoff.outcome import SimulationRun, Study
from kanegen.studies.tradeoff.variants import Candidate

START = 4
"""Purpose of the sample that holds the first state of the motion; with the seed of a study it is its seed."""

STEPS = (16, 32, 64, 128, 256, 512, 1024)
"""Numbers of steps of the methods with a fixed step."""

REFERENCE_STEPS = 8192
"""Number of steps of the reference."""

TOLERANCES = (1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
"""Tolerances of the adaptive method."""

_DURATION = 4.0
"""Duration of the motion, in units of the time in which a typical freedom moves by its own size."""

_REFERENCE = Candidate(Variant(precision="long double"))


@dataclass(frozen=True)
class Integration:
    """A method of integration with one setting, applied to one motion.

    Attributes:
        method: Name of the method.
        setting: Step or tolerance of the method, in words.
        motion: Function that integrates the motion with a library.
    """

    method: str
    setting: str
    motion: Callable[[Library], Trajectory]


def with_simulations(system: System, study: Study, progress: Progress = quiet) -> Study:
    """Return a study with simulations by the variants on its Pareto front and by the default variant.

    Variants whose speeds are not rates of the coordinates, or whose arrays are double-double, do not take
    part: the work that they need beside forward dynamics was not timed.

    Args:
        system: The model of the study.
        study: The study, whose variants on the Pareto front for one state a call take part.
        progress: Function that is called with the name of each stage.

    Raises:
        BuildError: If there is no C compiler.
        StatusError: If the reference meets a state without finite accelerations.
    """
    model, _ = without_loads_and_parameters(system)
    sample = study.domain.sample(1, (study.options.seed, START))
    x, y, duration = sample.x[0], 0.5 * sample.y[0], _duration(model)
    progress("simulating the reference")
    exact = fixed_step(x, y, duration, "RK4", REFERENCE_STEPS, True).motion(_library(model, _REFERENCE))
    runs: list[SimulationRun] = []
    for candidate, nanoseconds in _participants(study):
        progress(f"simulating: {candidate.label}")
        built = _library(model, candidate)
        for one in integrations(built, x, y, duration):
            error, evaluations = run_integration(one, built, exact)
            runs.append(
                SimulationRun(candidate.label, one.method, one.setting, evaluations, nanoseconds, error)
            )
    return replace(study, duration=duration, runs=tuple(runs))


def integrations(built: Library, x: Floats, y: Floats, duration: float) -> Iterator[Integration]:
    """Yield every method with every setting that the arrays of a library allow.

    Args:
        built: The library that computes the accelerations.
        x: (m,) coordinates at the start.
        y: (n,) generalized speeds at the start.
        duration: Duration of the motion (s).
    """
    for steps in STEPS:
        yield fixed_step(x, y, duration, "semi-implicit Euler", steps, False)
        yield fixed_step(x, y, duration, "RK4", steps, False)
        if built.storage == "float":
            yield fixed_step(x, y, duration, "RK4", steps, True)
    if built.storage == "double":
        for tolerance in TOLERANCES:
            yield _adaptive(x, y, duration, "DOP853", tolerance)


def fixed_step(
    x: Floats, y: Floats, duration: float, method: str, steps: int, compensated: bool
) -> Integration:
    """Return a method with a number of equal steps, with or without compensated summation."""

    def motion(built: Library) -> Trajectory:
        span, step = [0.0, duration], duration / steps
        return simulate(built, x, y, span, method, step=step, compensated=compensated)

    name = f"{method}, compensated" if compensated else method
    return Integration(name, f"{steps} steps", motion)


def run_integration(one: Integration, built: Library, exact: Trajectory) -> tuple[float, int]:
    """Integrate the motion with a library.

    Returns:
        The error of the coordinates at the end, relative to 1 rad or 1 m plus their size, infinite if the
        motion meets a state without finite accelerations; and the number of evaluations of forward dynamics.
    """
    try:
        found = one.motion(built)
    except StatusError:
        return np.inf, 0
    return 10.0 ** -mescd(found.x[-1], exact.x[-1]), found.evaluations


def _adaptive(x: Floats, y: Floats, duration: float, method: str, tolerance: float) -> Integration:
    """Return an adaptive method with a tolerance."""

    def motion(built: Library) -> Trajectory:
        return simulate(built, x, y, [0.0, duration], method, tolerance=tolerance)

    return Integration(method, f"tolerance {tolerance:.0e}", motion)


def _participants(study: Study) -> list[tuple[Candidate, float]]:
    """Return the variants that are simulated, each with the time of one evaluation (ns)."""
    best = {c.result.candidate: c.times[LATENCY].median for c in study.pareto_fronts[LATENCY] if c.stays}
    default = Candidate(STRICT)
    for result in study.results:
        if result.candidate == default and result.times is not None:
            best.setdefault(default, result.times[LATENCY].median)
    return [
        (candidate, time) for candidate, time in best.items() if candidate.variant.storage != "double-double"
    ]


def _duration(system: System) -> float:
    """Return the duration of the motion (s) from the sizes and speeds of the freedoms."""
    largest = ranges(system)
    return float(_DURATION * np.median(largest.size / largest.y))


def _library(system: System, candidate: Candidate) -> Library:
    """Return the compiled library of a variant of a system."""
    return library.load(generate_variant(system, candidate))
