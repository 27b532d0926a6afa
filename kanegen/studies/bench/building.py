"""Drivers of the programs that are compared, compiled behind the cache of compiled code."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path

from kanegen.errors import MissingError
from kanegen.library.native.build import program
from kanegen.library.native.commands import CommandError, TimeLimitError

TIME_LIMIT = 600
"""Seconds that a compiler is given for one file."""

_SHARED = ("driver.h", "driver.c")
"""Files that every driver has: they read the states, call the driver's functions and take the time."""

_SHARED_FLAGS = {"driver.c": ("-O2",)}
"""Compiler flags of the shared source, which are the same for every program."""


def driver(name: str) -> str:
    """Return the text of a file in drivers/."""
    return resources.files("kanegen.studies.bench.drivers").joinpath(name).read_text(encoding="utf-8")


def compiled(
    name: str,
    files: Mapping[str, str],
    flags: Sequence[str],
    libraries: Sequence[str] = ("-lm",),
    seconds: float | None = None,
) -> Path:
    """Compile the program that `files` make together with drivers/driver.c.

    Args:
        name: Name of the program.
        files: Texts by relative path; those that end in .c or .cpp are compiled.
        flags: Compiler flags of these files.
        libraries: Arguments of the linker after the objects.
        seconds: Time limit of the compiler for each file (s); None for `TIME_LIMIT`.

    Raises:
        BuildError: If there is no C compiler, or the cache folder cannot be used.
        MissingError: If there is no C++ compiler, or a compiler fails or exceeds its time limit.
    """
    texts = {shared: driver(shared) for shared in _SHARED} | dict(files)
    own = {file: flags for file in files if file.endswith((".c", ".cpp"))}
    try:
        return program(name, texts, {**_SHARED_FLAGS, **own}, libraries, seconds or TIME_LIMIT)
    except TimeLimitError as error:
        raise MissingError(f"the compiler took more than {error.seconds:g} s") from None
    except CommandError as error:
        raise MissingError(f"the compiler failed: {error.reason}") from None
