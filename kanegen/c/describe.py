"""Tables of a model for the header, the example and the README."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from kanegen.c.declarations import declarator
from kanegen.c.expression import literal
from kanegen.c.interface import PREPARE, Function, ModelFacts
from kanegen.c.lanes import Lanes
from kanegen.c.layout import columns
from kanegen.precision import Precision
from kanegen.program.ir import Array

OPERATIONS = {
    "add": "additions and subtractions",
    "multiply": "multiplications",
    "divide": "divisions",
    "sqrt": "square roots",
    "sincos": "sines and cosines",
    "prepare": "operations of the parameter-only step",
}
"""What the counts of `Source.operations` count."""


def operations(counts: Mapping[str, int]) -> list[tuple[str, int]]:
    """Operation counts in words."""
    return [(OPERATIONS[kind], number) for kind, number in counts.items() if number or kind != PREPARE]


def sizes(model: ModelFacts, functions: Sequence[Function]) -> list[tuple[str, int, str]]:
    """Enumerators of the sizes of arrays: name, value, meaning."""
    prefix = model.name.upper()
    rows = [
        (f"{prefix}_FREEDOMS", len(model.freedom_names), "n, elements of x and y"),
        (f"{prefix}_BODIES", len(model.body_names), "N"),
    ]
    for function in functions:
        if function.name == PREPARE:
            rows += [
                (f"{prefix}_{array.name.upper()}", array.size, array.doc)
                for array in (*function.inputs, *function.outputs)
            ]
    return rows


def batch_stack(functions: Sequence[Function], lanes: Lanes) -> int:
    """KiB that the arrays of a batch function take on the stack with the widest instructions, at most."""
    numbers = max((f.numbers for f in functions if f.has_batch and f.in_lanes), default=0)
    return -(-numbers * lanes.widths[-1] * lanes.precision.bytes // 1024)


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


def freedoms(model: ModelFacts) -> list[tuple[int, str, str]]:
    """Index in {x} and {y}, name, unit in {x}."""
    pairs = zip(model.freedom_names, model.freedom_units, strict=True)
    return [(index, name, unit) for index, (name, unit) in enumerate(pairs)]


def loads(model: ModelFacts) -> list[tuple[int, str]]:
    """Row of force and torque, name of the body, for every body that takes them."""
    pairs = zip(model.body_names, model.loaded, strict=True)
    return [(row, name) for row, (name, is_loaded) in enumerate(pairs) if is_loaded]


def example_inputs(
    model: ModelFacts, functions: Sequence[Function], precision: Precision
) -> list[tuple[str, list[str]]]:
    """Inputs of the example: the declarator of each array, and a line for each element."""
    found: dict[str, list[str]] = {}
    for function in functions:
        for array in function.inputs:
            if array.name not in function.shared:
                found[declarator(array)] = _initializer(_elements(model, function, array), precision)
    return list(found.items())


def example_results(functions: Sequence[Function]) -> list[str]:
    """Declarators of the arrays that the example fills."""
    return list(dict.fromkeys(declarator(array) for function in functions for array in function.outputs))


def _elements(model: ModelFacts, function: Function, array: Array) -> list[tuple[float, str]]:
    """An initial value and a label for every element; parameters have their defaults."""
    if function.name == PREPARE:
        return [(default, name) for name, default in model.parameters]
    if len(array.shape) == 1:
        labels = list(model.freedom_names)
    else:
        labels = [f"{body}, {axis}" for body in model.body_names for axis in "xyz"]
    return [((1 + i % 7) / 10, label) for i, label in enumerate(labels)]


def _initializer(elements: Sequence[tuple[float, str]], precision: Precision) -> list[str]:
    last = len(elements) - 1
    return [
        f"{literal(value, precision)}{',' if i < last else ''} /* {label} */"
        for i, (value, label) in enumerate(elements)
    ]
