"""The C of a case: compile its files one by one, and time one state."""

from __future__ import annotations

import platform
import re
import shutil
import time
from pathlib import Path

from benchmarks.growth.cases import Case
from kanegen.library.native import commands, compilers
from kanegen.options import STRICT

DRIVER = Path(__file__).with_name("driver.c")
ARGUMENTS = {
    "forcing": "x, y, out",
    "forward_dynamics": "x, y, tau, out",
    "mass_matrix": "x, out",
}


KINDS = ("", " batch")
"""Kinds of files, for one state and for many at once, as they end the names of measures."""


def compiled(folder: Path, kind: str, time_limit: float) -> dict[str, float]:
    """Compile every file of a kind with kanegen's default flags, one after the other.

    Returns:
        Seconds to compile and, where binutils is installed, bytes of instructions.

    Raises:
        TimeLimitError: If a file takes more than `time_limit` seconds.
        BuildError: If the compiler fails.
    """
    files = [path.name for path in sorted(folder.glob("*.c")) if path.name != "main.c"]
    chosen = [file for file in files if ("_batch" in file) == bool(kind)]
    start = time.perf_counter()
    for file in chosen:
        command = [*_compiler(), *STRICT.flags, "-c", file, "-o", f"{file}.o"]
        commands.make(command, f"{file}.o", folder, time_limit)
    seconds = time.perf_counter() - start
    can_tell = platform.system() == "Linux" and shutil.which("size")
    sizes = [_text_bytes(folder / f"{file}.o") for file in chosen] if can_tell else []
    return {f"compile{kind}": seconds} | ({f"text{kind}": sum(sizes)} if sizes else {})


def _text_bytes(file: Path) -> float:
    """Return the size of the instructions in an object file (byte)."""
    printed = commands.output(["size", "-A", "-d", file])
    return float(sum(map(int, re.findall(r"^\.text\S*\s+(\d+)", printed, flags=re.MULTILINE))))


def link(case: Case, folder: Path, freedoms: int) -> Path:
    """Link the program that times one state and return its path."""
    output, name = case.curve.output, f"{case.curve.family}{case.bodies}"
    definitions = [
        f'-DHEADER="{name}.h"',
        f"-DFREEDOMS={freedoms}",
        f"-DRESULTS={freedoms**2 if output == 'mass_matrix' else freedoms}",
        f"-DCALL={name}_{output}({ARGUMENTS[output]})",
    ]
    objects = [path.name for path in sorted(folder.glob("*.c.o")) if "_batch" not in path.name]
    command = [*_compiler(), "-O2", f"-I{folder}", *definitions, str(DRIVER), *objects, "-lm"]
    commands.make([*command, "-o", "timing"], "timing", folder)
    return folder / "timing"


def run_time(program: Path, seconds: float) -> float:
    """Return the nanoseconds of one state, measured for about `seconds`."""
    return float(commands.output([program, str(seconds)]))


def _compiler() -> tuple[str, ...]:
    return (*compilers.find().command, "-std=c99")
