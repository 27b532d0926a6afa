"""Drivers become programs, behind the cache of compiled code: nothing is compiled twice."""

from __future__ import annotations

import os
import platform
import shlex
import shutil
import subprocess
import tempfile
import threading
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

from kanegen.errors import MissingError
from kanegen.library.native import cache, compilers
from kanegen.studies.bench import patient

PATIENCE = 600
"""Seconds that a compiler is given for one file."""

_CXX = ("c++", "g++", "clang++")
_SHARED = ("contest.h", "contest.c")
_ONE_AT_A_TIME: defaultdict[str, threading.Lock] = defaultdict(threading.Lock)
"""By entry of the cache: the second thread that asks for a program waits and finds it made."""


@dataclass(frozen=True)
class Step:
    """A source file, and the command that compiles it."""

    file: str
    command: tuple[str, ...]

    @property
    def object(self) -> str:
        """What it makes."""
        return f"{self.file}.o"


def driver(name: str) -> str:
    """Text of a file in drivers/."""
    return resources.files("kanegen.studies.bench.drivers").joinpath(name).read_text(encoding="utf-8")


def compiled(
    name: str, files: Mapping[str, str], flags: Sequence[str], libraries: Sequence[str] = ("-lm",)
) -> Path:
    """The program that `files` make together with drivers/contest.c.

    Every file that ends in .c or .cpp is compiled with `flags`; contest.c, which only reads, calls and takes
    the time, is compiled in the same way for everybody.

    Args:
        name: Of the program.
        files: Texts by relative path.
        flags: Of the compilers.
        libraries: What the linker takes after the objects.

    Raises:
        BuildError: If there is no C compiler, or the cache folder cannot be used.
        MissingError: If there is no C++ compiler, or a compiler fails or exceeds its time.
    """
    texts = {shared: driver(shared) for shared in _SHARED} | dict(files)
    c, cxx = compilers.find(), _cxx() if any(file.endswith(".cpp") for file in files) else None
    steps = [Step("contest.c", (*c.command, "-O2"))]
    steps += [Step(file, (*c.command, *flags)) for file in files if file.endswith(".c")]
    if cxx is not None:
        steps += [Step(file, (*cxx.command, *flags)) for file in files if file.endswith(".cpp")]
    linker = cxx or c

    def fill(entry: Path) -> None:
        with tempfile.TemporaryDirectory() as temporary:
            folder = Path(temporary)
            _write(texts, folder)
            for step in steps:
                _run([*step.command, f"-I{folder}", "-c", step.file, "-o", step.object], folder)
            objects = [step.object for step in steps]
            _run([*linker.command, *objects, "-o", str(entry / name), *libraries], folder)

    parts = [word for item in sorted(texts.items()) for word in item]
    parts += [name, c.identity, linker.identity, *_machine(), *flags, *libraries]
    key = cache.key(parts)
    with _ONE_AT_A_TIME[key]:
        return cache.entry(key, fill) / name


def _write(texts: Mapping[str, str], folder: Path) -> None:
    for file, text in texts.items():
        (folder / file).parent.mkdir(parents=True, exist_ok=True)
        (folder / file).write_text(text, encoding="utf-8")


def _cxx() -> compilers.Compiler:
    """The compiler that $CXX names, or the first of the usual ones."""
    named = shlex.split(os.environ.get("CXX", ""))
    for command in [named] if named else [[name] for name in _CXX]:
        path = shutil.which(command[0])
        if path is not None:
            version = compilers.run([path, "--version"]).stdout
            return compilers.Compiler((path, *command[1:]), f"{shlex.join(command)}\n{version}")
    raise MissingError(f"there is no C++ compiler {' or '.join(named[:1] or _CXX)}")


def _machine() -> tuple[str, ...]:
    """A home folder may be shared by machines, and code made with -march=native is for one of them."""
    return platform.system(), platform.machine(), platform.node()


def _run(command: Sequence[str], folder: Path) -> None:
    try:
        result = patient.run(command, folder, PATIENCE)
    except subprocess.TimeoutExpired:
        raise MissingError(f"the compiler took more than {PATIENCE} s") from None
    if result.returncode:
        first = next((line for line in result.stderr.splitlines() if "error" in line), result.stderr[:300])
        raise MissingError(f"the compiler failed: {first}")
