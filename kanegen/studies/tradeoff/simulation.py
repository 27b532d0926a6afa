"""What variants are worth in a simulation: work against the error at the end.

A free motion from one state is integrated by several methods with steps of many sizes. Its reference is
computed in `long double` with steps far smaller than any of them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from kanegen import library
from kanegen.errors import SingularError
from kanegen.library import Library
from kanegen.library.simulation import Trajectory, mescd, simulate
from kanegen.measure.timing import LATENCY
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.options import STRICT, Progress, Variant
from kanegen.reference.states import ranges
from kanegen.studies.bench.states import without_loads_and_parameters
from kanegen.studies.tradeoff.compilation import generate_variant
from kanegen.studies.tradeoff.outcome import Run, Study
from kanegen.studies.tradeoff.variants import Candidate

START = 4
"""With the seed of a study, the seed of the first state."""

STEPS = (16, 32, 64, 128, 256, 512, 1024)
"""Of a whole simulation with fixed steps."""

FINEST = 8192
"""Those of the reference."""

TOLERANCES = (1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
"""Of the adaptive method."""

_PERIODS = 4.0
"""Times in which gravity or its like moves a body by its own length, that are simulated."""

_REFERENCE = Candidate(Variant(precision="long double"))


@dataclass(frozen=True)
class Way:
    """A method of integration with one setting, in words and as what it makes of a library."""

    method: str
    setting: str
    motion: Callable[[Library], Trajectory]


def simulated(system: System, study: Study, progress: Progress = lambda stage: None) -> Study:
    """The study with simulations by its best variants and the default one.

    Variants whose speeds are no rates of the coordinates, or whose arrays hold pairs, are left out: what they
    need beside forward dynamics was not timed.

    Args:
        system: That of the study.
        study: Whose variants on the front for one state a call take part, with their times.
        progress: Told the name of each stage.

    Raises:
        BuildError: If there is no C compiler.
        SingularError: If the reference meets a singular state.
    """
    model, _ = without_loads_and_parameters(system)
    sample = study.domain.sample(1, (study.terms.seed, START))
    x, y, duration = sample.x[0], 0.5 * sample.y[0], _duration(model)
    progress("simulating the reference")
    exact = fixed(x, y, duration, "RK4", FINEST, True).motion(_library(model, _REFERENCE))
    runs: list[Run] = []
    for candidate, nanoseconds in _taking_part(study):
        progress(f"simulating: {candidate.label}")
        built = _library(model, candidate)
        for way in ways(built, x, y, duration):
            error, evaluations = tried(way, built, exact)
            runs.append(Run(candidate.label, way.method, way.setting, evaluations, nanoseconds, error))
    return replace(study, duration=duration, runs=tuple(runs))


def _taking_part(study: Study) -> list[tuple[Candidate, float]]:
    """Variants and their ns an evaluation: those on the front, and the default."""
    best = {c.entry.candidate: c.times[LATENCY].median for c in study.fronts[LATENCY] if c.stays}
    default = Candidate(STRICT)
    for entry in study.entries:
        if entry.candidate == default and entry.times is not None:
            best.setdefault(default, entry.times[LATENCY].median)
    return [
        (candidate, time)
        for candidate, time in best.items()
        if not candidate.changes_system and candidate.variant.storage != "double-double"
    ]


def _duration(system: System) -> float:
    """s."""
    largest = ranges(system)
    return float(_PERIODS * np.median(largest.size / largest.y))


def _library(system: System, candidate: Candidate) -> Library:
    return library.load(generate_variant(system, candidate))


def ways(built: Library, x: Floats, y: Floats, duration: float) -> Iterator[Way]:
    """Every method with every setting that the arrays of a library allow, from the state `x`, `y`."""
    for steps in STEPS:
        yield fixed(x, y, duration, "semi-implicit Euler", steps, False)
        yield fixed(x, y, duration, "RK4", steps, False)
        if built.storage == "float":
            yield fixed(x, y, duration, "RK4", steps, True)
    if built.storage == "double":
        for tolerance in TOLERANCES:
            yield _adaptive(x, y, duration, "DOP853", tolerance)


def fixed(x: Floats, y: Floats, duration: float, method: str, steps: int, compensated: bool) -> Way:
    """A method with this many equal steps."""

    def motion(built: Library) -> Trajectory:
        span, step = [0.0, duration], duration / steps
        return simulate(built, x, y, span, method, step=step, compensated=compensated)

    name = f"{method}, compensated" if compensated else method
    return Way(name, f"{steps} steps", motion)


def _adaptive(x: Floats, y: Floats, duration: float, method: str, tolerance: float) -> Way:
    def motion(built: Library) -> Trajectory:
        return simulate(built, x, y, [0.0, duration], method, tolerance=tolerance)

    return Way(method, f"tolerance {tolerance:.0e}", motion)


def tried(way: Way, built: Library, exact: Trajectory) -> tuple[float, int]:
    """The error of the last coordinates, relative to one radian or metre and their size; evaluations."""
    try:
        found = way.motion(built)
    except SingularError:
        return np.inf, 0
    return 10.0 ** -mescd(found.x[-1], exact.x[-1]), found.evaluations
