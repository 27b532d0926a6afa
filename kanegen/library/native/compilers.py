"""Which C compiler to use."""

from __future__ import annotations

import functools
import importlib.util
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from kanegen.errors import BuildError

VARIABLES = ("KANEGEN_CC", "CC")
"""Environment variables that may name a compiler, the first one first."""

OPENMP = "-fopenmp"
"""Flag by which batches use several threads."""

_PROBE = "#include <omp.h>\nint main(void) { return omp_get_max_threads() < 1; }\n"

COMMANDS = ("cc", "gcc", "clang")
"""What is looked for otherwise."""


@dataclass(frozen=True)
class Compiler:
    """A C compiler that takes the options of gcc and clang.

    Attributes:
        command: Program and first arguments, such as `("/usr/bin/gcc",)`.
        identity: Command and version; code from compilers of the same identity is the same.
    """

    command: tuple[str, ...]
    identity: str


def find(command: str | None = None) -> Compiler:
    """The compiler `command`, or that of `VARIABLES`, or of `COMMANDS`, or of the package ziglang.

    Raises:
        BuildError: If there is none, or the one asked for does not exist.
    """
    if command is not None:
        return _named(command, "compiler")
    for variable in VARIABLES:
        if os.environ.get(variable):
            return _named(os.environ[variable], f"${variable}")
    for name in COMMANDS:
        path = shutil.which(name)
        if path is not None:
            return _identified((path,))
    if importlib.util.find_spec("ziglang") is not None:
        return _identified((sys.executable, "-m", "ziglang", "cc"))
    raise BuildError(
        f"no C compiler: none of {', '.join(COMMANDS)} is on the path. Install gcc or clang with the "
        "system's package manager, or `pip install ziglang`, or name a compiler in $KANEGEN_CC."
    )


def _named(command: str, origin: str) -> Compiler:
    """A compiler that somebody asked for; it may have arguments, such as `ccache gcc`."""
    try:
        program, *arguments = shlex.split(command)
    except (ValueError, AttributeError):
        raise BuildError(f"{origin}: {command!r} is not a command.") from None
    path = shutil.which(program)
    if path is None:
        raise BuildError(f"{origin}: the C compiler {program!r} cannot be found. Install it or name another.")
    return _identified((path, *arguments))


@functools.cache
def _identified(command: tuple[str, ...]) -> Compiler:
    result = run([*command, "--version"])
    return Compiler(command, f"{shlex.join(command)}\n{result.stdout}")


@functools.cache
def has_openmp(compiler: Compiler) -> bool:
    """Whether `compiler` makes and links a program with `OPENMP`."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "probe.c").write_text(_PROBE)
        command = [*compiler.command, OPENMP, "probe.c", "-o", "probe"]
        return run(command, folder).returncode == 0


def run(command: list[str], folder: str | None = None) -> subprocess.CompletedProcess[str]:
    """Run a compiler in `folder` and wait for it.

    Raises:
        BuildError: If it cannot be started.
    """
    try:
        return subprocess.run(
            command,
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            check=False,
        )
    except OSError as error:
        raise BuildError(f"{shlex.join(command)}: cannot be run: {error.strerror}.") from error


def make(command: list[str], output: str, folder: Path) -> None:
    """Run a compiler in `folder`, where it makes the file `output`.

    Raises:
        BuildError: If it does not.
    """
    result = run(command, str(folder))
    if result.returncode != 0 or not (folder / output).is_file():
        raise BuildError(
            f"the C compiler failed with status {result.returncode} and made no {output}.\n"
            f"command: {shlex.join(command)}\n{result.stdout}"
        )
