"""Prototypes of the C functions and the comments that document them."""

from __future__ import annotations

import textwrap

from kanegen.c.formats import Formats
from kanegen.c.interface import Function
from kanegen.c.layout import BREAK, WIDTH, columns, wrap
from kanegen.program.ir import Array


def prototype(model: str, function: Function, formats: Formats) -> list[str]:
    """`void model_forcing(const double x[2], ..., double f[2])`, without a semicolon; int with a status."""
    arguments = [f"const {formats.of(array.name).c_type} {declarator(array)}" for array in function.inputs]
    arguments += [f"{formats.of(array.name).c_type} {declarator(array)}" for array in function.outputs]
    return _prototype("int" if function.spoilt else "void", f"{model}_{function.name}", arguments)


def batch_prototype(model: str, function: Function, formats: Formats) -> list[str]:
    """`void model_forcing_batch(size_t count, const double *x, ..., double *f)`, without a semicolon."""
    arguments = ["size_t count"]
    arguments += [f"const {formats.of(array.name).c_type} *{array.name}" for array in function.inputs]
    arguments += [f"{formats.of(array.name).c_type} *{array.name}" for array in function.outputs]
    return _prototype("size_t" if function.spoilt else "void", f"{model}_{function.name}_batch", arguments)


def lanes_prototype(model: str, function: Function, formats: Formats) -> list[str]:
    """`static void model_forcing_lanes(const lanes *x, ..., lanes *f)`, without a semicolon."""
    arguments = [
        f"const {formats.of(array.name).c_type if array.name in function.shared else 'lanes'} *{array.name}"
        for array in function.inputs
    ]
    arguments += [f"lanes *{array.name}" for array in function.outputs]
    arguments += ["lanes_bits *accurate"] if function.judged else []
    kind = "static lanes_bits" if function.spoilt else "static void"
    return _prototype(kind, f"{model}_{function.name}_lanes", arguments)


def lanes_call(model: str, function: Function) -> list[str]:
    """The call for the states of all lanes, one level deeper than a function body."""
    arguments = [
        array.name if array.name in function.shared else f"{array.name}_lanes"
        for array in (*function.inputs, *function.outputs)
    ]
    arguments += ["&accurate"] if function.judged else []
    text = f"{model}_{function.name}_lanes({f',{BREAK}'.join(arguments)});"
    if function.spoilt:
        text = f"const lanes_bits good = {text}"
    return wrap(text, indent=" " * 8, hanging=" " * 12)


def row_call(model: str, function: Function) -> list[str]:
    """The call for row `i` of a batch, one level deeper than a function body."""
    arguments = [
        array.name if array.name in function.shared else f"{array.name} + {array.size}*i"
        for array in (*function.inputs, *function.outputs)
    ]
    text = f"{model}_{function.name}({f',{BREAK}'.join(arguments)})"
    text = f"failed += {text} != 0;" if function.spoilt else f"{text};"
    return wrap(text, indent=" " * 8, hanging=" " * 12)


def argument_list(function: Function) -> list[str]:
    """Doxygen lines for the arguments: direction, name, lengths, meaning and unit."""
    rows = [_argument("[in]", array) for array in function.inputs]
    rows += [_argument("[out]", array) for array in function.outputs]
    lines = columns(rows, width=WIDTH - len(" * "))
    if function.spoilt:
        quantity = " or ".join(condition.quantity for condition in function.conditions)
        status = (
            f"@return 0, or the place in x, from 1, of a freedom whose {quantity} is not positive or NaN;"
        )
        lines += textwrap.wrap(status, WIDTH - len(" * "), subsequent_indent="    ")
        lines.append(f"    {' and '.join(function.spoilt)} then {_holds(function)} NaN")
    if function.judged:
        lines += [
            "    -1 and below: minus such a place where nothing failed, but the error may be large, with the",
            f"    largest correction at that freedom; {' and '.join(function.judged)} is filled all the same",
        ]
    return lines


def batch_notes(function: Function) -> list[str]:
    """Doxygen lines for what a batch does otherwise."""
    lines = [f"All states have the one array `{name}` in common." for name in function.shared]
    if function.spoilt:
        names = " and ".join(function.spoilt)
        lines += ["", f"@return how many states failed; their rows of {names} hold NaN"]
    if function.judged:
        lines[-1] = f"@return how many states failed, their rows of {names} hold NaN, or are not accurate"
    return lines


def declarator(array: Array) -> str:
    """An array as C declares it, `A[2 * 2]`."""
    return f"{array.name}{_lengths(array)}"


def _holds(function: Function) -> str:
    return "holds" if len(function.spoilt) == 1 else "hold"


def _lengths(array: Array) -> str:
    return f"[{' * '.join(map(str, array.shape or (1,)))}]"


def _argument(direction: str, array: Array) -> tuple[str, str, str, str]:
    return f"@param{direction}", array.name, _lengths(array), f"{array.doc} ({array.unit})"


def _prototype(kind: str, name: str, arguments: list[str]) -> list[str]:
    return wrap(f"{kind} {name}({f',{BREAK}'.join(arguments)})", indent="", hanging="    ")
