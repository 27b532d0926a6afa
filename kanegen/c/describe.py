"""Tables of a model for the header, the example and the README."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from kanegen.c.declarations import declarator
from kanegen.c.formats import Formats, uniform
from kanegen.c.interface import PREPARE, Function, ModelFacts
from kanegen.c.lanes import Lanes
from kanegen.c.layout import WIDTH, columns
from kanegen.c.sincos import Sincos
from kanegen.precision import DOUBLE, DOUBLE_DOUBLE, FLOAT, LONG_DOUBLE, Precision
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


def batch_stack(functions: Sequence[Function], lanes: Lanes, formats: Formats) -> int:
    """KiB that the arrays of a batch function take on the stack with the widest instructions, at most."""
    numbers = max((f.numbers for f in functions if f.has_batch and f.in_lanes), default=0)
    copies = 2 if formats.is_mixed else 1
    return -(-copies * numbers * lanes.widths[-1] * lanes.precision.bytes // 1024)


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


def freedoms(model: ModelFacts) -> list[tuple[int, str, str, str]]:
    """Index in {y}, name, unit in {x}, and the name in {y} where that is not the rate."""
    rows = zip(model.freedom_names, model.freedom_units, model.speeds, strict=True)
    return [(index, name, unit, speed) for index, (name, unit, speed) in enumerate(rows)]


def coordinates(model: ModelFacts) -> list[tuple[int, str, str]]:
    """Index in {x}, name, unit, where there are others than freedoms; otherwise nothing."""
    if not model.has_quaternions:
        return []
    rows = zip(model.coordinate_names, model.coordinate_units, strict=True)
    return [(index, name, unit) for index, (name, unit) in enumerate(rows)]


def loads(model: ModelFacts) -> list[tuple[int, str]]:
    """Row of force and torque, name of the body, for every body that takes them."""
    pairs = zip(model.body_names, model.loaded, strict=True)
    return [(row, name) for row, (name, is_loaded) in enumerate(pairs) if is_loaded]


def point_loads(model: ModelFacts) -> list[tuple[int, str]]:
    """Row of point_force and point_moment, name of the point, for every point that takes them."""
    pairs = zip((name for name, _ in model.points), model.loaded_points, strict=True)
    return [(row, name) for row, (name, is_loaded) in enumerate(pairs) if is_loaded]


def force_elements(model: ModelFacts) -> list[str]:
    """Lines of a comment that say what they are."""
    width = WIDTH - len(" *     ")
    lines = [textwrap.wrap(words, width, subsequent_indent="    ") for words in model.force_elements]
    return [line for wrapped in lines for line in wrapped]


def poses(model: ModelFacts, outputs: Sequence[str]) -> list[tuple[int, str]]:
    """Row of poses and name of the body, where they are computed and not of all bodies in their order."""
    some = "body_poses" in outputs and model.poses != model.body_names
    return list(enumerate(model.poses)) if some else []


def reactions(model: ModelFacts, outputs: Sequence[str]) -> list[tuple[int, str, str]]:
    """Place, name of the locked direction, unit of its reaction load, where they are computed."""
    asked = "reaction_loads" in outputs
    return [(place, *names) for place, names in enumerate(model.reactions)] if asked else []


def example_inputs(
    model: ModelFacts, functions: Sequence[Function], formats: Formats
) -> list[tuple[str, list[str]]]:
    """Inputs of the example: the declaration of each array, and a line for each element."""
    found: dict[str, list[str]] = {}
    for function in functions:
        for array in function.inputs:
            if array.name not in function.shared:
                held = formats.of(array.name)
                lines = _initializer(_elements(model, function, array), held)
                found[f"{held.type} {declarator(array)}"] = lines
    return list(found.items())


def example_results(functions: Sequence[Function], formats: Formats) -> list[str]:
    """Declarations of the arrays that the example fills."""
    arrays = (array for function in functions for array in function.outputs)
    return list(dict.fromkeys(f"{formats.of(array.name).type} {declarator(array)}" for array in arrays))


def _elements(model: ModelFacts, function: Function, array: Array) -> list[tuple[float, str]]:
    """An initial value and a label for every element; parameters have their defaults."""
    if function.name == PREPARE:
        return [(default, name) for name, default in model.parameters]
    if array.name == "prescribed":
        phrases = ("{}", "rate of {}", "second derivative of {}")
        labels = [phrase.format(name) for phrase in phrases for name in model.prescribed_names]
    elif not array.shape:
        labels = [array.unit]
    elif len(array.shape) == 1:
        labels = list(model.coordinate_names)
        if array.name != "x":
            labels = [speed or name for speed, name in zip(model.speeds, model.freedom_names, strict=True)]
    else:
        of_points = array.shape[0] == len(model.points) and array.name.startswith("point_")
        rows = [name for name, _ in model.points] if of_points else model.body_names
        labels = [f"{name}, {axis}" for name in rows for axis in "xyz"]
    return [((1 + i % 7) / 10, label) for i, label in enumerate(labels)]


def _initializer(elements: Sequence[tuple[float, str]], precision: Precision) -> list[str]:
    last = len(elements) - 1
    return [
        f"{_initial(value, precision)}{',' if i < last else ''} /* {label} */"
        for i, (value, label) in enumerate(elements)
    ]


def _initial(value: float, precision: Precision) -> str:
    """A number as C has it in an initialiser, where there are no calls."""
    if precision.tail:
        return f"{{{value!r}, 0.0}}"
    return f"{'-' if value < 0 else ''}{precision.literal(abs(value))}"


@dataclass(frozen=True)
class Printer:
    """A function of the example that prints an array.

    Attributes:
        name: Of the function.
        type: Of the elements.
        format: For printf, of one element.
        value: Element i.
    """

    name: str
    type: str
    format: str
    value: str


def printers(functions: Sequence[Function], formats: Formats) -> dict[str, Printer]:
    """By name of every result what prints it."""
    arrays = [array for function in functions for array in function.outputs]
    kinds = list(dict.fromkeys([formats.storage, *(formats.of(array.name) for array in arrays)]))
    made = {kind: _printer(kind, f"_{number}" if number else "") for number, kind in enumerate(kinds)}
    return {array.name: made[formats.of(array.name)] for array in arrays}


def _printer(precision: Precision, ending: str) -> Printer:
    digits, element = f"%.{precision.decimals}", "values[i]"
    if precision.tail:
        return Printer(f"print{ending}", precision.type, "%.17g + %.17g", f"{element}.high, {element}.low")
    if precision.bytes > DOUBLE.bytes:
        return Printer(f"print{ending}", precision.type, f"{digits}Lg", element)
    narrow = "(double)" if precision.bytes < DOUBLE.bytes else ""
    return Printer(f"print{ending}", precision.type, f"{digits}g", narrow + element)


def arithmetic(formats: Formats, has_parameters: bool) -> str:
    """What a user has to know of the precisions; nothing where all is double."""
    if formats == uniform(FLOAT):
        prepared = ", by _prepare too" if has_parameters else ""
        return (
            "Single precision: all numbers are of type float. Constants are computed in double and rounded "
            f"once{prepared}; below 1.2e-38 they lose digits or become 0. {_NAMES}"
        )
    if formats == uniform(DOUBLE):
        return ""
    kinds = f"States, loads and results are of type {formats.storage.type}"
    kinds += f", parameters of type {formats.parameters.type}." if has_parameters else "."
    return f"{_ARITHMETICS[formats.arithmetic]} {kinds} {_NAMES}"


def sines(sincos: Sincos | None, arithmetic: Precision) -> str:
    """What is said of sine and cosine."""
    if sincos is None:
        where = "kanegen_pairs.h" if arithmetic is DOUBLE_DOUBLE else "the C library"
        return f"Sine and cosine are those of {where}, for one state and in batches."
    if sincos.plain:
        degrees = f"{sincos.degree} and {sincos.degree + 1}"
        return (
            f"Sine and cosine are polynomials of degree {degrees} ({sincos.header}.h), for angles of every "
            f"size. Their largest errors are {sincos.error}."
        )
    return (
        f"Sine and cosine are kanegen's own ({sincos.header}.h), for angles of every size, and off by at "
        f"most {sincos.error}. Compiled with -ffp-contract=off and without -ffast-math they have the same "
        "bits everywhere, whatever the C library."
    )


_NAMES = (
    "The functions have the names of those in double precision, so a program can use only one of the two."
)

_ARITHMETICS = {
    DOUBLE: "All is computed in double precision.",
    FLOAT: "All is computed in single precision.",
    LONG_DOUBLE: "All is computed in long double, which has 64 bits or more; platforms where it is no wider "
    "than double are refused.",
    DOUBLE_DOUBLE: "All is computed in pairs of doubles, about 32 digits (kanegen_pairs.h); what is stored "
    "as double is rounded once. Angles beyond 1e6 rad give NaN, and so does what overflows.",
}
