"""The artifact "self-test": a program that says which properties of IEEE arithmetic a compiler keeps."""

from __future__ import annotations

from kanegen.c.source import Source
from kanegen.c.templates import fill

NAME = "selftest.c"
"""Name of the file."""


def selftest(source: Source) -> dict[str, str]:
    """Return `selftest.c`, which is the same beside every source."""
    return {NAME: selftest_text()}


def selftest_text() -> str:
    """Return the program, which prints one line for every property that holds."""
    return fill("artifacts/selftest.c")
