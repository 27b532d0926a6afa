"""How long variants take: the very libraries whose errors were measured, in turns, in fresh processes."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path

from kanegen.c.formats import formats
from kanegen.measure.timing import BATCH, LATENCY, Rounds, Times
from kanegen.model.arrays import Floats
from kanegen.options import Progress
from kanegen.studies.bench.building import compiled, driver
from kanegen.studies.bench.compare import take_turns
from kanegen.studies.bench.participant import Participant, Setting
from kanegen.studies.bench.results import DYNAMICS, Task
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
        participants = {
            built: _participant(built, sample, Path(folder) / str(number))
            for number, (built, sample) in enumerate(samples.items())
        }
        found = take_turns(list(participants.values()), rounds, progress)
        return {
            built: {task.name: found[participant, task.name] for task in _TASKS}
            for built, participant in participants.items()
        }


def computed_in_c(built: CompiledVariant, sample: Sample) -> dict[str, Floats]:
    """(B, n) {ydot} of the driver, by objective: for seeing that it times what it should."""
    with tempfile.TemporaryDirectory() as folder:
        results = _participant(built, sample, Path(folder) / "states").results(sample.tau.shape[1])
    return {objective: rows[:, 0] for objective, rows in results.items()}


def _participant(built: CompiledVariant, sample: Sample, file: Path) -> Participant:
    library = built.library
    states = States(sample.x, sample.y, sample.tau).write(file)
    real = formats(library.source.variant).storage
    kind = "-DDOUBLE_DOUBLE" if real.trailing_shape else f"-DREAL={real.c_type}"
    files = {"variant.c": driver("variant.c")}
    program = compiled("variant", files, (*_FLAGS, kind), ("-lm", "-ldl"))
    setting = Setting(built.candidate.label, library.source.variant.flags)
    function = f"{library.name}_{OUTPUT}"
    return Participant(
        "kanegen", setting, (str(program),), states, _TASKS, (function,), loads=(library.path,)
    )
