"""Forms in which a function fills a symmetric matrix: all of it, or its lower triangle.

The values are the same in every form, and so are their bits. What is left out is stored nowhere, and a batch
does not move it.
"""

from __future__ import annotations

from dataclasses import replace

from kanegen.program.check import check
from kanegen.program.ir import Op, Output, Program

FULL = "full"
"""All elements, row-major."""

LOWER = "lower"
"""The elements on and below the diagonal, in their places of the whole array."""

PACKED = "packed"
"""The same by rows without gaps: row i and column j <= i at i (i + 1)/2 + j."""

SPARSE = "sparse"
"""The same by rows without entries that are zero in every state."""

FORMS = (FULL, LOWER, PACKED, SPARSE)
"""The forms of a symmetric matrix."""


def with_form(program: Program, name: str, form: str) -> Program:
    """Return the program whose output array `name`, a symmetric matrix, has one of `FORMS`."""
    if form == FULL:
        return program
    outputs = [_in_form(program, one, form) if one.array.name == name else one for one in program.outputs]
    return check(replace(program, outputs=tuple(outputs)))


def _in_form(program: Program, output: Output, form: str) -> Output:
    """Return the output of the lower triangle of a whole matrix."""
    matrix = output.array
    rows, width = matrix.shape
    entries = [(row, column) for row in range(rows) for column in range(row + 1)]
    if form == SPARSE:
        entries = [one for one in entries if not _is_zero(program, output.values[width * one[0] + one[1]])]
    pattern = tuple(entries)
    places = [width * row + column for row, column in pattern]
    values = tuple(output.values[place] for place in places)
    if form == LOWER:
        doc = f"{matrix.doc}; the lower triangle, the elements above the diagonal are left as they are"
        array = replace(matrix, doc=doc, pattern=pattern, form=form)
        return replace(output, array=array, values=values, places=tuple(places))
    doc = f"{matrix.doc}; the lower triangle by rows, row i and column j <= i at i (i + 1)/2 + j"
    if form == SPARSE:
        doc = f"{matrix.doc}; the lower triangle by rows without entries that are zero in every state"
    array = replace(matrix, shape=(len(values),), doc=doc, of_freedoms=False, pattern=pattern, form=form)
    return replace(output, array=array, values=values)


def _is_zero(program: Program, value: int) -> bool:
    instruction = program.instructions[value]
    return instruction.op is Op.CONSTANT and instruction.number == 0.0
