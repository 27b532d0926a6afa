"""A published case: what its source states, what kanegen finds, and how far both may differ."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

import kanegen as kg

MODELS = Path(__file__).with_name("models")
"""The models of the cases."""


@dataclass(frozen=True)
class Row:
    """One quantity: numbers as the source prints them, and those that kanegen finds.

    Attributes:
        quantity: Name of the quantity, with its time or state.
        unit: Unit of all numbers.
        expected: Numbers as the source prints them, such as "31.6399".
        found: As many numbers from kanegen.
        allowed: Largest difference that the source allows, in the unit; by default half a unit of the last
            digit of every number.
    """

    quantity: str
    unit: str
    expected: tuple[str, ...]
    found: tuple[float, ...]
    allowed: float | None = None

    def __post_init__(self) -> None:
        if len(self.expected) != len(self.found):
            raise ValueError(f"{self.quantity}: {len(self.expected)} numbers against {len(self.found)}.")

    @property
    def differences(self) -> tuple[float, ...]:
        """Magnitudes of the differences, without the rounding that subtracting doubles would add."""
        pairs = zip(self.found, self.expected, strict=True)
        return tuple(float(abs(Decimal(found) - Decimal(expected))) for found, expected in pairs)

    @property
    def limits(self) -> tuple[float, ...]:
        """Largest differences that the source allows."""
        if self.allowed is not None:
            return (self.allowed,) * len(self.expected)
        return tuple(_half_a_unit(number) for number in self.expected)

    @property
    def share(self) -> float:
        """Largest difference over what the source allows for that number; above 1 the row fails."""
        shares = [d / limit for d, limit in zip(self.differences, self.limits, strict=True)]
        return float("inf") if np.isnan(shares).any() else max(shares)

    @property
    def holds(self) -> bool:
        """Whether every number is as close as the source allows."""
        return self.share <= 1


@dataclass(frozen=True)
class Case:
    """A published case with its numbers.

    Attributes:
        title: Title of its section.
        model: Stem of its model file in `models`, or a path from the root of the repository.
        source: Where the case is published, as a sentence in Markdown.
        problem: What it is, and how kanegen computes it.
        allowance: What the source's digits allow, and why.
        rows: The numbers.
        notes: Further paragraphs and tables below the numbers.
    """

    title: str
    model: str
    source: str
    problem: str
    allowance: str
    rows: tuple[Row, ...]
    notes: tuple[str, ...] = ()

    @property
    def holds(self) -> bool:
        """Whether every row holds."""
        return all(row.holds for row in self.rows)

    @property
    def share(self) -> float:
        """Largest share of what the source allows, of all rows."""
        return max(row.share for row in self.rows)

    @property
    def count(self) -> int:
        """Number of numbers that are compared."""
        return sum(len(row.expected) for row in self.rows)


def load(name: str) -> kg.System:
    """Return the model of a case; what kanegen warns of is part of what its source states."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", kg.KanegenWarning)
        return kg.load(MODELS / f"{name}.toml")


def build(name: str, *outputs: str) -> kg.Library:
    """Return the compiled C of the model of a case."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", kg.KanegenWarning)
        return kg.build(load(name), outputs)


def row(quantity: str, unit: str, expected: str, found: ArrayLike, allowed: float | None = None) -> Row:
    """Return a row from numbers of the source between blanks and numbers or an array of kanegen.

    Example:
        row("torques at rest", "N m", "0.0000 31.6399", library.inverse_dynamics(x, zero, zero))
    """
    return Row(quantity, unit, tuple(expected.split()), numbers(found), allowed)


def exact_row(quantity: str, unit: str, expected: Iterable[float], found: ArrayLike, allowed: float) -> Row:
    """Return a row whose expected numbers come from a formula of the source, with all digits of a double."""
    return Row(quantity, unit, tuple(repr(float(number)) for number in expected), numbers(found), allowed)


def numbers(values: ArrayLike) -> tuple[float, ...]:
    """Return the numbers of an array in its order."""
    return tuple(float(value) for value in np.ravel(np.asarray(values)))


def _half_a_unit(number: str) -> float:
    """Return half a unit of the last digit of a printed number."""
    exponent = Decimal(number).as_tuple().exponent
    if not isinstance(exponent, int):
        raise ValueError(f"{number} is no number.")
    return 0.5 * 10.0**exponent
