"""Declarations of the header: prototypes, documentation of arguments, enumerations of sizes and places."""

from __future__ import annotations

import math
import textwrap
from bisect import bisect_left
from collections.abc import Sequence

import numpy as np

from kanegen.c.description import ModelDescription
from kanegen.c.formats import Formats
from kanegen.c.interface import PREPARE, Function
from kanegen.c.layout import BREAK, WIDTH, columns, wrap
from kanegen.program.ir import Array
from kanegen.program.precision import DOUBLE, DOUBLE_DOUBLE, FLOAT, LONG_DOUBLE
from kanegen.recursion.outputs import OF_CONTACTS, OF_FRAMES


def prototype(model: str, function: Function, formats: Formats) -> list[str]:
    """Return `int model_forcing(const double x[2], ..., double f[2])`."""
    arguments = [f"const {formats.of(array.name).c_type} {declarator(array)}" for array in function.inputs]
    arguments += [f"{formats.of(array.name).c_type} {declarator(array)}" for array in function.outputs]
    return _prototype("int", f"{model}_{function.name}", arguments)


def batch_prototype(model: str, function: Function, formats: Formats) -> list[str]:
    """Return `size_t model_forcing_batch(size_t count, const double *x, ..., double *f)`."""
    arguments = ["size_t count"]
    arguments += [f"const {formats.of(array.name).c_type} *{array.name}" for array in function.inputs]
    arguments += [f"{formats.of(array.name).c_type} *{array.name}" for array in function.outputs]
    return _prototype("size_t", f"{model}_{function.name}_batch", arguments)


def simd_prototype(model: str, function: Function, formats: Formats) -> list[str]:
    """Return `static void model_forcing_simd(const simd *x, ..., simd *f)`."""
    arguments = [
        f"const {formats.of(array.name).c_type if array.name in function.shared else 'simd'} *{array.name}"
        for array in function.inputs
    ]
    arguments += [f"simd *{array.name}" for array in function.outputs]
    arguments += ["simd_bits *accurate"] if function.may_be_inaccurate else []
    kind = "static simd_bits" if function.may_fail else "static void"
    return _prototype(kind, f"{model}_{function.name}_simd", arguments)


def simd_call(model: str, function: Function) -> list[str]:
    """Return the call of the SIMD form, indented for the loop over a batch."""
    arguments = [
        array.name if array.name in function.shared else f"{array.name}_simd"
        for array in (*function.inputs, *function.outputs)
    ]
    arguments += ["&accurate"] if function.may_be_inaccurate else []
    text = f"{model}_{function.name}_simd({f',{BREAK}'.join(arguments)});"
    if function.may_fail:
        text = f"const simd_bits valid = {text}"
    return wrap(text, indent=" " * 8, hanging=" " * 12)


def simd_failures(function: Function) -> list[str]:
    """Return the statement that counts the states of a SIMD vector whose status is not 0."""
    bits = ["valid"] * bool(function.may_fail) + ["accurate"] * bool(function.may_be_inaccurate)
    bits.append("finite")
    text = f"failed += rows - simd_count({f' &{BREAK}'.join(bits)}, rows);"
    return wrap(text, indent=" " * 8, hanging=" " * 12)


def row_call(model: str, function: Function) -> list[str]:
    """Return the call of the form for one state with row `i` of a batch, indented for its loop."""
    arguments = [
        array.name if array.name in function.shared else f"{array.name} + {array.size}*i"
        for array in (*function.inputs, *function.outputs)
    ]
    text = f"{model}_{function.name}({f',{BREAK}'.join(arguments)})"
    return wrap(f"failed += {text} != 0;", indent=" " * 8, hanging=" " * 12)


