"""Calls of every function at one state, for the example and the tests of a crate."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from dataclasses import dataclass

from kanegen.artifacts.rust.arguments import Types
from kanegen.artifacts.rust.methods import outputs_of
from kanegen.artifacts.rust.names import identifier
from kanegen.c.interface import Function
from kanegen.program.ir import PREPARED, Array


@dataclass(frozen=True)
class Call:
    """A call of one function.

    Attributes:
        name: Name of the method.
        names: Names of its inputs.
        given: The inputs as arguments of the form for one state.
        single: Call of the form for one state that fills memory of the caller.
        batch: Call of the form for many states, each with the same inputs; "" without one.
        results: Name, zeros and expression of each result for one state.
        struct: Name of the struct of results, "" where there is one result.
    """

    name: str
    names: tuple[str, ...]
    given: tuple[str, ...]
    single: str
    batch: str
    results: tuple[tuple[str, str, str], ...]
    struct: str


def call_of(function: Function, types: Types) -> Call:
    """Return the call of a function with inputs that have the names of their arrays."""
    inputs = [array for array in function.inputs if array.name != PREPARED]
    struct, name = outputs_of(function, types), identifier(function.name)
    names = tuple(identifier(array.name) for array in inputs)
    given = tuple(f"{'&' * bool(array.shape)}{one}" for one, array in zip(names, inputs, strict=True))
    results = tuple(
        (one := identifier(array.name), types.zeros(array), f"outputs.{one}" if struct else one)
        for array in function.outputs
    )
    filled = "&mut outputs" if struct else f"&mut {results[0][0]}"
    by_state = [array for array in function.inputs if array.name not in function.shared]
    has_own = any(array.name == PREPARED for array in by_state)
    rows = ["&[*model.prepared(); ROWS]"] * has_own + [f"&[{one}; ROWS]" for one in names]
    rows += [f"&mut {one}_rows" for one, _, _ in results]
    return Call(
        name,
        names,
        given,
        f"model.{name}_into({', '.join((*given, filled))})",
        f"{'Model::' if has_own else 'model.'}{name}_batch({', '.join(rows)})" if function.has_batch else "",
        results,
        struct.name if struct else "",
    )


def values(functions: Iterable[Function], types: Types) -> list[tuple[str, str, list[str]]]:
    """Return name, type and lines of the value of every input of some functions."""
    arrays = {array.name: array for one in functions for array in one.inputs if array.name != PREPARED}
    return [(identifier(name), types.of(array), _value(array)) for name, array in arrays.items()]


def _value(array: Array) -> list[str]:
    """Return the lines of an array of numbers of order one, the same as in the example in C."""
    numbers = [repr((1 + i % 7) / 10) for i in range(array.size)]
    for length in reversed(array.shape):
        groups = [numbers[i : i + length] for i in range(0, len(numbers), length)]
        numbers = [f"[{', '.join(group)}]" for group in groups]
    return textwrap.wrap(numbers[0], 88, break_long_words=False)
