"""A builder of programs, one instruction at a time; it simplifies nothing, which is the work of passes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from kanegen.errors import ModelError
from kanegen.program.ir import Array, Instruction, Op, Output, Program


class Builder:
    """Collects instructions; its methods take and return numbers of values.

    Args:
        inputs: Arrays that the instructions may read.
    """

    def __init__(self, inputs: Sequence[Array]) -> None:
        self._inputs = tuple(inputs)
        self._instructions: list[Instruction] = []
        self._names: set[str] = set()

    def program(self, outputs: Sequence[Output]) -> Program:
        """Return the program of all instructions so far with these outputs."""
        return Program(self._inputs, tuple(self._instructions), tuple(outputs))

    def name(self, value: int, name: str, note: str = "") -> int:
        """Name a value, unless it is a number, an input or a sign change, or has a name already."""
        instruction = self._instructions[value]
        nameless = instruction.op in (Op.CONSTANT, Op.INPUT, Op.NEGATE) or instruction.name
        if name and not nameless and name not in self._names:
            self._names.add(name)
            self._instructions[value] = instruction.named(name, note)
        return value

    def is_zero(self, value: int) -> bool:
        """Return whether a value is the number 0."""
        instruction = self._instructions[value]
        return instruction.op is Op.CONSTANT and bool(instruction.number == 0)

    def copy(self, instruction: Instruction, operands: Sequence[int]) -> int:
        """Append an instruction of another program, applied to operands of this builder."""
        return self._value(instruction.with_operands(tuple(operands)))

    def constant(self, number: Any) -> int:
        """Append a number.

        Raises:
            ModelError: If `number` is not finite: numbers of the model leave the range of double precision.
        """
        if not math.isfinite(number):
            raise ModelError("a constant leaves the range of double precision; choose units nearer to 1.")
        return self._value(Instruction(Op.CONSTANT, number=number + 0.0))

    def input(self, array: str, index: int, name: str = "") -> int:
        """Append the reading of element `index` of an input array."""
        return self._value(Instruction(Op.INPUT, array=array, index=index, name=name))

    def add(self, a: int, b: int) -> int:
        """Append the sum a + b."""
        return self._value(Instruction(Op.ADD, (a, b)))

    def subtract(self, a: int, b: int) -> int:
        """Append the difference a - b."""
        return self._value(Instruction(Op.SUBTRACT, (a, b)))

    def multiply(self, a: int, b: int) -> int:
        """Append the product a b."""
        return self._value(Instruction(Op.MULTIPLY, (a, b)))

    def divide(self, a: int, b: int) -> int:
        """Append the quotient a / b."""
        return self._value(Instruction(Op.DIVIDE, (a, b)))

    def negate(self, a: int) -> int:
        """Append the sign change -a."""
        return self._value(Instruction(Op.NEGATE, (a,)))

    def function(self, op: Op, *operands: int) -> int:
        """Append a function of one or more values, such as the square root or the larger of two."""
        return self._value(Instruction(op, operands))

    def _value(self, instruction: Instruction) -> int:
        """Append an instruction and return the number of its value."""
        self._instructions.append(instruction)
        if instruction.name:
            self._names.add(instruction.name)
        return len(self._instructions) - 1
