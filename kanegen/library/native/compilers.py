"""The C and C++ compilers of the machine: which one is used, its version, and whether it has OpenMP."""

from __future__ import annotations

import functools
import os
import shlex
import shutil
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from kanegen.errors import BuildError, MissingError, quoted
from kanegen.extras import is_installed
from kanegen.files import temporary_folder
from kanegen.library.native import commands

VARIABLES = ("KANEGEN_CC", "CC")
"""Environment variables that may name a C compiler; the first one that is set counts."""

COMMANDS = ("cc", "gcc", "clang")
"""Names of C compilers that are looked for on the path, in this order, where no variable names one."""

CPP_VARIABLE = "CXX"
"""Environment variable that may name a C++ compiler."""

CPP_COMMANDS = ("c++", "g++", "clang++")
"""Names of C++ compilers that are looked for on the path, in this order."""

OPENMP = "-fopenmp"
"""Compiler flag with which batches are shared among several threads."""

_OPENMP_PROGRAM = "#include <omp.h>\nint main(void) { return omp_get_max_threads() < 1; }\n"


_TIME_LIMIT = 120.0
"""Time limit, s, of what a compiler does at once: print its version, compile ten lines."""

_SETTINGS = (
    *("CCC_OVERRIDE_OPTIONS", "COMPILER_PATH", "CPATH", "CPLUS_INCLUDE_PATH", "C_INCLUDE_PATH"),
    *("GCC_EXEC_PREFIX", "LIBRARY_PATH"),
)
"""Environment variables with which gcc and clang make other code."""


@dataclass(frozen=True)
class Compiler:
    """A compiler that takes the options of gcc and clang.

    Attributes:
        command: Program and first arguments, such as `("/usr/bin/gcc",)`.
        version_text: What `--version` prints.
        programs: File of every program in the command behind all links, its size and the time of its last
            change.
        settings: Environment variables that change the code, as text.
    """

    command: tuple[str, ...]
    version_text: str
    programs: str = ""
    settings: str = ""

    @property
    def version(self) -> str:
        """The first line that `--version` prints."""
        return (self.version_text.splitlines() or [""])[0]

    @property
    def fingerprint(self) -> str:
        """A text that differs between compilers, or settings of one, that may make other code."""
        return "\n".join((shlex.join(self.command), self.version_text, self.programs, self.settings))


def find(command: str | None = None) -> Compiler:
    """Find the C compiler: `command`, or that of `VARIABLES`, of `COMMANDS` or of the package ziglang.

    Args:
        command: A shell command, which may have arguments, such as "ccache gcc".

    Raises:
        BuildError: If there is no C compiler, or the one that is named does not exist.
    """
    if command is not None:
        return _named(command, "compiler")
    for variable in VARIABLES:
        if os.environ.get(variable):
            return _named(os.environ[variable], f"${variable}")
    for name in COMMANDS:
        path = shutil.which(name)
        if path is not None:
            return _versioned((path,))
    if is_installed("ziglang"):
        return _versioned((sys.executable, "-m", "ziglang", "cc"))
    raise BuildError(
        f"no C compiler: none of {', '.join(COMMANDS)} is on the path. Install gcc or clang with the "
        "system's package manager, or `pip install ziglang`, or name a compiler in $KANEGEN_CC."
    )


def find_cpp() -> Compiler:
    """Find the C++ compiler: that of `CPP_VARIABLE`, or the first of `CPP_COMMANDS` on the path.

    Raises:
        MissingError: If there is no C++ compiler, or the one that is named does not exist.
    """
    named = shlex.split(os.environ.get(CPP_VARIABLE, ""))
    for program, *arguments in [named] if named else [[name] for name in CPP_COMMANDS]:
        path = shutil.which(program)
        if path is not None:
            return _versioned((path, *arguments))
    raise MissingError(f"there is no C++ compiler {' or '.join(named[:1] or CPP_COMMANDS)}")


@functools.cache
def has_openmp(compiler: Compiler) -> bool:
    """Whether `compiler` compiles and links a program with `OPENMP`."""
    with temporary_folder(Path(tempfile.gettempdir())) as folder:
        (folder / "openmp.c").write_text(_OPENMP_PROGRAM)
        command = [*compiler.command, OPENMP, "openmp.c", "-o", "openmp"]
        return commands.run(command, folder, _TIME_LIMIT).returncode == 0


def _named(command: str, origin: str) -> Compiler:
    """Return the compiler that the user names by `command`; `origin` says where, for error messages."""
    try:
        program, *arguments = shlex.split(command)
        path = shutil.which(program)
    except (ValueError, AttributeError):
        raise BuildError(f"{origin}: {quoted(command)} is not a command.") from None
    if path is None:
        raise BuildError(
            f"{origin}: the C compiler {quoted(program)} cannot be found. Install it or name another."
        )
    return _versioned((path, *arguments))


def _versioned(command: tuple[str, ...]) -> Compiler:
    """Return the compiler `command` with its version.

    Raises:
        BuildError: If it cannot be run, or does not answer.
    """
    programs = "\n".join(_identity(path) for word in command if (path := shutil.which(word)))
    settings = "\n".join(f"{name}={os.environ[name]}" for name in _SETTINGS if name in os.environ)
    return Compiler(command, _version_text(command, programs), programs, settings)


def _identity(program: str) -> str:
    """Return the file of a program behind all links, its size and the time of its last change."""
    found = Path(program).stat()
    return f"{os.path.realpath(program)} {found.st_size} {found.st_mtime_ns}"


@functools.cache
def _version_text(command: tuple[str, ...], _programs: str) -> str:
    """Return what a compiler prints about its version; each is asked once a process."""
    try:
        with temporary_folder(Path(tempfile.gettempdir())) as folder:  # where some leave an empty object file
            result = commands.run([*command, "--version"], folder, _TIME_LIMIT)
    except commands.TimeLimitError as error:
        raise BuildError(f"{error} Does this compiler wait for something? Name another one.") from None
    return result.stdout + result.stderr
