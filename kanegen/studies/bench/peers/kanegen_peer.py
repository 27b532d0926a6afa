"""The participant kanegen: its C in several compiler settings, and its functions called from Python."""

from __future__ import annotations

import functools
import pickle
import sys
from collections.abc import Mapping
from dataclasses import replace

from kanegen import compiler
from kanegen.c import Source
from kanegen.library import load
from kanegen.library.native.build import code
from kanegen.recursion.outputs import EQUATIONS as BOTH
from kanegen.studies.bench.building import compiled, driver
from kanegen.studies.bench.comparison import KANEGEN, PYTHON
from kanegen.studies.bench.participant import Participant
from kanegen.studies.bench.peers.problem import DERIVATIVES_TASKS, SINGLE_STATE_TASKS, Builders, Problem
from kanegen.studies.bench.results import DERIVATIVES, DYNAMICS, EQUATIONS, Task
from kanegen.studies.bench.settings import (
    DEFAULT,
    DEFAULT_AVX2,
    NATIVE,
    NATIVE_AVX2,
    PORTABLE,
    Setting,
    here,
)

OUTPUTS = {EQUATIONS: BOTH, DYNAMICS: ("forward_dynamics",)}
SETTINGS = (DEFAULT, DEFAULT_AVX2, PORTABLE, NATIVE, NATIVE_AVX2)
"""The compiler settings in which kanegen's C is timed, as far as the processor has them."""

_INVERSE = "inverse"
"""End of the name of the model whose C has [A] and the derivatives of inverse dynamics."""


def builders(problem: Problem) -> Builders:
    """Yield the builders of one participant for each compiler setting and of one that is a Python process."""
    sources = {quantity: compiler.generate(problem.system, outputs) for quantity, outputs in OUTPUTS.items()}
    files = _files(sources)
    if problem.has_derivatives:
        inverse = replace(problem.system, name=f"{problem.system.name}_{_INVERSE}")
        derived = {
            DERIVATIVES: compiler.generate(problem.system, ("forward_dynamics_derivatives",)),
            _INVERSE: compiler.generate(inverse, ("mass_matrix", "inverse_dynamics_derivatives")),
        }
        files |= _files(derived)
    for setting in here(SETTINGS):
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
    tasks = [*SINGLE_STATE_TASKS, *map(_in_batches, SINGLE_STATE_TASKS)]
    if problem.has_derivatives:
        flags.append(f"-DINVERSE={problem.system.identifier}_{_INVERSE}")
        tasks += [both for task in DERIVATIVES_TASKS for both in (task, _in_batches(task))]
    program = compiled(KANEGEN, {"kanegen.c": driver("kanegen.c"), **files}, flags)
    return [Participant(KANEGEN, setting, (str(program),), problem.states_file, tuple(tasks))]


def _in_batches(task: Task) -> Task:
    """Return the task that computes the same quantity of many states in one call."""
    return Task(f"{task.name} batch", task.quantity, batch=True)


def _from_python(problem: Problem, sources: Mapping[str, Source]) -> list[Participant]:
    """Return the participant that calls the compiled functions from Python."""
    path = problem.folder / "libraries"
    path.write_bytes(pickle.dumps({quantity: load(source) for quantity, source in sources.items()}))
    command = (sys.executable, "-m", "kanegen.studies.bench.python_driver")
    tasks = (*SINGLE_STATE_TASKS, *map(_in_batches, SINGLE_STATE_TASKS))
    return [Participant(PYTHON, DEFAULT, command, problem.states_file, tasks, (str(path),))]
