"""The participant kanegen: its C in three compiler settings, and its functions called from Python."""

from __future__ import annotations

import functools
import pickle
import sys
from collections.abc import Mapping

from kanegen import compiler
from kanegen.c import Source
from kanegen.library import load
from kanegen.library.native.build import code
from kanegen.recursion.outputs import EQUATIONS as BOTH
from kanegen.studies.bench.building import compiled, driver
from kanegen.studies.bench.comparison import KANEGEN, PYTHON
from kanegen.studies.bench.participant import EXACT, NATIVE, RELAXED, Participant, Setting
from kanegen.studies.bench.peers.problem import DERIVATIVES_TASK, SINGLE_STATE_TASKS, Builders, Problem
from kanegen.studies.bench.results import DERIVATIVES, DYNAMICS, EQUATIONS, Task

BATCH_TASKS = (Task("equations batch", EQUATIONS, batch=True), Task("dynamics batch", DYNAMICS, batch=True))
DERIVATIVES_BATCH_TASK = Task("derivatives batch", DERIVATIVES, batch=True)
OUTPUTS = {EQUATIONS: BOTH, DYNAMICS: ("forward_dynamics",)}


def builders(problem: Problem) -> Builders:
    """Yield the builders of one participant for each compiler setting and of one that is a Python process."""
    sources = {quantity: compiler.generate(problem.system, outputs) for quantity, outputs in OUTPUTS.items()}
    files = _files(sources)
    if problem.has_derivatives:
        derived = compiler.generate(problem.system, ("forward_dynamics_derivatives",))
        files |= _files({DERIVATIVES: derived})
    for setting in (EXACT, NATIVE, RELAXED):
        yield f"{KANEGEN} {setting.name}", functools.partial(_participant, problem, files, setting)
    yield PYTHON, functools.partial(_from_python, problem, sources)


def _files(sources: Mapping[str, Source]) -> dict[str, str]:
    """Return the C files of all sources, one folder for each quantity, since their names are the same."""
    return {
        f"{folder}/{name}": text for folder, source in sources.items() for name, text in code(source).items()
    }


def _participant(problem: Problem, files: Mapping[str, str], setting: Setting) -> list[Participant]:
    """Return the participant of one compiler setting."""
    flags = [*setting.flags, f"-DMODEL={problem.system.identifier}"]
    tasks = [*SINGLE_STATE_TASKS, *BATCH_TASKS]
    if problem.has_derivatives:
        flags.append("-DDERIVATIVES")
        tasks += [DERIVATIVES_TASK, DERIVATIVES_BATCH_TASK]
    program = compiled(KANEGEN, {"kanegen.c": driver("kanegen.c"), **files}, flags)
    return [Participant(KANEGEN, setting, (str(program),), problem.states_file, tuple(tasks))]


def _from_python(problem: Problem, sources: Mapping[str, Source]) -> list[Participant]:
    """Return the participant that calls the compiled functions from Python."""
    path = problem.folder / "libraries"
    path.write_bytes(pickle.dumps({quantity: load(source) for quantity, source in sources.items()}))
    command = (sys.executable, "-m", "kanegen.studies.bench.python_driver")
    return [Participant(PYTHON, EXACT, command, problem.states_file, SINGLE_STATE_TASKS, (str(path),))]
