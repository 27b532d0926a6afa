"""The errors that kanegen raises, one class for each kind of mistake that a user can make.

Every class is a `KanegenError`, which is a `ValueError`, so one `except` catches them all. A message says
the mistake, its place and its remedy, in one line of bounded length whatever a file or a program holds:
`quoted` shows the beginning and the end of a long value, and control characters as escapes.
"""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import os
import reprlib
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any, TypeVar

Result = TypeVar("Result")

QUOTED = 120
"""Largest number of characters of one quoted value in a message."""

LONGEST_MESSAGE = 4000
"""Largest number of characters of a message."""

LONGEST_OUTPUT = 40_000
"""Largest number of characters of a note that holds the output of another program."""


def quoted(value: object) -> str:
    """Return the `repr` of a value for a message, in one line of at most about `QUOTED` characters.

    Example:
        quoted("a" * 10**7)  # 'aaaa...aaaa', 120 characters
    """
    return excerpt(_QUOTATION.repr(value), QUOTED)


def counted(number: int, noun: str, plural: str = "") -> str:
    """Return a number with its noun, whose plural has an s at its end unless it is given.

    Example:
        counted(1, "body", "bodies")  # "1 body"
    """
    return f"{number} {noun if number == 1 else plural or noun + 's'}"


def excerpt(text: str, longest: int, lines: bool = False) -> str:
    """Return the beginning and the end of a text, with control characters as escapes.

    Args:
        text: The text.
        longest: Number of characters beyond which the middle is left out.
        lines: Whether the text may have several lines.
    """
    if len(text) > longest:
        half = (longest - len(_LEFT_OUT)) // 2
        text = f"{text[:half]}{_LEFT_OUT}{text[-half:]}"
    if text.isprintable():
        return text
    kept = " \n" if lines else " "
    return "".join(c if c in kept or c.isprintable() else repr(c)[1:-1] for c in text)


_LEFT_OUT = "..."


class _Quotation(reprlib.Repr):
    """`repr` of values of any size in bounded time and length."""

    def __init__(self) -> None:
        super().__init__()
        self.maxstring = self.maxother = QUOTED
        self.maxlist = self.maxtuple = self.maxdict = self.maxset = self.maxarray = 12

    def repr_int(self, value: int, level: int) -> str:
        """Return the digits of an integer; of a long one, about how many there are."""
        digits = int(value.bit_length() * 0.30103) + 1
        return repr(value) if digits < self.maxlong else f"<an integer of about {digits} digits>"

    def repr_instance(self, value: Any, level: int) -> str:
        """Return the `repr` of any other value in one line."""
        return " ".join(super().repr_instance(value, level).split())


_QUOTATION = _Quotation()


class KanegenError(ValueError):
    """Base class of all errors that kanegen raises on purpose."""

    def __init__(self, message: object = "") -> None:
        super().__init__(excerpt(str(message), LONGEST_MESSAGE))


class ModelError(KanegenError):
    """The system cannot exist: its connection array is bad, a mass is negative, a name is no name in C."""


class ReadError(ModelError):
    """A model file cannot be read; the message begins with the file and, where known, the line."""


class StatusError(KanegenError):
    """A result is not finite, not found by an iteration, or may be inaccurate, and errors were asked for."""


class SingularError(ModelError, StatusError):
    """[A] is singular in every state, or in the one asked about; the message names the freedom."""


class OptionError(KanegenError):
    """An option does not exist or does not fit, such as an unknown output."""


class ArrayError(KanegenError):
    """An array of states or loads has the wrong shape or type."""


class WriteError(KanegenError):
    """Files cannot be written to the folder."""


class BuildError(KanegenError):
    """There is no C compiler, or it failed; the message holds its command and its first error.

    A note of the exception, which tracebacks show, holds the whole output.
    """


class SweepError(KanegenError):
    """A worker of a sweep failed or ended; the message names the chunk of rows that it computed."""


class MissingError(KanegenError):
    """An optional package is not installed, or another program lacks a feature that is needed."""


class BudgetError(KanegenError):
    """No variant keeps a budget of error or time; the message names the nearest variant and its figures."""


class CertificateError(KanegenError):
    """A certificate cannot be read, was edited, or belongs to another model or version."""


class KanegenWarning(UserWarning):
    """Kanegen accepts something unusual, such as moments of inertia that violate the triangle inequality."""

    def __init__(self, message: object = "") -> None:
        super().__init__(excerpt(str(message), LONGEST_MESSAGE))


def call_named(label: str, function: Callable[..., Result], time: float, *state: Any) -> Result:
    """Return what a function of the caller returns, and name the input in an exception that it raises.

    Args:
        label: What the function is for, with which errors begin, such as "effort".
        function: The function of the time, and of the state where it gets one.
        time: The time, s.
        state: Further arguments.

    Raises:
        KanegenError: If the function raises an exception, which is the cause of this one: of the same class
            where that is one of kanegen, else an `OptionError`.

    Example:
        tau = call_named("effort", effort, 0.31, x, y)
    """
    try:
        return function(time, *state)
    except Exception as error:
        is_own = isinstance(error, KanegenError) and type(error).__module__ == __name__
        kind = type(error) if is_own else OptionError
        shown = f"{type(error).__name__}: {error}".removesuffix(": ")
        message = f"{label}: at t = {time:.9g} s the function failed with {' '.join(shown.split())}"
        raise kind(message) from error


_PACKAGE = f"{Path(__file__).parent}{os.sep}"

_BETWEEN = (dataclasses.__file__, functools.__file__, contextlib.__file__)
"""Files of Python through which one function of kanegen calls another."""


def warn(message: str) -> None:
    """Issue a `KanegenWarning` at the line outside kanegen that made the innermost call of it.

    Example:
        warn("unused parameters: a, b.")
    """
    level, frame = 2, sys._getframe(1)
    while _is_inside(frame) and frame.f_back is not None:
        level, frame = level + 1, frame.f_back
    warnings.warn(message, KanegenWarning, stacklevel=level)


def _is_inside(frame: FrameType) -> bool:
    """Return whether a frame is one of kanegen, or between two of kanegen, as that of a dataclass is."""
    code = frame.f_code
    is_of_dataclass = code.co_filename == "<string>" and code.co_name == "__init__"
    return code.co_filename.startswith(_PACKAGE) or code.co_filename in _BETWEEN or is_of_dataclass
