"""The participant kanegen: its C in several compiler settings, and its functions called from Python."""

from __future__ import annotations

import functools
import pickle
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from kanegen import compiler
from kanegen.c import Source
from kanegen.library import load
from kanegen.library.native.build import code
from kanegen.recursion.outputs import EQUATIONS as BOTH
from kanegen.studies.bench.building import compiled, driver
from kanegen.studies.bench.comparison import KANEGEN, PYTHON
from kanegen.studies.bench.participant import Participant
from kanegen.studies.bench.peers.problem import DERIVATIVES_TASKS, SINGLE_STATE_TASKS, Builders, Problem
from kanegen.studies.bench.results import DERIVATIVES, DYNAMICS, EQUATIONS, LOWER, Task
from kanegen.studies.bench.settings import (
    CONTRACTED,
    CONTRACTED_AVX2,
    DEFAULT,
    DEFAULT_AVX2,
    PORTABLE,
    Setting,
    here,
)

OUTPUTS = {EQUATIONS: BOTH, DYNAMICS: ("forward_dynamics",)}
"""The outputs of the C that is also called from Python, by quantity."""

SETTINGS = (DEFAULT, DEFAULT_AVX2, PORTABLE, CONTRACTED, CONTRACTED_AVX2)
"""The compiler settings in which kanegen's C is timed, as far as the processor has them."""

_INVERSE = "inverse"
"""End of the name of the model whose C has [A] and the derivatives of inverse dynamics."""


@dataclass(frozen=True)
class _Program:
    """The parts of a driver of kanegen's C.

    Attributes:
        files: Texts by relative path.
        flags: Compiler flags beside those of the setting.
        tasks: Tasks that it computes, each of one state and then of a batch.
    """

    files: Mapping[str, str]
    flags: tuple[str, ...]
    tasks: tuple[Task, ...]


def builders(problem: Problem) -> Builders:
    """Yield the builders of participants for each compiler setting and of one that is a Python process.

    Derivatives are programs of their own, so that the others are timed where a compiler fails with those.
    """
    system, name = problem.system, f"-DMODEL={problem.system.identifier}"
    sources = {quantity: compiler.generate(system, outputs) for quantity, outputs in OUTPUTS.items()}
    lower = {LOWER: compiler.generate(system, BOTH, mass_matrix="lower")}
    programs = {
        KANEGEN: _program("kanegen.c", sources, (name,), SINGLE_STATE_TASKS),
        f"{KANEGEN}, lower triangle of [A]": _program(
            "kanegen_lower.c", lower, (name,), (Task("lower", LOWER),)
        ),
    }
    if problem.has_derivatives:
        inverse = replace(system, name=f"{system.name}_{_INVERSE}")
        derived = {
            DERIVATIVES: compiler.generate(system, ("forward_dynamics_derivatives",)),
            _INVERSE: compiler.generate(inverse, ("mass_matrix", "inverse_dynamics_derivatives")),
        }
        flags = (name, f"-DINVERSE={system.identifier}_{_INVERSE}")
        programs[f"{KANEGEN}, derivatives"] = _program(
            "kanegen_derivatives.c", derived, flags, DERIVATIVES_TASKS
        )
    for title, program in programs.items():
        for setting in here(SETTINGS):
            yield f"{title} ({setting.name})", functools.partial(_participant, problem, program, setting)
    yield PYTHON, functools.partial(_from_python, problem, sources)


def _program(
    main: str, sources: Mapping[str, Source], flags: tuple[str, ...], tasks: Sequence[Task]
) -> _Program:
    """Return a driver with the C of all sources, one folder for each, since their names are the same."""
    files = {
        f"{folder}/{name}": text for folder, source in sources.items() for name, text in code(source).items()
    }
    drivers = {name: driver(name) for name in ("kanegen_blocks.h", main)}
    both = tuple(one for task in tasks for one in (task, _in_batches(task)))
    return _Program({**drivers, **files}, flags, both)


def _participant(problem: Problem, program: _Program, setting: Setting) -> list[Participant]:
    """Return the participant of one program in one compiler setting."""
    file = compiled(KANEGEN, program.files, (*setting.flags, *program.flags))
    return [Participant(KANEGEN, setting, (str(file),), problem.states_file, program.tasks)]


def _in_batches(task: Task) -> Task:
    """Return the task that computes the same quantity of many states in one call."""
    return Task(f"{task.name} batch", task.quantity, batch=True)


def _from_python(problem: Problem, sources: Mapping[str, Source]) -> list[Participant]:
    """Return the participant that calls the compiled functions from Python."""
    path = problem.folder / "libraries"
    path.write_bytes(pickle.dumps({quantity: load(source) for quantity, source in sources.items()}))
    command = (sys.executable, "-m", "kanegen.studies.bench.python_driver")
    tasks = (*SINGLE_STATE_TASKS, *map(_in_batches, SINGLE_STATE_TASKS))
    (setting,) = here((DEFAULT,))
    return [Participant(PYTHON, setting, command, problem.states_file, tasks, (str(path),))]
