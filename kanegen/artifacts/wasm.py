"""The artifact "wasm": JavaScript, TypeScript and a page for the module of WebAssembly of a source.

The module itself is made by a compiler, in `kanegen.browser.wasm`, and lies beside these files.
"""

from __future__ import annotations

import html
import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from kanegen.artifacts.loads import with_rows_read
from kanegen.artifacts.model_fields import model_fields
from kanegen.artifacts.statuses import requirements
from kanegen.c.formats import Formats, formats
from kanegen.c.interface import PREPARE, Function
from kanegen.c.layout import columns
from kanegen.c.source import Source
from kanegen.c.steps import LENGTH
from kanegen.c.templates import fill
from kanegen.model.quoting import c_comment
from kanegen.program.ir import PREPARED, Array
from kanegen.program.precision import FLOAT, Precision
from kanegen.recursion.outputs import RATES

FOLDER = "wasm"
"""Folder of the files, a package of npm, beside the C."""

STEP = "step_rk4"
"""The function whose motion the page draws, where a source has it."""


def refusal(source: Source) -> str:
    """Return why a source cannot become WebAssembly, "" if it can."""
    variant, needs = source.variant, ""
    if "long double" in (source.precision, source.storage):
        needs = "long double. Take precision double-double."
    elif variant.sincos == "libm":
        needs = "sine and cosine of a C library. Take sincos shared."
    elif variant.flushes:
        needs = "a mode that flushes subnormal numbers. Take strict semantics."
    return f"WebAssembly has no {needs}" if needs else ""


def wasm(source: Source) -> dict[str, str]:
    """Return module, types, page and description of the package, by their paths."""
    model, kinds = source.model, formats(source.variant)
    variables = {
        "model": model,
        "arrays": _arrays(source, kinds),
        "methods": [_Method.of(with_rows_read(one, model), kinds) for one in source.functions],
        "conditions": _conditions(source),
        "description": _fields(source),
        "shown": json.dumps(_shown(source.functions)),
        "held": _held(source.functions),
        "title": html.escape(model.shown),
        "has_batches": source.has_batches,
        "may_not_converge": source.may_not_converge,
        "called": _called(source.functions),
        "has_steps": any(function.name == STEP for function in source.functions),
        "length": LENGTH.name if any(LENGTH.name in _names(one.inputs) for one in source.functions) else "",
    }
    names = {"model.js": f"{model.name}.js", "model.d.ts": f"{model.name}.d.ts"}
    return {
        f"{FOLDER}/{names.get(template, template)}": fill(f"artifacts/wasm/{template}", **variables)
        for template in ("model.js", "model.d.ts", "index.html", "package.json", "README.md")
    }


def _fields(source: Source) -> str:
    """Return the description of a source in JSON, one field a line."""
    fields = {name: json.dumps(value, allow_nan=False) for name, value in model_fields(source).items()}
    return "{\n" + "".join(f'  "{name}": {value},\n' for name, value in fields.items()) + "}"


@dataclass(frozen=True)
class _Place:
    """An array in the memory of the module.

    Attributes:
        size: Number of elements of one state.
        type: Class of its typed array in JavaScript.
        shared: Whether all states have it in common.
        doc: What it holds, with lengths and unit, as part of a comment.
    """

    size: int
    type: str
    shared: bool
    doc: str


@dataclass(frozen=True)
class _Method:
    """A function as a method of a model.

    Attributes:
        name: Name of the function.
        doc: Lines of its documentation.
        arguments: Names of the arrays that it takes.
        result: Type in TypeScript of what it returns.
    """

    name: str
    doc: Sequence[str]
    arguments: Sequence[str]
    result: str

    @property
    def signature(self) -> str:
        """The arguments in TypeScript, each of which can be left out."""
        return ", ".join(f"{name}?: Numbers" for name in self.arguments)

    @classmethod
    def of(cls, function: Function, kinds: Formats) -> _Method:
        """Return the method of a function."""
        inputs = [array for array in function.inputs if array.name != PREPARED]
        results = {array.name: _type(kinds.of(array.name)) for array in function.outputs}
        results.pop(PREPARED, None)
        members = "; ".join(f"{name}: {type_}" for name, type_ in results.items())
        result = members.partition(": ")[2] if len(results) == 1 else f"{{ {members} }}"
        rows = [("@param", array.name, _meaning(array)) for array in inputs]
        rows += [("@returns", "", _meaning(array)) for array in function.outputs if array.name != PREPARED]
        lines = [c_comment(function.doc), *columns(rows)]
        return cls(function.name, lines, [array.name for array in inputs], result if results else "void")


def _arrays(source: Source, kinds: Formats) -> dict[str, _Place]:
    """Return the arrays of all functions by name, in the order in which they occur."""
    common = {name for function in source.functions for name in function.shared}
    found: dict[str, _Place] = {}
    for function in source.functions:
        for array in (*function.inputs, *function.outputs):
            precision = kinds.of(array.name)
            parts = 2 if precision.trailing_shape else 1
            shared = array.name in common or (function.name == PREPARE and not function.has_batch)
            pairs = ", pairs of high and low parts" if parts == 2 else ""
            place = _Place(parts * array.size, _type(precision), shared, _meaning(array) + pairs)
            found.setdefault(array.name, place)
    return found


def _type(precision: Precision) -> str:
    """Return the class of typed arrays of a precision."""
    return "Float32Array" if precision is FLOAT else "Float64Array"


def _meaning(array: Array) -> str:
    """Return lengths, content and unit of an array as part of a comment."""
    lengths = " x ".join(map(str, array.shape or (1,)))
    return c_comment(f"[{lengths}] {array.doc} ({array.unit})")


def _conditions(source: Source) -> dict[str, str]:
    """Return the conditions of results of each function, those about later rows first and freedoms last."""
    found: dict[str, list[dict[str, Any]]] = {}
    for one in requirements(source):
        first = -len(source.model.freedom_names) - 1 if one.first is None else one.first
        condition = {"first": first, "quantity": one.quantity, "failure": one.failure, "loss": one.loss}
        found.setdefault(one.function, []).append(condition)
    return {name: json.dumps(conditions) for name, conditions in found.items()}


def _shown(functions: Sequence[Function]) -> dict[str, list[tuple[str, int]]]:
    """Return the functions whose results the page shows, with the lengths of rows of their arrays."""
    some = [one for one in functions if one.name != PREPARE and LENGTH.name not in _names(one.inputs)]
    return {one.name: [(array.name, array.row) for array in one.outputs] for one in some}


def _called(functions: Sequence[Function]) -> Function | None:
    """Return the function that the README calls, {ydot} where the source has it; None if all are steps."""
    shown = _shown(functions)
    some = [one for one in functions if one.name in shown]
    return next((one for one in some if one.name == RATES[0]), next(iter(some), None))


def _held(functions: Sequence[Function]) -> str:
    """Return the arguments of a step in the script of the page: the length, and what the arrays hold."""
    steps = [one for one in functions if one.name == STEP]
    names = [name for one in steps for name in _names(one.inputs) if name != PREPARED]
    return ", ".join("STEP" if name == LENGTH.name else "undefined" for name in names)


def _names(arrays: Sequence[Array]) -> list[str]:
    return [array.name for array in arrays]
