"""Order a long program so that what belongs together is computed together.

A derivation goes body by body and carries every column of [A] along. With many columns, more values are then
waiting than a processor has registers for, and each waits in memory. In the order made here a few rows of a
matrix are finished, with all they need, before the next begin.
"""

from __future__ import annotations

from collections.abc import Iterator

from kanegen.program.ir import Program
from kanegen.program.selection import needed, selected

LONG = 4000
"""Instructions from which the order matters; in shorter programs it costs more overlap than it saves."""

ROWS = 6
"""Rows of a matrix that are finished together: enough to overlap, few enough to keep their values near."""


def arrange(program: Program) -> Program:
    """The same instructions, in a long program a few rows of the outputs at a time, the last ones first."""
    if len(program.instructions) <= LONG:
        return program
    done: set[int] = set()
    order: list[int] = []
    for wanted in _groups(program):
        missing = needed(program, wanted, done)
        done.update(missing)
        order += missing
    return selected(program, order)


def _groups(program: Program) -> Iterator[list[int]]:
    """Results that are computed together: vectors, rows of matrices up to the diagonal, what is left."""
    matrices = [output for output in program.outputs if len(output.array.shape) == 2]
    for output in program.outputs:
        if output not in matrices:
            yield [*output.values, *output.positive, *output.margins]
    for output in matrices:
        rows, width = output.array.shape
        for last in range(rows, 0, -ROWS):
            chosen = range(max(0, last - ROWS), last)
            yield [
                output.values[width * row + column] for row in chosen for column in range(min(row + 1, width))
            ]
    yield list(program.results())
