"""Sizes of arrays, and the enumerators of the header."""

from __future__ import annotations

from collections.abc import Sequence

from kanegen.c.describe.tables import poses, reactions
from kanegen.c.formats import Formats
from kanegen.c.interface import PREPARE, Function, ModelFacts
from kanegen.c.layout import columns
from kanegen.c.simd import Lanes


def sizes(model: ModelFacts, functions: Sequence[Function]) -> list[tuple[str, int, str]]:
    """Enumerators of the sizes of arrays: name, value, meaning."""
    prefix = model.name.upper()
    rows = [
        (f"{prefix}_COORDINATES", len(model.coordinate_names), "elements of x"),
        (f"{prefix}_FREEDOMS", len(model.freedom_names), "n, elements of y"),
        (f"{prefix}_BODIES", len(model.body_names), "N"),
    ]
    if model.points:
        rows.append((f"{prefix}_POINTS", len(model.points), "points of the bodies"))
    asked = [function.name for function in functions]
    if chosen := poses(model, asked):
        rows.append((f"{prefix}_POSES", len(chosen), "bodies with poses"))
    if loads := reactions(model, asked):
        rows.append((f"{prefix}_REACTIONS", len(loads), "locked directions with reaction loads"))
    if model.prescribed:
        rows.append((f"{prefix}_PRESCRIBED", len(model.prescribed), "p, prescribed freedoms"))
    for function in functions:
        if function.name == PREPARE:
            rows += [
                (f"{prefix}_{array.name.upper()}", array.size, array.doc)
                for array in (*function.inputs, *function.outputs)
            ]
    return rows


def parameter_indices(model: ModelFacts) -> list[tuple[str, int, str]]:
    """Enumerators of the places of parameters: name, value, default."""
    prefix = model.name.upper()
    return [
        (f"{prefix}_P_{name}", index, f"default {default!r}")
        for index, (name, default) in enumerate(model.parameters)
    ]


def enumeration(rows: Sequence[tuple[str, int, str]]) -> list[str]:
    """The lines between the braces of an enum; C++98 allows no comma after the last."""
    last = len(rows) - 1
    return columns(
        [
            (name, f"= {value}{',' if i < last else ''}", f"/* {text} */")
            for i, (name, value, text) in enumerate(rows)
        ],
        gap=" ",
    )


def batch_stack(functions: Sequence[Function], lanes: Lanes, formats: Formats) -> int:
    """KiB that the arrays of a batch function take on the stack with the widest instructions, at most."""
    numbers = max((f.numbers for f in functions if f.has_batch and f.in_lanes), default=0)
    copies = 2 if formats.is_mixed else 1
    return -(-copies * numbers * lanes.widths[-1] * lanes.precision.bytes // 1024)
