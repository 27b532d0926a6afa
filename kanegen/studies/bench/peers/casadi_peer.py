"""C that CasADi generates for the same quantities of the same joints."""

from __future__ import annotations

import functools

from kanegen.extras import module
from kanegen.studies.bench.building import compiled, driver
from kanegen.studies.bench.contestant import Contestant
from kanegen.studies.bench.peers.arena import Arena, Makers
from kanegen.studies.bench.settings import EXACT, NATIVE, Setting

CASADI = "CasADi"


def makers(arena: Arena) -> Makers:
    """One contestant a setting of the compiler."""
    yield CASADI, functools.partial(_contestants, arena)


def _contestants(arena: Arena) -> list[Contestant]:
    module("casadi")
    files = module("kanegen.studies.bench.peers.casadi_code").code(arena.system, arena.derives)
    texts = {"casadi.c": driver("casadi.c"), **files}
    return [_contestant(arena, texts, setting) for setting in (EXACT, NATIVE)]


def _contestant(arena: Arena, texts: dict[str, str], setting: Setting) -> Contestant:
    wanted = ("-DDERIVATIVES",) if arena.derives else ()
    program = compiled("casadi", texts, (*setting.flags, *wanted))
    return Contestant(CASADI, setting, (str(program),), arena.file, arena.one)
