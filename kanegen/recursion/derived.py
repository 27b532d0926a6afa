"""What a recursion finds for an output."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sympy import Expr


@dataclass(frozen=True)
class Derived:
    """The entries of an output, in terms of definitions.

    Attributes:
        entries: Row-major.
        positive: What must be positive for them to hold, by freedom; empty where they always hold.
        margins: What must be positive for them to be accurate, by freedom; empty where nothing is promised.
    """

    entries: Sequence[Expr]
    positive: Sequence[Expr] = ()
    margins: Sequence[Expr] = ()
