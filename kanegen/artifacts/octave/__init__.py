"""The artifact "octave": a mex file for MATLAB and Octave, and a package of functions that call it.

One source in C, `<model>_mex.c`, serves both programs. The package `+<model>` has a function with help for
each generated function, and `build`, `parameters` and `names`. An array has the shape of its documentation,
and the states of a batch are its last axis: `x` has a column for each state.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from kanegen.artifacts.loads import unloaded_rows, with_rows_read
from kanegen.artifacts.statuses import Requirement, requirements
from kanegen.c.declarations import contacts, reactions
from kanegen.c.formats import formats
from kanegen.c.interface import PREPARE, Function
from kanegen.c.source import Source
from kanegen.c.templates import fill
from kanegen.model.arguments import OPTIONAL
from kanegen.model.identifiers import identifiers
from kanegen.model.names import MAX_IDENTIFIER
from kanegen.model.quoting import c_text, matlab_text
from kanegen.program.ir import PREPARED, Array
from kanegen.recursion.outputs import OF_FRAMES

CLASSES = {"double": "mxDOUBLE_CLASS", "float": "mxSINGLE_CLASS"}
"""Classes of arrays in MATLAB by type of numbers in C."""

_WIDTH = 100
"""Columns of a line of MATLAB."""


@dataclass(frozen=True)
class MexArray:
    """An array of a function.

    Attributes:
        name: Its name.
        shape: Its shape for one state.
        is_optional: Whether it may be left out, which means zero.
        unloaded: Name in C of the table of who takes no load in which row, "NULL" where there is none.
    """

    name: str
    shape: tuple[int, ...]
    is_optional: bool
    unloaded: str


@dataclass(frozen=True)
class MexFunction:
    """A function as the mex file calls it.

    Attributes:
        name: Its name.
        inputs: Number of its inputs.
        outputs: Number of its outputs.
        arrays: Its arrays, inputs first.
        requirements: What must be positive for its results to exist.
        call: Arguments of the call of the C function.
        has_prepared: Whether it reads prepared constants.
        has_batch: Whether it has a form for many states that this mex file calls.
    """

    name: str
    inputs: int
    outputs: int
    arrays: tuple[MexArray, ...]
    requirements: tuple[Requirement, ...]
    call: tuple[str, ...]
    has_prepared: bool
    has_batch: bool


def octave(source: Source) -> dict[str, str]:
    """Return the text of every file of the mex file and its package, by its path."""
    variables = _variables(source)
    package = f"+{variables['package']}"
    files = {
        f"{variables['mex']}.c": fill("artifacts/octave/model_mex.c", **variables),
        f"{package}/build.m": fill("artifacts/octave/build.m", **variables),
        f"{package}/names.m": fill("artifacts/octave/names.m", **variables),
    }
    if variables["parameters"]:
        files[f"{package}/parameters.m"] = fill("artifacts/octave/parameters.m", **variables)
    for function in _functions(source):
        text = fill(
            "artifacts/octave/function.m",
            name=function.name,
            mex=variables["mex"],
            lines=_help(function, source, variables["package"]),
        )
        files[f"{package}/{function.name}.m"] = text
    return files


def refusal(source: Source) -> str:
    """Return why there is no mex file of `source`, "" if there is."""
    arrays = formats(source.variant)
    foreign = [one.name for one in (arrays.storage, arrays.parameters) if one.c_type not in CLASSES]
    if foreign:
        return (
            f"MATLAB and Octave have no numbers in {foreign[0]}, which arrays of this code hold. Choose "
            "--precision double or float, or --storage double."
        )
    if len(source.model.name) + len("_mex") > MAX_IDENTIFIER:
        return (
            f"names in MATLAB have at most {MAX_IDENTIFIER} characters, and {source.model.name}_mex has more."
            " Give a shorter name: --name."
        )
    return ""


def _functions(source: Source) -> list[Function]:
    return [with_rows_read(one, source.model) for one in source.functions if one.name != PREPARE]


def _variables(source: Source) -> dict[str, Any]:
    """Return the variables of the templates."""
    model, arrays = source.model, formats(source.variant)
    functions = [_mex_function(one, source) for one in _functions(source)]
    prepare = next((one for one in source.functions if one.name == PREPARE), None)
    (package,) = identifiers([model.name], "octave")
    sources = [name for name in source.code if name.endswith(".c")]
    return {
        "model": model,
        "package": package,
        "mex": f"{model.name}_mex",
        "real": arrays.storage.c_type,
        "class": CLASSES[arrays.storage.c_type],
        "parameter": arrays.parameters.c_type,
        "prepared": arrays.of(PREPARED).c_type,
        "functions": functions,
        "unloaded": _unloaded(source),
        "most_axes": max(1, *(len(array.shape) for one in functions for array in one.arrays)),
        "most_arrays": max(len(one.arrays) for one in functions),
        "freedoms": [
            f"{c_text(name)} of body {c_text(body)}"
            for name, body in zip(model.freedom_names, model.freedom_bodies, strict=True)
        ],
        "rows": [c_text(name) for name in model.rows],
        "may_not_converge": source.may_not_converge,
        "not_converged": model.not_converged,
        "prepare": _prepare(prepare, source) if prepare else None,
        "by_state": source.parameters_by_state,
        "parameters": [(name, repr(value)) for name, value in model.parameters],
        "files": [f"'{name}'" for name in (f"{model.name}_mex.c", *sources)],
        "flags": " ".join(flag for flag in source.variant.flags if not flag.startswith("-O")),
        "level": source.variant.optimisation,
        "tables": [(name, _quoted(texts)) for name, texts in _tables(source)],
        "limits": _limits(source),
    }


def _mex_function(function: Function, source: Source) -> MexFunction:
    """Return a function as the mex file calls it."""
    inputs = [array for array in function.inputs if array.name != PREPARED]
    has_prepared = len(inputs) < len(function.inputs)
    call = ["prepared"] * has_prepared + [f"in[{i}]" for i in range(len(inputs))]
    call += [f"out[{i}]" for i in range(len(function.outputs))]
    arrays = [
        *(MexArray(one.name, one.shape, one.name in OPTIONAL, _table_of(one, source)) for one in inputs),
        *(MexArray(one.name, one.shape, False, "NULL") for one in function.outputs),
    ]
    return MexFunction(
        function.name,
        len(inputs),
        len(function.outputs),
        tuple(arrays),
        tuple(one for one in requirements(source) if one.function == function.name),
        tuple(call),
        has_prepared,
        function.has_batch,
    )


def _table_of(array: Array, source: Source) -> str:
    return f"unloaded_{array.name}" if unloaded_rows(array, source.model) else "NULL"


def _unloaded(source: Source) -> dict[str, list[str]]:
    """Return for each array of loads whose rows are not all read who takes no load in which row, in C."""
    arrays = {array.name: array for one in _functions(source) for array in one.inputs}
    found = {}
    for name, array in arrays.items():
        if unloaded := unloaded_rows(array, source.model):
            rows = [unloaded.get(row, "") for row in range(array.shape[0])]
            found[name] = [f'"{c_text(row)}"' if row else "NULL" for row in rows]
    return found


def _prepare(prepare: Function, source: Source) -> dict[str, Any]:
    """Return the variables of parameters."""
    (array,) = prepare.outputs
    precision = formats(source.variant).parameters
    values = [
        (name, f"{'-' if value < 0 else ''}{precision.literal(abs(value))}")
        for name, value in source.model.parameters
    ]
    return {"parameters": values, "size": array.size}


def _help(function: Function, source: Source, package: str) -> list[str]:
    """Return the lines of the help of a function."""
    inputs = [array for array in function.inputs if array.name != PREPARED]
    parameters = ["parameters"] if source.model.parameters else []
    results = ", ".join([*(array.name for array in function.outputs), "status"])
    given = ", ".join([*(array.name for array in inputs), *parameters])
    lines = _wrapped(f"{function.name.upper()}  {function.doc}")
    lines += ["", f"  [{results}] = {package}.{function.name}({given})", ""]
    width = max(len(array.name) for array in (*inputs, *function.outputs))
    for array in inputs:
        lines += _described(array, width)
    if parameters:
        text = f"a struct with some of the parameters or a vector of all; see {package}.parameters"
        lines += _wrapped(f"{'parameters'.ljust(width)}  {text}", "  ", " " * (width + 4))
    for array in function.outputs:
        lines += _described(array, width)
    lines.append("")
    lines += _wrapped(
        "B is the number of states; what is given for one stands for all. Inputs that may be [] can be left "
        "out at the end."
    )
    return [*lines, *_wrapped(_about_status(function))]


def _described(array: Array, width: int) -> list[str]:
    """Return the lines of help on an array, whose name takes some columns."""
    text = f"{array.doc} ({array.unit}){'; [] is zero' if array.name in OPTIONAL else ''}"
    return _wrapped(f"{array.name.ljust(width)}  {_size(array)}  {text}", "  ", " " * (width + 4))


def _about_status(function: Function) -> str:
    """Return the sentences on the status of a function."""
    text = "status (1 x B, int32) is 0 where all is well, " + (
        "the place of a freedom (or row) where the result does not exist, " if function.may_fail else ""
    )
    text += "n + 1 where a result is infinite or NaN"
    text += ", negative where it is inaccurate" if function.may_be_inaccurate else ""
    return f"{text}. Without this result, a warning or an error says it."


def _size(array: Array) -> str:
    return " x ".join([*map(str, array.shape or (1,)), "B"])


def _wrapped(text: str, first: str = "", others: str = "") -> list[str]:
    return textwrap.wrap(
        text, _WIDTH - 2, initial_indent=first, subsequent_indent=others, break_long_words=False
    )


def _tables(source: Source) -> list[tuple[str, Sequence[str]]]:
    """Return the names of the fields of names, and their elements."""
    model = source.model
    found: list[tuple[str, Sequence[str]]] = [
        ("coordinates", model.coordinate_names),
        ("coordinate_units", model.coordinate_units),
        ("freedoms", model.freedom_names),
        ("speeds", model.speed_names or model.freedom_names),
        ("speed_units", [f"{unit}/s" for unit in model.freedom_units]),
        ("bodies", model.body_names),
        ("parameters", [name for name, _ in model.parameters]),
        ("points", [name for name, _ in model.points]),
        ("prescribed", model.prescribed_names),
        ("frames", model.poses if set(OF_FRAMES).intersection(source.outputs) else ()),
        ("reactions", [name for _, name, _ in reactions(model, source.outputs)]),
        ("contact_rows", [name for _, name, _ in contacts(model, source.outputs)]),
        ("functions", [one.name for one in _functions(source)]),
    ]
    return [(name, texts) for name, texts in found if texts]


def _quoted(texts: Iterable[str]) -> list[str]:
    """Return strings of MATLAB as lines of the elements of a cell array in one column."""
    return [f"'{matlab_text(text)}';" for text in texts]


def _limits(source: Source) -> list[tuple[str, list[str]]]:
    """Return the fields of limits, and their elements."""
    names = ("lower_limits", "upper_limits", "speed_limits", "effort_limits")
    shown = [[_number(value) for value in values] for values in source.model.limits]
    return list(zip(names, shown, strict=False))


def _number(value: float) -> str:
    return repr(value) if math.isfinite(value) else "-Inf" if value < 0 else "Inf"
