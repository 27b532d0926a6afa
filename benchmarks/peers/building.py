"""Compilers, behind a cache in build/bench: nothing is compiled twice."""

from __future__ import annotations

import hashlib
import os
import shlex
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
CACHE = ROOT / "build" / "bench"
DRIVERS = Path(__file__).parent / "drivers"
PATIENCE = 240
"""Seconds that a compiler is given for one file."""


@dataclass(frozen=True)
class Setting:
    """Flags of a compiler and what they are called."""

    name: str
    flags: tuple[str, ...]


EXACT = Setting("exact", ("-O2", "-ffp-contract=off"))
NATIVE = Setting("native", ("-O3", "-march=native", "-ffp-contract=off"))
CONTRACTED = Setting("native, contracted", ("-O3", "-march=native"))
RELAXED = Setting(
    "relaxed",
    (
        "-O3",
        "-march=native",
        "-ffp-contract=fast",
        "-fno-math-errno",
        "-fno-trapping-math",
        "-fno-signed-zeros",
        "-fassociative-math",
    ),
)
"""Nothing here changes the floating-point environment of the process, as -ffast-math does when linking."""

SETTINGS = (EXACT, NATIVE, CONTRACTED, RELAXED)


class MissingError(Exception):
    """Something that a contestant needs is not there, or took too long."""


def driver(name: str) -> str:
    """Text of a file in drivers/."""
    return (DRIVERS / name).read_text(encoding="utf-8")


def compiled(program: str, files: Mapping[str, str], flags: Sequence[str], libraries: str = "-lm") -> Path:
    """The program that `files` make together with drivers/contest.c.

    Every file that ends in .c or .cpp is compiled with `flags`; contest.c, which only reads, calls and takes
    the time, is compiled in the same way for everybody.

    Raises:
        MissingError: If there is no compiler, or it fails or exceeds its time.
    """
    texts = {"contest.h": driver("contest.h"), "contest.c": driver("contest.c"), **files}
    command = (
        _compiler("CXX", "c++") if any(name.endswith(".cpp") for name in files) else _compiler("CC", "cc")
    )
    key = hashlib.sha256(repr((command, _version(command), sorted(texts.items()), flags, libraries)).encode())
    folder = CACHE / f"{program}-{key.hexdigest()[:16]}"
    if not (folder / program).exists():
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in texts.items():
            (folder / name).write_text(text, encoding="utf-8")
        objects = [_object(command, name, flags, folder) for name in texts if name.endswith((".c", ".cpp"))]
        _run([*command, *objects, "-o", f"{program}.new", *libraries.split()], folder)
        os.replace(folder / f"{program}.new", folder / program)
    return folder / program


def _object(command: Sequence[str], name: str, flags: Sequence[str], folder: Path) -> str:
    chosen = ["-O2"] if name == "contest.c" else flags
    language = _compiler("CC", "cc") if name.endswith(".c") else command
    _run([*language, *chosen, "-c", name, "-o", f"{name}.o"], folder)
    return f"{name}.o"


def _compiler(variable: str, default: str) -> tuple[str, ...]:
    command = tuple(shlex.split(os.environ.get(variable, default)))
    if shutil.which(command[0]) is None:
        raise MissingError(f"no compiler {command[0]}")
    return command


def _version(command: Sequence[str]) -> str:
    return subprocess.run([*command, "--version"], capture_output=True, text=True, check=False).stdout


def _run(command: Sequence[str], folder: Path) -> None:
    try:
        result = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, timeout=PATIENCE, check=False
        )
    except subprocess.TimeoutExpired:
        raise MissingError(f"the compiler took more than {PATIENCE} s") from None
    if result.returncode:
        first = next((line for line in result.stderr.splitlines() if "error" in line), result.stderr[:300])
        raise MissingError(f"the compiler failed: {first}")
