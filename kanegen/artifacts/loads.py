"""Which rows of arrays of loads a function reads, as texts for facades in other languages."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from kanegen.c.description import ModelDescription
from kanegen.c.interface import Function
from kanegen.errors import quoted
from kanegen.model.arguments import LOADS
from kanegen.program.ir import Array


def unloaded_rows(array: Array, model: ModelDescription) -> dict[int, str]:
    """Return the rows of an input whose bodies or points take no loads, with their names.

    Example:
        unloaded_rows(force, satellite)  # {1: "body 'left_panel'", 2: "body 'right_panel'"}
    """
    return model.unloaded(LOADS[array.name]) if array.name in LOADS else {}


def with_rows_read(function: Function, model: ModelDescription, text: Callable[[str], str] = str) -> Function:
    """Return a function whose inputs say which of their rows are read, where these are not all.

    Args:
        function: A generated function.
        model: Its model.
        text: What makes the names a part of the other language.
    """
    inputs = tuple(_noted(array, model, text) for array in function.inputs)
    return replace(function, inputs=inputs)


def _noted(array: Array, model: ModelDescription, text: Callable[[str], str]) -> Array:
    unloaded = unloaded_rows(array, model)
    if not unloaded:
        return array
    names = model.body_names if LOADS[array.name] == "body" else [name for name, _ in model.points]
    read = [quoted(name) for row, name in enumerate(names) if row not in unloaded]
    others = [quoted(name) for row, name in enumerate(names) if row in unloaded]
    only, shown, how = ("only ", read, "") if len(read) <= len(others) else ("", others, " not")
    rows, are = ("row", "is") if len(shown) == 1 else ("rows", "are")
    return replace(array, doc=f"{array.doc}; {only}the {rows} of {text(', '.join(shown))} {are}{how} read")
