"""The peer SymPy with PyDy: equations of KanesMethod, and the C that PyDy writes from them."""

from __future__ import annotations

import functools
import sys

from kanegen.errors import MissingError
from kanegen.extras import require
from kanegen.library.native import commands
from kanegen.studies.bench.building import compiled, driver
from kanegen.studies.bench.participant import Participant
from kanegen.studies.bench.peers.problem import SINGLE_STATE_TASKS, Builders, Problem
from kanegen.studies.bench.settings import CONTRACTED

PYDY = "SymPy + PyDy"
"""Name of the participant."""

TIME_LIMIT = 120
"""Seconds for deriving the equations and writing the C."""

MOST_FREEDOMS = 9
"""Freedoms of the largest model that is tried: every further one more than doubles the time."""


def builders(problem: Problem) -> Builders:
    """Yield the name and the builder of the only participant."""
    yield PYDY, functools.partial(_build, problem)


def _build(problem: Problem) -> list[Participant]:
    """Build the only participant, ready to run."""
    n = len(problem.system.freedoms)
    require("pydy")
    if n > MOST_FREEDOMS:
        raise MissingError(f"not tried with {n} freedoms, which are more than {MOST_FREEDOMS}")
    texts = {"pydy.c": driver("pydy.c"), "evaluate.c": _code(problem)}
    program = compiled("pydy", texts, CONTRACTED.flags)
    return [Participant(PYDY, CONTRACTED, (str(program),), problem.states_file, SINGLE_STATE_TASKS[:1])]


def _code(problem: Problem) -> str:
    """Generate the C in another process, which is killed at the time limit."""
    model = problem.folder / "model.toml"
    problem.system.save(model)
    command = [sys.executable, "-m", "kanegen.studies.bench.peers.pydy_code", str(model)]
    try:
        done = commands.run(command, seconds=TIME_LIMIT)
    except commands.TimeLimitError:
        raise MissingError(f"did not finish in {TIME_LIMIT} s") from None
    if done.returncode:
        lines = done.stderr.strip().splitlines()
        raise MissingError(f"failed: {lines[-1] if lines else done.returncode}")
    return done.stdout
