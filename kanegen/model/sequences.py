"""The order of the axes about which a joint's three angles turn.

Three turns about basis vectors of the moving frame reach every orientation where no two neighbours have the
same axis: six sequences of three different axes, named after Tait and Bryan, and six that end with the axis
they begin with, named after Euler.
"""

from __future__ import annotations

from itertools import product

from kanegen.choices import did_you_mean
from kanegen.errors import ModelError

Axes = tuple[int, int, int]
"""Basis vectors 0, 1, 2 about which theta1, theta2, theta3 turn."""

NOTES = "1-2-3"
"""The sequence of the notes, Eq. (4)."""

SEQUENCES: dict[str, Axes] = {
    f"{a + 1}-{b + 1}-{c + 1}": (a, b, c) for a, b, c in product(range(3), repeat=3) if a != b != c
}
"""The twelve by name."""


def check(name: object) -> None:
    """Make sure that a sequence exists.

    Raises:
        ModelError: If `name` is none of the twelve.
    """
    if not isinstance(name, str) or name not in SEQUENCES:
        raise ModelError(f"joint sequence: {name!r} is none of the twelve. {did_you_mean(name, SEQUENCES)}")
