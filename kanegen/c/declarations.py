"""Prototypes of the C functions and the comments that document them."""

from __future__ import annotations

from kanegen.c.interface import Function
from kanegen.c.layout import BREAK, WIDTH, columns, wrap
from kanegen.program.ir import Array


def prototype(model: str, function: Function) -> list[str]:
    """`void model_forcing(const double x[2], ..., double f[2])`, without a semicolon."""
    arguments = [f"const double {declarator(array)}" for array in function.inputs]
    arguments += [f"double {declarator(array)}" for array in function.outputs]
    return _prototype(f"{model}_{function.name}", arguments)


def batch_prototype(model: str, function: Function) -> list[str]:
    """`void model_forcing_batch(size_t count, const double *x, ..., double *f)`, without a semicolon."""
    arguments = ["size_t count"]
    arguments += [f"const double *{array.name}" for array in function.inputs]
    arguments += [f"double *{array.name}" for array in function.outputs]
    return _prototype(f"{model}_{function.name}_batch", arguments)


def row_call(model: str, function: Function) -> list[str]:
    """The call for row `i` of a batch, one level deeper than a function body."""
    arguments = [
        array.name if array.name in function.shared else f"{array.name} + {array.size}*i"
        for array in (*function.inputs, *function.outputs)
    ]
    text = f"{model}_{function.name}({f',{BREAK}'.join(arguments)});"
    return wrap(text, indent=" " * 8, hanging=" " * 12)


def argument_list(function: Function) -> list[str]:
    """Doxygen lines for the arguments: direction, name, lengths, meaning and unit."""
    rows = [_argument("[in]", array) for array in function.inputs]
    rows += [_argument("[out]", array) for array in function.outputs]
    return columns(rows, width=WIDTH - len(" * "))


def declarator(array: Array) -> str:
    """An array as C declares it, `A[2 * 2]`."""
    return f"{array.name}{_lengths(array)}"


def _lengths(array: Array) -> str:
    return f"[{' * '.join(map(str, array.shape))}]"


def _argument(direction: str, array: Array) -> tuple[str, str, str, str]:
    return f"@param{direction}", array.name, _lengths(array), f"{array.doc} ({array.unit})"


def _prototype(name: str, arguments: list[str]) -> list[str]:
    return wrap(f"void {name}({f',{BREAK}'.join(arguments)})", indent="", hanging="    ")
