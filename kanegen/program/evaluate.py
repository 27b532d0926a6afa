"""An interpreter of programs over any kind of numbers: floats, arrays, SymPy expressions, multiprecision."""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from kanegen.program.expand import expanded
from kanegen.program.ir import Op, Program

ARITHMETIC: dict[Op, Callable[..., Any]] = {
    Op.ADD: operator.add,
    Op.SUBTRACT: operator.sub,
    Op.MULTIPLY: operator.mul,
    Op.DIVIDE: operator.truediv,
    Op.NEGATE: operator.neg,
}
"""Python's functions for the arithmetic operations."""


LARGEST_EXPONENT = 1e5
"""Magnitude of a number from which its exponential counts as infinite or 0, in numbers of any exponent."""


def sign(a: Any) -> Any:
    """Return -1, 0 or 1 by the sign of a number of any kind; NaN for NaN."""
    one = 1.0 if isinstance(a, np.ndarray) else type(a)(1)
    return select(a, one, select(-a, -one, a))


def minimum(a: Any, b: Any) -> Any:
    """Return the smaller of two numbers of any kind, the first of equal ones; NaN if one is NaN."""
    return _first_if((a <= b) | _is_nan(a), a, b)


def maximum(a: Any, b: Any) -> Any:
    """Return the larger of two numbers of any kind, the first of equal ones; NaN if one is NaN."""
    return _first_if((a >= b) | _is_nan(a), a, b)


def select(condition: Any, a: Any, b: Any) -> Any:
    """Return a where the condition is positive, b where it is 0 or negative, and NaN where it is NaN."""
    if isinstance(condition, np.ndarray):
        return np.where(condition > 0, a, np.where(condition <= 0, b, condition))
    return a if condition > 0 else b if condition <= 0 else condition


def _is_nan(a: Any) -> Any:
    """Return whether a number of any kind is NaN."""
    return np.isnan(a) if isinstance(a, np.ndarray) else not abs(a) >= 0


def _first_if(flag: Any, a: Any, b: Any) -> Any:
    """Return a where a flag is set, and b elsewhere."""
    return np.where(flag, a, b) if isinstance(flag, np.ndarray) else a if flag else b


COMPARISONS: dict[Op, Callable[..., Any]] = {
    Op.SIGN: sign,
    Op.MIN: minimum,
    Op.MAX: maximum,
    Op.SELECT: select,
}
"""Functions for the operations that compare numbers."""


def function(op: Op, functions: Any) -> Callable[..., Any]:
    """Return the function of an operation in a module or context such as `numpy` or `mpmath`."""
    if op in COMPARISONS:
        return COMPARISONS[op]
    name = "arctan2" if op is Op.ATAN2 and functions is np else op.value
    found: Callable[..., Any] = getattr(functions, name)
    if op is Op.ATAN2:
        return lambda y, x: found(y + 0.0, x + 0.0)  # a zero has no sign
    if op is Op.EXP and hasattr(functions, "mpf"):
        return lambda a: found(a) if abs(a) < LARGEST_EXPONENT else select(a, functions.inf, functions.zero)
    return found


def evaluate(
    program: Program,
    inputs: Mapping[str, Sequence[Any]],
    functions: Any,
    number: Callable[[Any], Any] = float,
) -> dict[str, list[Any]]:
    """Run the instructions of a program one by one.

    Args:
        program: The program to run.
        inputs: Elements of every input array, row-major, by name.
        functions: Module or context with `sin`, `cos`, `sqrt` and the like, such as `numpy` or `mpmath`.
        number: Converts a constant of the program to the kind of number wanted.

    Returns:
        Elements of every output array in the order of `Output.values`, by name; of one that loops compute,
        all in order.
    """
    program = expanded(program)
    values: list[Any] = []
    computing = dict(ARITHMETIC)
    with np.errstate(invalid="ignore", divide="ignore"):  # also branches are computed that are not taken
        for instruction in program.instructions:
            if instruction.op is Op.CONSTANT:
                values.append(number(instruction.number))
            elif instruction.op is Op.INPUT:
                values.append(inputs[instruction.array][instruction.index])
            else:
                compute = computing.get(instruction.op)
                if compute is None:
                    compute = computing[instruction.op] = function(instruction.op, functions)
                values.append(compute(*[values[operand] for operand in instruction.operands]))
    return {output.array.name: [values[value] for value in output.values] for output in program.outputs}
