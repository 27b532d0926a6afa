"""The artifact "example": a program in C that calls every function at one state and prints the results."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from kanegen.c.declarations import declarator
from kanegen.c.description import ModelDescription
from kanegen.c.element_names import names_of_variables
from kanegen.c.formats import Formats, formats
from kanegen.c.interface import PREPARE, Function
from kanegen.c.source import Source
from kanegen.c.templates import fill
from kanegen.model.quoting import c_name
from kanegen.program.ir import PREPARED, Array
from kanegen.program.precision import DOUBLE, Precision
from kanegen.recursion.outputs import PRODUCTS


def example(source: Source) -> dict[str, str]:
    """Return the text of the example `main.c`, by its name."""
    functions, model_formats = source.functions, formats(source.variant)
    printed = [array for function in functions for array in function.outputs]
    text = fill(
        "artifacts/main.c",
        model=source.model,
        functions=functions,
        inputs=inputs(source.model, functions, model_formats),
        results=results(functions, model_formats),
        printers=_printers(printed, model_formats),
    )
    return {"main.c": text}


def inputs(
    model: ModelDescription, functions: Sequence[Function], model_formats: Formats
) -> list[tuple[str, list[str]]]:
    """Return the declaration of each input array, and a line for each of its elements, with a value.

    Args:
        model: Names of the elements, and the values of parameters.
        functions: The functions that read them.
        model_formats: Precisions of the arrays.

    Example:
        inputs(source.model, source.functions, formats(source.variant))
        # [('double x[2]', ['0.1, /* q1 */', '0.2 /* q2 */']), ...]
    """
    found: dict[str, list[str]] = {}
    for function in functions:
        for array in function.inputs:
            if array.name != PREPARED:  # which the function `prepare` fills
                precision = model_formats.of(array.name)
                lines = _initializer(_elements(model, function, array), precision)
                found[f"{precision.c_type} {declarator(array)}"] = lines
    return list(found.items())


def results(functions: Sequence[Function], model_formats: Formats) -> list[str]:
    """Return the declaration of each array that some functions fill, such as `double A[2 * 2]`.

    Example:
        results(source.functions, formats(source.variant))
    """
    printed = [array for function in functions for array in function.outputs]
    return list(dict.fromkeys(f"{model_formats.of(one.name).c_type} {declarator(one)}" for one in printed))


def _elements(model: ModelDescription, function: Function, array: Array) -> list[tuple[float, str]]:
    """Return an initial value and a label for every element; parameters have their defaults."""
    if function.name == PREPARE:
        return [(default, name) for name, default in model.parameters]
    labels = _variables(model, function, array) or _labels(model, array)
    return [((1 + i % 7) / 10, label) for i, label in enumerate(labels)]


def _variables(model: ModelDescription, function: Function, array: Array) -> list[str]:
    """Return the names of the variables of an array that is a direction of them, [] for another.

    Outputs of one function may share a direction though they differ in a variable, which then has both names.
    """
    directed = [one.name for one in function.outputs if one.name in PRODUCTS]
    names = [
        names_of_variables(name, model, array.size)
        for name in directed
        if PRODUCTS[name].direction == array.name
    ]
    return [" or ".join(dict.fromkeys(labels)) for labels in zip(*names, strict=True)]


def _labels(model: ModelDescription, array: Array) -> Sequence[str]:
    """Return a label for every element of an input array that is no direction of variables."""
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
    """Return the lines between the braces of an initializer."""
    last = len(elements) - 1
    return [
        f"{constant(value, precision)}{',' if i < last else ''} /* {c_name(label)} */"
        for i, (value, label) in enumerate(elements)
    ]


def constant(value: float, precision: Precision) -> str:
    """Return a number as a constant expression, which may not contain calls."""
    if precision.trailing_shape:
        return f"{{{value!r}, 0.0}}"
    return f"{'-' if value < 0 else ''}{precision.literal(abs(value))}"


@dataclass(frozen=True)
class Printer:
    """A function of the example that prints an array.

    Attributes:
        name: Name of the function.
        type: Type of the elements.
        format: Conversion of one element for printf.
        value: Expression of element i.
        is_of_triangle: Whether it leaves out the elements above the diagonal, which are not filled.
    """

    name: str
    type: str
    format: str
    value: str
    is_of_triangle: bool = False


def _printers(arrays: Sequence[Array], model_formats: Formats) -> dict[str, Printer]:
    """Return the function that prints each result, by name of the result."""
    kinds = list(dict.fromkeys([model_formats.storage, *(model_formats.of(array.name) for array in arrays)]))
    made = {kind: _printer(kind, f"_{number}" if number else "") for number, kind in enumerate(kinds)}
    return {array.name: _for_form(made[model_formats.of(array.name)], array) for array in arrays}


def _for_form(printer: Printer, array: Array) -> Printer:
    """Return the printer for the form of an array: that of a triangle where it is filled in part."""
    if not array.is_filled_in_part:
        return printer
    return replace(printer, name=printer.name.replace("print", "print_lower"), is_of_triangle=True)


def _printer(precision: Precision, ending: str) -> Printer:
    """Return the function that prints arrays of one precision."""
    digits, element = f"%.{precision.decimal_digits}", "values[i]"
    if precision.trailing_shape:
        return Printer(f"print{ending}", precision.c_type, "%.17g + %.17g", f"{element}.high, {element}.low")
    if precision.bytes > DOUBLE.bytes:
        return Printer(f"print{ending}", precision.c_type, f"{digits}Lg", element)
    narrow = "(double)" if precision.bytes < DOUBLE.bytes else ""
    return Printer(f"print{ending}", precision.c_type, f"{digits}g", narrow + element)
