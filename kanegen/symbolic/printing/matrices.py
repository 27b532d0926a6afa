"""Statements about [A] and {f}."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import accumulate

from sympy import ImmutableMatrix

from kanegen.symbolic.printing.printers import latex
from kanegen.symbolic.printing.statements import Equation, Names, Statement, Written

SHORT_MATRIX = 600
"""A matrix whose LaTeX is shorter is printed whole, a longer one by entries."""


def matrix(name: str, value: ImmutableMatrix, names: Names) -> tuple[Statement, ...]:
    """The matrix, whole where it is short in LaTeX; in text by entries that are not zero or below others."""
    entries = tuple(_entries(name, value, names))
    lengths = accumulate(len(line) for entry in entries for line in entry.right)
    if any(length > SHORT_MATRIX for length in lengths):  # without printing the rest of a long one
        return entries
    plain = "\n".join(entry.text for entry in entries) or f"{name} = 0"
    return (Written(plain, name, (latex(value, names),)),)


def _entries(name: str, value: ImmutableMatrix, names: Names) -> Iterator[Equation]:
    """Those that are not zero; of a symmetric matrix those on the diagonal and above."""
    rows, columns = value.shape
    is_column = columns == 1
    for i in range(rows):
        for j in range(0 if is_column else i, columns):
            if value[i, j]:
                index = f"{i + 1}" if is_column else f"{i + 1},{j + 1}"
                yield Equation(f"{name}[{index}]", f"{name}_{{{index}}}", value[i, j], names)
