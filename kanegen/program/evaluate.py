"""An interpreter of programs over any kind of numbers: floats, arrays, SymPy expressions, multiprecision."""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from kanegen.program.ir import Op, Program

ARITHMETIC: dict[Op, Callable[..., Any]] = {
    Op.ADD: operator.add,
    Op.SUBTRACT: operator.sub,
    Op.MULTIPLY: operator.mul,
    Op.DIVIDE: operator.truediv,
    Op.NEGATE: operator.neg,
}
"""Python's functions for the arithmetic operations."""


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
        functions: Module or context with `sin`, `cos` and `sqrt`, such as `numpy`, `sympy` or `mpmath`.
        number: Converts a constant of the program to the kind of number wanted.

    Returns:
        Elements of every output array in the order of `Output.values`, by name.
    """
    values: list[Any] = []
    for instruction in program.instructions:
        if instruction.op is Op.CONSTANT:
            values.append(number(instruction.number))
        elif instruction.op is Op.INPUT:
            values.append(inputs[instruction.array][instruction.index])
        else:
            compute = ARITHMETIC.get(instruction.op) or getattr(functions, instruction.op.value)
            values.append(compute(*(values[operand] for operand in instruction.operands)))
    return {output.array.name: [values[value] for value in output.values] for output in program.outputs}
