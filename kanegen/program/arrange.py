"""Reorder a long program so that values are used soon after they are computed.

A derivation goes body by body and carries every column of [A] along. With many columns, more values are alive
than a processor has registers, and each of them waits in memory. In the order made here a few rows of a
matrix are finished, with all that they need, before the next rows begin.
"""

from __future__ import annotations

from collections.abc import Iterator

from kanegen.program.ir import Program
from kanegen.program.selection import dependencies, subprogram

LONG = 4000
"""Number of instructions from which the order matters; shorter programs lose more overlap than they save."""

ROWS = 6
"""Rows of a matrix that are finished together: enough to overlap, few enough to keep their values near."""


def arrange(program: Program) -> Program:
    """Reorder a long program to compute a few rows of its outputs at a time, the last rows first."""
    if len(program.instructions) <= LONG:
        return program
    done: set[int] = set()
    order: list[int] = []
    for wanted in _groups(program):
        missing = dependencies(program, wanted, done)
        done.update(missing)
        order += missing
    return subprogram(program, order)


def _groups(program: Program) -> Iterator[list[int]]:
    """Yield results that are computed together: vectors, rows of matrices up to the diagonal, the rest."""
    for output in program.outputs:
        if not output.array.is_matrix:
            yield [*output.values, *output.exists_if_positive, *output.accurate_if_positive]
    for output in program.outputs:
        if output.array.is_matrix:
            rows: dict[int, list[int]] = {}
            for index, value in output.elements():
                row, column = output.array.entry(index)
                rows.setdefault(row, []).extend([value] if column <= row else [])
            for last in range(max(rows, default=-1) + 1, 0, -ROWS):
                yield [value for row in range(max(0, last - ROWS), last) for value in rows.get(row, ())]
    yield list(program.results())
