"""Pinocchio in C++: headers of the Python packages `pin` and `cmeel-eigen`, one program for every model."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from kanegen.extras import headers
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.studies.bench.building import compiled, driver
from kanegen.studies.bench.contestant import Contestant
from kanegen.studies.bench.peers.arena import DERIVED, Arena, Makers
from kanegen.studies.bench.peers.floating import FreeFlyer
from kanegen.studies.bench.peers.joints import Joint, floating_joints, joints
from kanegen.studies.bench.results import DYNAMICS, EQUATIONS, Task
from kanegen.studies.bench.settings import NATIVE

PINOCCHIO = "Pinocchio"
FREE_FLYER = "Pinocchio, free-flyer"

TWO_WAYS = (Task("equations", EQUATIONS), Task("aba", DYNAMICS), Task("cholesky", DYNAMICS))

_BOOST = (  # Pinocchio's list of joints is longer than Boost's lists are by default
    "-std=c++17",
    "-DNDEBUG",
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
)


def makers(arena: Arena) -> Makers:
    """In kanegen's coordinates and, where a body has six freedoms, with free-flyers."""
    yield PINOCCHIO, functools.partial(_same, arena)
    if any(all(body.joint.free) for body in arena.system.bodies):
        yield FREE_FLYER, functools.partial(_floating, arena)


def _same(arena: Arena) -> list[Contestant]:
    arguments = [arena.written("joints", _table(arena.system, joints(arena.system)))]
    tasks: tuple[Task, ...] = TWO_WAYS
    if arena.derives:
        arguments, tasks = [*arguments, "derivatives"], (*tasks, DERIVED)
    return [Contestant(PINOCCHIO, NATIVE, (str(_program()),), arena.file, tasks, tuple(arguments))]


def _floating(arena: Arena) -> list[Contestant]:
    tree = floating_joints(arena.system)
    way = FreeFlyer(tree)
    table = arena.written("free-flyer-joints", _table(arena.system, tree))
    states = way.states(arena.states).write(arena.folder / "free-flyer-states")
    convert = functools.partial(way.results, states=arena.states)
    return [Contestant(FREE_FLYER, NATIVE, (str(_program()),), states, TWO_WAYS, (table,), convert)]


def _program() -> Path:
    """The driver, which takes minutes to compile once."""
    include = headers("libpinocchio", "pinocchio/algorithm/aba.hpp")
    eigen = headers("cmeel-eigen", "eigen3/Eigen/Core") / "eigen3"
    flags = (*_BOOST, *NATIVE.flags, f"-I{include}", f"-I{eigen}")
    return compiled("pinocchio", {"pinocchio.cpp": driver("pinocchio.cpp")}, flags)


def _table(system: System, tree: Sequence[Joint]) -> str:
    """The model as drivers/pinocchio.cpp reads it."""
    return "\n".join([_words(system.values().gravity), *(_line(joint) for joint in tree), ""])


def _line(joint: Joint) -> str:
    placement, body = joint.placement, joint.body
    mass = np.array(body.mass)
    numbers = [placement.rotation, placement.position, mass, body.centre, body.central_inertia]
    columns = " ".join(map(str, joint.columns))
    return f"{joint.parent} {joint.kind} {columns} {' '.join(_words(part) for part in numbers)}"


def _words(values: Floats) -> str:
    return " ".join(repr(float(value)) for value in np.ravel(values))
