"""Who takes part on a model, and why somebody does not."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import kanegen as kg
from benchmarks.peers import casadi_peer, joints, kanegen_peer, pinocchio_peer
from benchmarks.peers.building import CACHE, CONTRACTED, EXACT, NATIVE, RELAXED, MissingError, Setting
from benchmarks.peers.contest import Contestant
from benchmarks.peers.floating import FreeFlyer
from benchmarks.peers.results import Task
from benchmarks.peers.states import States

KANEGEN = "kanegen"
CASADI = "CasADi"
PINOCCHIO = "Pinocchio"
FREE_FLYER = "Pinocchio, free-flyer"

ONE = (Task("equations", "equations"), Task("dynamics", "dynamics"))
MANY = (Task("equations batch", "equations"), Task("dynamics batch", "dynamics"))
TWO_WAYS = (Task("equations", "equations"), Task("aba", "dynamics"), Task("cholesky", "dynamics"))

Makers = Iterator[tuple[str, Callable[[], Contestant]]]


def contestants(system: kg.System, states: States) -> tuple[list[Contestant], list[str]]:
    """Everybody who can take part, Pinocchio in the same coordinates first, and the reasons of the others."""
    CACHE.mkdir(parents=True, exist_ok=True)
    file = states.write(CACHE / f"{system.name}.states")
    named = [*_pinocchio(system, states, file), *_kanegen(system, file), *_casadi(system, file)]
    with ThreadPoolExecutor(max_workers=2) as pool:
        futures = [(name, pool.submit(make)) for name, make in named]
    present, missing = [], []
    for name, future in futures:
        try:
            present.append(future.result())
        except MissingError as error:
            missing.append(f"{name}: {error}")
    return present, missing


def _pinocchio(system: kg.System, states: States, file: Path) -> Makers:
    def same() -> Contestant:
        table = _table(system, joints.joints(system), "same")
        return Contestant(PINOCCHIO, CONTRACTED, pinocchio_peer.program(), file, TWO_WAYS, (table,))

    def floating() -> Contestant:
        tree = joints.floating_joints(system)
        way = FreeFlyer(tree)
        table = _table(system, tree, "free-flyer")
        theirs = way.states(states).write(CACHE / f"{system.name}-free-flyer.states")
        convert = functools.partial(way.results, states=states)
        return Contestant(
            FREE_FLYER, CONTRACTED, pinocchio_peer.program(), theirs, TWO_WAYS, (table,), convert
        )

    yield PINOCCHIO, same
    if any(all(body.joint.free) for body in system.bodies):
        yield FREE_FLYER, floating


def _table(system: kg.System, tree: list[joints.Joint], name: str) -> str:
    path = CACHE / f"{system.name}-{name}.joints"
    path.write_text(pinocchio_peer.table(system, tree), encoding="utf-8")
    return str(path)


def _kanegen(system: kg.System, file: Path) -> Makers:
    code = kanegen_peer.code(system)
    for setting in (EXACT, NATIVE, RELAXED):

        def make(setting: Setting = setting) -> Contestant:
            program = kanegen_peer.program(system, code, setting)
            return Contestant(KANEGEN, setting, program, file, (*ONE, *MANY))

        yield f"{KANEGEN} {setting.name}", make


def _casadi(system: kg.System, file: Path) -> Makers:
    try:
        code = casadi_peer.code(system)
    except MissingError as error:
        yield CASADI, functools.partial(_absent, error)
        return
    for setting in (EXACT, CONTRACTED):

        def make(setting: Setting = setting) -> Contestant:
            program = casadi_peer.program(system, code, setting)
            return Contestant(CASADI, setting, program, file, ONE)

        yield f"{CASADI} {setting.name}", make


def _absent(error: MissingError) -> Contestant:
    raise error
