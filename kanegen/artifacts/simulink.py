"""The artifact "simulink": functions with fixed sizes for the block C Caller, and how to set it up."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from typing import Any

from kanegen.c.formats import Formats, formats
from kanegen.c.interface import PREPARE, Function
from kanegen.c.layout import BREAK, WIDTH, wrap
from kanegen.c.source import Source
from kanegen.c.templates import fill
from kanegen.model.quoting import c_comment
from kanegen.program.ir import PREPARED, Array

TYPES = {"double": "double", "float": "single"}
"""Types of signals by type of numbers in C."""


@dataclass(frozen=True)
class MovedArray:
    """An array with several axes, which is row-major in the C and column-major in Simulink.

    Attributes:
        name: Its name.
        shape: Its shape.
        size: Number of its elements.
        is_output: Whether the function fills it.
    """

    name: str
    shape: tuple[int, ...]
    size: int
    is_output: bool


@dataclass(frozen=True)
class Block:
    """A function for a block.

    Attributes:
        name: Its name.
        doc: Lines of its documentation.
        prototype: Lines of its prototype, without the semicolon.
        call: Lines of the call of the generated function.
        moved: Its arrays with several axes.
        has_prepared: Whether it prepares constants from parameters.
    """

    name: str
    doc: tuple[str, ...]
    prototype: tuple[str, ...]
    call: tuple[str, ...]
    moved: tuple[MovedArray, ...]
    has_prepared: bool


def simulink(source: Source) -> dict[str, str]:
    """Return header, source and page on their use, by name."""
    variables = _variables(source)
    return {
        f"{variables['facade']}{suffix}": fill(f"artifacts/simulink/model_simulink{suffix}", **variables)
        for suffix in (".h", ".c", ".md")
    }


def refusal(source: Source) -> str:
    """Return why there are no blocks of `source`, "" if there are."""
    arrays = formats(source.variant)
    foreign = [one.name for one in (arrays.storage, arrays.parameters) if one.c_type not in TYPES]
    if foreign:
        return (
            f"Simulink has no signals in {foreign[0]}, which arrays of this code hold. Choose --precision "
            "double or float, or --storage double."
        )
    return ""


def _variables(source: Source) -> dict[str, Any]:
    """Return the variables of the templates."""
    model, arrays = source.model, formats(source.variant)
    prepare = next((one for one in source.functions if one.name == PREPARE), None)
    blocks = [_block(one, prepare, model.name, arrays) for one in source.functions if one is not prepare]
    moved = [array for block in blocks for array in block.moved]
    facade = f"{model.name}_simulink"
    sources = [name for name in source.code if name.endswith(".c") and not name.endswith("_batch.c")]
    return {
        "model": model,
        "facade": facade,
        "guard": f"{model.prefix}_SIMULINK_H",
        "real": arrays.storage.c_type,
        "signal": TYPES[arrays.storage.c_type],
        "functions": blocks,
        "moves": {
            "inputs": any(not array.is_output for array in moved),
            "outputs": any(array.is_output for array in moved),
        }
        if moved
        else {},
        "prepare": {
            "type": arrays.of(PREPARED).c_type,
            "size": prepare.outputs[0].size,
            "parameters": model.parameters,
        }
        if prepare
        else None,
        "operations": source.operations["prepare"],
        "files": [f"{facade}.c", *sources],
        "flags": " ".join(source.variant.flags),
    }


def _block(function: Function, prepare: Function | None, model: str, arrays: Formats) -> Block:
    """Return the function of a block."""
    inputs = [array for array in function.inputs if array.name != PREPARED]
    has_prepared = len(inputs) < len(function.inputs)
    given = [*inputs, *(prepare.inputs if has_prepared and prepare else ())]
    moved = [
        MovedArray(array.name, array.shape, array.size, array in function.outputs)
        for array in (*inputs, *function.outputs)
        if len(array.shape) > 1
    ]
    declared = [_input(array, arrays) for array in given]
    declared += [f"{arrays.of(one.name).c_type} {one.name}[{one.size}]" for one in function.outputs]
    rows = {array.name for array in moved}
    passed = ["prepared"] * has_prepared + [_passed(array, rows) for array in inputs]
    passed += [f"rows_of_{one.name}" if one.name in rows else one.name for one in function.outputs]
    name = f"{model}_block_{function.name}"
    return Block(
        name,
        tuple(_doc(function, given)),
        tuple(wrap(f"int {name}({f',{BREAK}'.join(declared)})", indent="", hanging="    ")),
        tuple(wrap(f"const int status = {model}_{function.name}({f',{BREAK}'.join(passed)});")),
        tuple(moved),
        has_prepared,
    )


def _input(array: Array, arrays: Formats) -> str:
    """Return the declaration of an input: an array with its size, or a number."""
    kind = arrays.of(array.name).c_type
    return f"const {kind} {array.name}[{array.size}]" if array.shape else f"{kind} {array.name}"


def _passed(array: Array, rows: set[str]) -> str:
    """Return an input as the generated function takes it."""
    if array.name in rows:
        return f"rows_of_{array.name}"
    return array.name if array.shape else f"&{array.name}"


def _doc(function: Function, given: list[Array]) -> list[str]:
    """Return the lines of the documentation of a function."""
    lines = textwrap.wrap(c_comment(f"{function.doc[:1].upper()}{function.doc[1:]}"), WIDTH - 3)
    lines.append("")
    for kind, arrays in (("in", given), ("out", function.outputs)):
        for array in arrays:
            doc = f"{array.doc} ({array.unit})"
            shape = f", {' x '.join(map(str, array.shape))} column by column" if len(array.shape) > 1 else ""
            text = f"@param[{kind}] {array.name}  {c_comment(doc)}{shape}"
            lines += textwrap.wrap(text, WIDTH - 3, subsequent_indent="    ")
    return [*lines, "@return the status"]
