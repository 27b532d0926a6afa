"""The peer frax: dynamics in JAX, which compiles them for this processor; it is called from Python."""

from __future__ import annotations

import functools
import sys

from kanegen.extras import require
from kanegen.studies.bench.participant import Participant
from kanegen.studies.bench.peers.problem import SINGLE_STATE_TASKS, Builders, Problem
from kanegen.studies.bench.peers.urdf_tree import urdf_tree
from kanegen.studies.bench.results import Task
from kanegen.studies.bench.settings import COMPILED_BY_XLA
from kanegen.studies.bench.states import write_states

FRAX = "frax"
"""Name of the participant."""

GRAVITY = 9.81
"""The gravity of frax (m/s^2), a constant of its source."""


def builders(problem: Problem) -> Builders:
    """Yield the name and the builder of the only participant."""
    yield FRAX, functools.partial(_build, problem)


def _build(problem: Problem) -> list[Participant]:
    """Build the only participant; JAX compiles its functions when it first runs."""
    require("frax")
    tree = urdf_tree(problem.system, GRAVITY)
    model = problem.write("frax.urdf", tree.text)
    states = write_states(tree.states(problem.states), problem.folder / "frax-states")
    command = (sys.executable, "-m", "kanegen.studies.bench.frax_driver")
    batches = (Task(f"{task.name} batch", task.quantity, batch=True) for task in SINGLE_STATE_TASKS)
    tasks = (*SINGLE_STATE_TASKS, *batches)
    arguments = (model, str(problem.folder / "frax-compiled"))
    return [Participant(FRAX, COMPILED_BY_XLA, command, states, tasks, arguments, tree.results)]
