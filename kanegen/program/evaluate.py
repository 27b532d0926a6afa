"""Evaluate a program over any kind of numbers: floats, arrays, SymPy expressions, multiprecision."""

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


def evaluate(
    program: Program,
    inputs: Mapping[str, Sequence[Any]],
    functions: Any,
    number: Callable[[Any], Any] = float,
) -> dict[str, list[Any]]:
    """Run the instructions one by one.

    Args:
        program: What to run.
        inputs: For every input array its elements, flat.
        functions: Something with `sin`, `cos` and `sqrt`, such as `numpy`, `sympy` or `mpmath`.
        number: Turns a constant of the program into the kind of number wanted.

    Returns:
        For every output array its elements, flat.
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