def argument_list(function: Function, model: ModelDescription) -> list[str]:
    """Return Doxygen lines for arguments and status: direction, name, lengths, meaning and unit.

    Args:
        function: The function.
        model: Names of the model.
    """
    rows = [argument_row("[in]", array) for array in function.inputs]
    rows += [argument_row("[out]", array) for array in function.outputs]
    lines = columns(rows, width=WIDTH - len(" * "))
    names = " or ".join(array.name for array in function.outputs)
    infinite = f"{not_finite(model)} where a number in {names} is infinite or NaN"
    if not function.may_fail:
        lines += textwrap.wrap(f"@return 0, or {infinite}", WIDTH - len(" * "), subsequent_indent="    ")
    else:
        status = (
            "@return 0, or the place in x, from 1, of a freedom whose "
            f"{function.quantity} is not positive or NaN;"
        )
        lines += textwrap.wrap(status, WIDTH - len(" * "), subsequent_indent="    ")
        for one in function.row_conditions:
            before = f"{one.first} + " if one.first else ""
            status = (
                f"{not_finite(model)} + {before}i for row i, from 1, of the {one.rows}, whose "
                f"{one.quantity} is not positive or NaN;"
            )
            lines += textwrap.wrap(
                status, WIDTH - len(" * "), initial_indent="    ", subsequent_indent="    "
            )
        lines.append(f"    {' and '.join(function.may_fail)} then {_holds(function)} NaN")
        lines += textwrap.wrap(infinite, WIDTH - len(" * "), initial_indent="    ", subsequent_indent="    ")
    if function.may_not_converge:
        status = (
            f"{not_converged(model)} where the iteration for the step does not converge, because the step is "
            f"too long for the method; {' and '.join(a.name for a in function.outputs)} then hold NaN"
        )
        lines += textwrap.wrap(status, WIDTH - len(" * "), initial_indent="    ", subsequent_indent="    ")
    if function.may_be_inaccurate:
        names = " and ".join(function.may_be_inaccurate)
        are = "is" if len(function.may_be_inaccurate) == 1 else "are"
        filled = f"most digits lost at that {_holder(function)}; {names} {are} filled all the same"
        lines += [
            "    -1 and below: minus such a place where nothing failed, but the error may be large, with the",
            *textwrap.wrap(filled, WIDTH - len(" * "), initial_indent="    ", subsequent_indent="    "),
        ]
    return lines


def batch_notes(function: Function) -> list[str]:
    """Return Doxygen lines on the differences of the batch form from the form for one state."""
    lines = [f"All states have the one array `{name}` in common." for name in function.shared]
    lines += ["", "@return how many states have a status other than 0"]
    if function.may_fail:
        lines[-1] += f"; rows of {' and '.join(function.may_fail)} that do not exist hold NaN"
    return lines


def not_finite(model: ModelDescription) -> str:
    """Return the name of the status of a function with a result that is infinite or NaN."""
    return f"{model.prefix}_NOT_FINITE"


def not_converged(model: ModelDescription) -> str:
    """Return the name of the status of a function whose iteration does not converge."""
    return f"{model.prefix}_NOT_CONVERGED"


def declarator(array: Array) -> str:
    """Return an array as C declares it, `A[2 * 2]`."""
    return f"{array.name}{_lengths(array)}"


def _holder(function: Function) -> str:
    return "freedom or row" if function.row_conditions else "freedom"


def _holds(function: Function) -> str:
    return "holds" if len(function.may_fail) == 1 else "hold"


def _lengths(array: Array) -> str:
    return f"[{' * '.join(map(str, array.shape or (1,)))}]"


def argument_row(direction: str, array: Array) -> tuple[str, str, str, str]:
    """Return the row of a table of arguments: direction, name, lengths, meaning with unit."""
    return f"@param{direction}", array.name, _lengths(array), f"{array.doc} ({array.unit})"


def _prototype(kind: str, name: str, arguments: list[str]) -> list[str]:
    return wrap(f"{kind} {name}({f',{BREAK}'.join(arguments)})", indent="", hanging="    ")


def sizes(
    model: ModelDescription, functions: Sequence[Function], steps: Sequence[Function] = ()
) -> list[str]:
    """Return the lines of the enumeration of array sizes, and of statuses about no freedom and no row.

    Args:
        model: Names and sizes of the model.
        functions: Every generated function.
        steps: The functions of one step that functions of many steps contain.
    """
    prefix = model.prefix
    rows = [
        (f"{prefix}_COORDINATES", len(model.coordinate_names), "elements of x"),
        (f"{prefix}_FREEDOMS", len(model.freedom_names), "n, elements of y"),
        (f"{prefix}_BODIES", len(model.body_names), "N"),
        (not_finite(model), len(model.freedom_names) + 1, "status: a result is infinite or NaN"),
    ]
    if any(function.may_not_converge for function in (*functions, *steps)):
        rows.append((not_converged(model), model.not_converged, "status: an iteration does not converge"))
    if model.points:
        rows.append((f"{prefix}_POINTS", len(model.points), "points of the bodies"))
    asked = [function.name for function in functions]
    if rows_of_frames := frames(model, asked):
        rows.append((f"{prefix}_POSES", len(rows_of_frames), "frames with poses"))
    if places := reactions(model, asked):
        rows.append((f"{prefix}_REACTIONS", len(places), "reaction loads"))
    if places := contacts(model, asked):
        rows.append((f"{prefix}_CONTACT_ROWS", len(places), "held directions of contacts"))
    if model.prescribed:
        rows.append((f"{prefix}_PRESCRIBED", len(model.prescribed), "p, prescribed freedoms"))
    for function in functions:
        if function.name == PREPARE:
            rows += [
                (f"{prefix}_{array.name.upper()}", array.size, array.doc)
                for array in (*function.inputs, *function.outputs)
            ]
    return enumeration(rows)


LIMITS = ("LOWER_LIMITS", "UPPER_LIMITS", "SPEED_LIMITS", "EFFORT_LIMITS")
"""Ends of the names of the macros of limits, in the order of `ModelDescription.limits`."""

