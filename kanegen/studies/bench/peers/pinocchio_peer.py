"""The peer Pinocchio: one C++ program for all models, with headers from `pin` and `cmeel-eigen`."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from kanegen.extras import headers
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.studies.bench.building import compiled, driver
from kanegen.studies.bench.participant import Participant
from kanegen.studies.bench.peers.free_flyer import FreeFlyer
from kanegen.studies.bench.peers.joints import Joint, floating_joints, joints
from kanegen.studies.bench.peers.problem import DERIVATIVES_TASKS, Builders, Problem
from kanegen.studies.bench.results import DYNAMICS, EQUATIONS, Task
from kanegen.studies.bench.settings import CONTRACTED, CONTRACTED_AVX2, Setting, here
from kanegen.studies.bench.states import write_states

PINOCCHIO = "Pinocchio"
"""Name of the participant in the coordinates of kanegen."""

FREE_FLYER = "Pinocchio, free-flyer"
"""Name of the participant in which floating bodies are free-flyers."""

TASKS = (Task("equations", EQUATIONS), Task("aba", DYNAMICS), Task("cholesky", DYNAMICS))

BOOST = (  # Pinocchio's list of joints is longer than Boost's lists are by default
    "-std=c++17",
    "-DNDEBUG",
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
)
"""Compiler flags without which Pinocchio's headers do not compile."""


COMPILE_SECONDS = 1800
"""Time limit of the compiler, which takes three minutes on a quiet machine."""

_SETTINGS = (CONTRACTED, CONTRACTED_AVX2)
"""The compiler settings in which Pinocchio is timed."""


def builders(problem: Problem) -> Builders:
    """Yield the builder in kanegen's coordinates and, if a body has six freedoms, that with free-flyers."""
    yield PINOCCHIO, functools.partial(_with_same_coordinates, problem)
    if any(all(body.joint.free) for body in problem.system.bodies):
        yield FREE_FLYER, functools.partial(_with_free_flyers, problem)


def _with_same_coordinates(problem: Problem) -> list[Participant]:
    """Build the participant in the coordinates of kanegen."""
    arguments = [problem.write("joints", joint_table(problem.system, joints(problem.system)))]
    tasks: tuple[Task, ...] = TASKS
    if problem.has_derivatives:
        arguments, tasks = [*arguments, "derivatives"], (*tasks, *DERIVATIVES_TASKS)
    return [
        Participant(
            PINOCCHIO, setting, (str(_program(setting)),), problem.states_file, tasks, tuple(arguments)
        )
        for setting in here(_SETTINGS)
    ]


def _with_free_flyers(problem: Problem) -> list[Participant]:
    """Build the participant with free-flyers."""
    tree = floating_joints(problem.system)
    way = FreeFlyer(problem.system, tree)
    table = problem.write("free-flyer-joints", joint_table(problem.system, tree))
    states = write_states(way.states(problem.states), problem.folder / "free-flyer-states")
    convert = functools.partial(way.results, states=problem.states)
    return [
        Participant(FREE_FLYER, setting, (str(_program(setting)),), states, TASKS, (table,), convert)
        for setting in here(_SETTINGS)
    ]


def participant_of_outputs(problem: Problem, tasks: Sequence[Task], body: int) -> Participant:
    """Build the participant that computes outputs of kanegen beside [A], {f} and {ydot}.

    Args:
        problem: The model and its states.
        tasks: Tasks, whose names are those of outputs in drivers/pinocchio_outputs.cpp.
        body: Number of the body whose frame is chosen, and held in contact.

    Raises:
        MissingError: If Pinocchio or a C++ compiler is missing, or the compiler fails.
    """
    tree = joints(problem.system)
    carriers = {k: number for number, joint in enumerate(tree, start=1) for k in joint.bodies}
    numbers = " ".join(str(carriers[k]) for k in range(1, len(problem.system.bodies) + 1))
    names = tuple(task.name for task in tasks)
    arguments = (
        problem.write("outputs-joints", joint_table(problem.system, tree)),
        numbers,
        str(body),
        *names,
    )
    command = (str(_program(CONTRACTED, "pinocchio_outputs.cpp")),)
    return Participant(PINOCCHIO, CONTRACTED, command, problem.states_file, tuple(tasks), arguments)


def _program(setting: Setting, name: str = "pinocchio.cpp") -> Path:
    """Compile a driver, which takes minutes the first time, and return its path."""
    include = headers("libpinocchio", "pinocchio/algorithm/aba.hpp")
    eigen = headers("cmeel-eigen", "eigen3/Eigen/Core") / "eigen3"
    flags = (*BOOST, *setting.flags, f"-I{include}", f"-I{eigen}")
    files = {file: driver(file) for file in ("pinocchio_model.h", name)}
    return compiled(name.removesuffix(".cpp"), files, flags, seconds=COMPILE_SECONDS)


def joint_table(system: System, tree: Sequence[Joint]) -> str:
    """Return the model in the format that drivers/pinocchio_model.h describes."""
    return "\n".join([_words(system.values().gravity), *(_line(joint) for joint in tree), ""])


def _line(joint: Joint) -> str:
    """Return the line of a joint in the format of the driver."""
    placement, body = joint.placement, joint.body
    mass = np.array(body.mass)
    armature = np.array(joint.armature)
    numbers = [armature, placement.rotation, placement.position, mass, body.center, body.central_inertia]
    columns = " ".join(map(str, joint.columns))
    return f"{joint.parent} {joint.kind} {columns} {' '.join(_words(part) for part in numbers)}"


def _words(values: Floats) -> str:
    """Return numbers separated by spaces."""
    return " ".join(repr(float(value)) for value in np.ravel(values))
