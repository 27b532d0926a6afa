"""kanegen's own C in three settings of the compiler, and called from Python."""

from __future__ import annotations

import functools
import pickle
import sys
from collections.abc import Mapping

from kanegen import compiler
from kanegen.c import Source
from kanegen.library import load
from kanegen.library.native.build import code
from kanegen.recursion.outputs import EQUATIONS as BOTH
from kanegen.studies.bench.building import compiled, driver
from kanegen.studies.bench.contestant import Contestant
from kanegen.studies.bench.outcome import KANEGEN, PYTHON
from kanegen.studies.bench.peers.arena import DERIVED, ONE, Arena, Makers
from kanegen.studies.bench.results import DERIVATIVES, DYNAMICS, EQUATIONS, Task
from kanegen.studies.bench.settings import EXACT, NATIVE, RELAXED, Setting

MANY = (Task("equations batch", EQUATIONS, batch=True), Task("dynamics batch", DYNAMICS, batch=True))
MANY_DERIVED = Task("derivatives batch", DERIVATIVES, batch=True)
OUTPUTS = {EQUATIONS: BOTH, DYNAMICS: ("forward_dynamics",)}


def makers(arena: Arena) -> Makers:
    """One contestant a setting, and one that is a Python process."""
    sources = {quantity: compiler.generate(arena.system, outputs) for quantity, outputs in OUTPUTS.items()}
    files = _files(sources)
    if arena.derives:
        derived = compiler.generate(arena.system, ("forward_dynamics_derivatives",))
        files |= _files({DERIVATIVES: derived})
    for setting in (EXACT, NATIVE, RELAXED):
        yield f"{KANEGEN} {setting.name}", functools.partial(_contestant, arena, files, setting)
    yield PYTHON, functools.partial(_from_python, arena, sources)


def _files(sources: Mapping[str, Source]) -> dict[str, str]:
    """The C, a folder a quantity: both have files of the same names."""
    return {
        f"{folder}/{name}": text for folder, source in sources.items() for name, text in code(source).items()
    }


def _contestant(arena: Arena, files: Mapping[str, str], setting: Setting) -> list[Contestant]:
    flags = [*setting.flags, f"-DMODEL={arena.system.name}"]
    tasks = [*ONE, *MANY]
    if arena.derives:
        flags.append("-DDERIVATIVES")
        tasks += [DERIVED, MANY_DERIVED]
    program = compiled(KANEGEN, {"driver.c": driver("kanegen.c"), **files}, flags)
    return [Contestant(KANEGEN, setting, (str(program),), arena.file, tuple(tasks))]


def _from_python(arena: Arena, sources: Mapping[str, Source]) -> list[Contestant]:
    path = arena.folder / "libraries"
    path.write_bytes(pickle.dumps({quantity: load(source) for quantity, source in sources.items()}))
    command = (sys.executable, "-m", "kanegen.studies.bench.calls")
    return [Contestant(PYTHON, EXACT, command, arena.file, ONE, (str(path),))]
