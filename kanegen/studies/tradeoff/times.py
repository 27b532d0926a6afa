"""How long variants take: the very libraries whose errors were measured, in turns, in fresh processes."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path

from kanegen.c.formats import formats
from kanegen.measure.timing import BATCH, LATENCY, Rounds, Times
from kanegen.model.arrays import Floats
from kanegen.studies.bench.building import compiled, driver
from kanegen.studies.bench.contest import Progress, take_turns
from kanegen.studies.bench.contestant import Contestant
from kanegen.studies.bench.results import DYNAMICS, Task
from kanegen.studies.bench.settings import Setting
from kanegen.studies.bench.states import States
from kanegen.studies.tradeoff.compilation import CompiledVariant
from kanegen.studies.tradeoff.judge import OUTPUT
from kanegen.studies.tradeoff.samples import Sample

_TASKS = (Task(LATENCY, DYNAMICS), Task(BATCH, DYNAMICS, batch=True))
_FLAGS = ("-std=c99", "-O2", "-ffp-contract=off")


def timed(
    samples: Mapping[CompiledVariant, Sample], rounds: Rounds, progress: Progress
) -> dict[CompiledVariant, dict[str, Times]]:
    """The times of libraries, by objective.

    Args:
        samples: What each is to compute, on models without loads and parameters.
        rounds: Number of rounds, and seconds of each objective in every round.
        progress: Told the name of each stage.

    Raises:
        BuildError: If there is no C compiler.
        MissingError: If the driver cannot be compiled, or a library fails in it.
    """
    with tempfile.TemporaryDirectory() as folder:
        contestants = {
            built: _contestant(built, sample, Path(folder) / str(number))
            for number, (built, sample) in enumerate(samples.items())
        }
        found = take_turns(list(contestants.values()), rounds, progress)
        return {
            built: {task.name: found[contestant, task.name] for task in _TASKS}
            for built, contestant in contestants.items()
        }


def computed_in_c(built: CompiledVariant, sample: Sample) -> dict[str, Floats]:
    """(B, n) {ydot} of the driver, by objective: for seeing that it times what it should."""
    with tempfile.TemporaryDirectory() as folder:
        results = _contestant(built, sample, Path(folder) / "states").results(sample.tau.shape[1])
    return {objective: rows[:, 0] for objective, rows in results.items()}


def _contestant(built: CompiledVariant, sample: Sample, file: Path) -> Contestant:
    library = built.library
    states = States(sample.states.x, sample.states.y, sample.tau).write(file)
    real = formats(library.source.variant).storage
    kind = "-DPAIRS" if real.trailing_shape else f"-DREAL={real.c_type}"
    files = {"driver.c": driver("variant.c")}
    program = compiled("variant", files, (*_FLAGS, kind), ("-lm", "-ldl"))
    setting = Setting(built.candidate.label, library.source.variant.flags)
    function = f"{library.name}_{OUTPUT}"
    return Contestant("kanegen", setting, (str(program),), states, _TASKS, (function,), loads=(library.path,))
