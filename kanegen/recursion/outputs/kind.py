"""What is known of an output before there is a system."""

from __future__ import annotations

from collections.abc import Callable, Sized
from dataclasses import dataclass

from kanegen.model.system import System
from kanegen.program.ir import Array


@dataclass(frozen=True)
class Subject:
    """What an output is about that not every system has.

    Attributes:
        found: What a system has of it.
        missing: What to say of a system that has none, and how to mend it.
    """

    found: Callable[[System], Sized]
    missing: str


@dataclass(frozen=True)
class OutputKind:
    """An output that can be asked for.

    Attributes:
        array: The array that it fills.
        inputs: Names of the arrays that it may read, beside those of `EVERYWHERE`.
        subject: What it is about, so that only systems with it have the output; None where all do.
    """

    array: Callable[[System], Array]
    inputs: tuple[str, ...]
    subject: Subject | None = None
