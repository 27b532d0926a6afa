"""The example: what it declares, fills and prints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from kanegen.c.declarations import declarator
from kanegen.c.formats import Formats
from kanegen.c.interface import PREPARE, Function, ModelFacts
from kanegen.program.ir import Array
from kanegen.program.precision import DOUBLE, Precision


def inputs(model: ModelFacts, functions: Sequence[Function], formats: Formats) -> list[tuple[str, list[str]]]:
    """Inputs of the example: the declaration of each array, and a line for each element."""
    found: dict[str, list[str]] = {}
    for function in functions:
        for array in function.inputs:
            if array.name not in function.shared:
                held = formats.of(array.name)
                lines = _initializer(_elements(model, function, array), held)
                found[f"{held.c_type} {declarator(array)}"] = lines
    return list(found.items())


def results(functions: Sequence[Function], formats: Formats) -> list[str]:
    """Declarations of the arrays that the example fills."""
    arrays = (array for function in functions for array in function.outputs)
    return list(dict.fromkeys(f"{formats.of(array.name).c_type} {declarator(array)}" for array in arrays))


def _elements(model: ModelFacts, function: Function, array: Array) -> list[tuple[float, str]]:
    """An initial value and a label for every element; parameters have their defaults."""
    if function.name == PREPARE:
        return [(default, name) for name, default in model.parameters]
    return [((1 + i % 7) / 10, label) for i, label in enumerate(_labels(model, array))]


def _labels(model: ModelFacts, array: Array) -> Sequence[str]:
    if array.name == "prescribed":
        phrases = ("{}", "rate of {}", "second derivative of {}")
        return [phrase.format(name) for phrase in phrases for name in model.prescribed_names]
    if array.name == "x":
        return model.coordinate_names
    if not array.shape:
        return [array.unit]
    if len(array.shape) == 1:
        return [speed or name for speed, name in zip(model.speeds, model.freedom_names, strict=True)]
    of_points = array.shape[0] == len(model.points) and array.name.startswith("point_")
    rows = [name for name, _ in model.points] if of_points else model.body_names
    return [f"{name}, {axis}" for name in rows for axis in "xyz"]


def _initializer(elements: Sequence[tuple[float, str]], precision: Precision) -> list[str]:
    last = len(elements) - 1
    return [
        f"{_initial(value, precision)}{',' if i < last else ''} /* {label} */"
        for i, (value, label) in enumerate(elements)
    ]


def _initial(value: float, precision: Precision) -> str:
    """A number as C has it in an initialiser, where there are no calls."""
    if precision.trailing_shape:
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
    digits, element = f"%.{precision.decimal_digits}", "values[i]"
    if precision.trailing_shape:
        return Printer(f"print{ending}", precision.c_type, "%.17g + %.17g", f"{element}.high, {element}.low")
    if precision.bytes > DOUBLE.bytes:
        return Printer(f"print{ending}", precision.c_type, f"{digits}Lg", element)
    narrow = "(double)" if precision.bytes < DOUBLE.bytes else ""
    return Printer(f"print{ending}", precision.c_type, f"{digits}g", narrow + element)
