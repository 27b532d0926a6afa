"""MuJoCo in C: the library and the headers of the Python package `mujoco`, which is not imported."""

from __future__ import annotations

import functools
from pathlib import Path

from kanegen.errors import MissingError
from kanegen.extras import require
from kanegen.studies.bench.building import compiled, driver
from kanegen.studies.bench.contestant import Contestant
from kanegen.studies.bench.peers.arena import ONE, Arena, Makers
from kanegen.studies.bench.peers.mjcf import mjcf
from kanegen.studies.bench.settings import AS_SHIPPED

MUJOCO = "MuJoCo"


def makers(arena: Arena) -> Makers:
    """One contestant."""
    yield MUJOCO, functools.partial(_contestants, arena)


def _contestants(arena: Arena) -> list[Contestant]:
    folder = require("mujoco")
    library = _library(folder)
    flags = (*AS_SHIPPED.flags, f"-I{folder / 'include'}")
    libraries = (str(library), f"-Wl,-rpath,{library.parent}", "-lm")
    program = compiled("mujoco", {"mujoco.c": driver("mujoco.c")}, flags, libraries)
    model = arena.written("model.xml", mjcf(arena.system))
    return [Contestant(MUJOCO, AS_SHIPPED, (str(program),), arena.file, ONE, (model,))]


def _library(folder: Path) -> Path:
    found = sorted([*folder.glob("libmujoco.so*"), *folder.glob("libmujoco*.dylib")])
    if not found:
        raise MissingError(f"the Python package mujoco has no libmujoco in {folder}")
    return found[0]
