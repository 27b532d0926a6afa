"""SymPy's KanesMethod with the C that PyDy writes from it, where that ends in time."""

from __future__ import annotations

import functools
import sys

from kanegen.errors import MissingError
from kanegen.extras import require
from kanegen.library.native import commands
from kanegen.studies.bench.building import compiled, driver
from kanegen.studies.bench.contestant import Contestant
from kanegen.studies.bench.peers.arena import ONE, Arena, Makers
from kanegen.studies.bench.settings import NATIVE

PYDY = "SymPy + PyDy"

TIME_LIMIT = 120
"""Seconds for deriving the equations and writing the C."""

MOST = 9
"""Freedoms of the largest model that is tried: every further one more than doubles the time."""


def makers(arena: Arena) -> Makers:
    """One contestant."""
    yield PYDY, functools.partial(_contestants, arena)


def _contestants(arena: Arena) -> list[Contestant]:
    n = len(arena.system.freedoms)
    require("pydy")
    if n > MOST:
        raise MissingError(f"not tried with {n} freedoms, which are more than {MOST}")
    texts = {"pydy.c": driver("pydy.c"), "evaluate.c": _code(arena)}
    program = compiled("pydy", texts, NATIVE.flags)
    return [Contestant(PYDY, NATIVE, (str(program),), arena.file, ONE[:1])]


def _code(arena: Arena) -> str:
    """C from another process, which is killed when its time is over."""
    model = arena.folder / "model.toml"
    arena.system.save(model)
    command = [sys.executable, "-m", "kanegen.studies.bench.peers.pydy_code", str(model)]
    try:
        done = commands.run(command, seconds=TIME_LIMIT)
    except commands.TimeLimitError:
        raise MissingError(f"did not finish in {TIME_LIMIT} s") from None
    if done.returncode:
        lines = done.stderr.strip().splitlines()
        raise MissingError(f"failed: {lines[-1] if lines else done.returncode}")
    return done.stdout