_INFINITIES = {FLOAT: "INFINITY", LONG_DOUBLE: "HUGE_VALL"}
"""Infinity in <math.h> in the type of a precision; HUGE_VAL in double."""


def limits(model: ModelDescription, formats: Formats) -> list[str]:
    """Return the lines of the macros of limits, initialisers of arrays; none for a model without limits.

    A double-double number cannot stand in an initialiser, so these limits are doubles.
    """
    precision = DOUBLE if formats.storage is DOUBLE_DOUBLE else formats.storage
    infinity = _INFINITIES.get(precision, "HUGE_VAL")

    def text(value: float) -> str:
        is_infinite = math.isinf(value) or abs(value) > float(np.finfo(precision.dtype).max)
        size = infinity if is_infinite else precision.literal(abs(value))
        return f"-{size}" if value < 0 else size

    lines: list[str] = []
    for name, values in zip(LIMITS, model.limits, strict=False):
        lines += _initialiser(f"{model.prefix}_{name}", [text(value) for value in values])
    return lines


def patterns(model: ModelDescription, functions: Sequence[Function]) -> list[str]:
    """Return the lines of the macros that say where elements of a triangle belong; none without one.

    They are those of compressed sparse rows: the first element of each row, at last the number of elements,
    and the column of each element.
    """
    lines: list[str] = []
    for array in dict.fromkeys(array for function in functions for array in function.outputs):
        if array.pattern and not array.is_filled_in_part:
            rows = [row for row, _ in array.pattern]
            starts = [bisect_left(rows, row) for row in range(rows[-1] + 2)]
            name = f"{model.prefix}_{array.name}"
            lines += _initialiser(f"{name}_ROW_STARTS", list(map(str, starts)))
            lines += _initialiser(f"{name}_COLUMNS", [str(column) for _, column in array.pattern])
    return lines


def _initialiser(name: str, values: Sequence[str]) -> list[str]:
    """Return the lines of a macro that initialises an array."""
    whole = f"#define {name} {{ {f',{BREAK}'.join(values)} }}"
    parts = wrap(whole, indent="", hanging="    ")
    return [*(f"{part} \\" for part in parts[:-1]), parts[-1]]


def parameter_places(model: ModelDescription) -> list[str]:
    """Return the lines of the enumeration of places in the array of parameters."""
    prefix = model.prefix
    return enumeration(
        [
            (f"{prefix}_P_{name}", index, f"default {default!r}")
            for index, (name, default) in enumerate(model.parameters)
        ]
    )


def prepared_places(model: ModelDescription, names: Sequence[str]) -> list[str]:
    """Return the lines of the enumeration of places in the array of prepared constants.

    Args:
        model: Names of the model.
        names: Name of each constant, in the order of the array.
    """
    prefix = model.prefix
    parameters = {f"p_{name}" for name, _ in model.parameters}
    rows = []
    for index, name in enumerate(names):
        meaning = "the parameter itself" if name in parameters else ""
        rows.append((f"{prefix}_C_{name}", index, meaning))
    return enumeration(rows)


def enumeration(rows: Sequence[tuple[str, int, str]]) -> list[str]:
    """Return the lines between the braces of an enum; C++98 allows no comma after the last.

    Args:
        rows: Name, value and meaning of each enumerator; the meaning is "" where the name is enough.
    """
    last = len(rows) - 1
    return columns(
        [
            (name, f"= {value}{',' if i < last else ''}", f"/* {text} */" if text else "")
            for i, (name, value, text) in enumerate(rows)
        ],
        gap=" ",
    )


def frames(model: ModelDescription, outputs: Sequence[str]) -> list[tuple[int, str, str | None]]:
    """Return row, name and body of the frames in outputs about them, [] where all are bodies or none is used.

    The body of a frame that is fixed to the ground is "", that of a frame with the name of its body is None.
    """
    if model.poses == model.body_names or not set(OF_FRAMES).intersection(outputs):
        return []
    pairs = zip(model.poses, model.pose_bodies, strict=True)
    return [(row, name, None if name == body else body) for row, (name, body) in enumerate(pairs)]


def reactions(model: ModelDescription, outputs: Sequence[str]) -> list[tuple[int, str, str]]:
    """Return index, name and unit of every reaction load, if the output is computed."""
    asked = "reaction_loads" in outputs
    return [(place, name, unit) for place, (name, unit, _) in enumerate(model.reactions)] if asked else []


def contacts(model: ModelDescription, outputs: Sequence[str]) -> list[tuple[int, str, str]]:
    """Return index, name and unit of every load of contacts, if an output under contacts is computed."""
    asked = set(OF_CONTACTS).intersection(outputs)
    return [(place, name, unit) for place, (name, unit) in enumerate(model.contact_rows)] if asked else []
