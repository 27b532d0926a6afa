"""The pass that folds constants and shares common subexpressions.

It evaluates operations on numbers, products with 0, 1 and -1, sums with 0, differences of equal values and
double sign changes. A sign change costs nothing, so signs are moved outward through products and into sums,
where they merge. An operation on the same operands as an earlier one is replaced by the earlier one. Numbers
fold with the digits of their context of mpmath.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from kanegen.program.builder import Builder
from kanegen.program.evaluate import function
from kanegen.program.ir import Array, Instruction, Op, Program


def fold(program: Program) -> Program:
    """Return the same outputs with numbers folded and common subexpressions shared."""
    builder = FoldingBuilder(program.inputs)
    moved: list[int] = []
    for instruction in program.instructions:
        moved.append(builder.copy(instruction, [moved[j] for j in instruction.operands]))
    return builder.program([output.renumbered(moved) for output in program.outputs])


ODD = (Op.SIN, Op.SIGN, Op.TANH)
"""Functions that change their sign with that of their operand."""

EVEN = (Op.COS, Op.ABS)
"""Functions that do not depend on the sign of their operand."""

LARGEST_EXPONENT = 1e4
"""Magnitude of a number beyond which its exponential is no finite number, or 0, in every precision."""


def _is_defined(op: Op, number: Any) -> bool:
    """Return whether a function of a number is a finite real number."""
    match op:
        case Op.SQRT:
            return bool(number >= 0)
        case Op.LOG:
            return bool(number > 0)
    return True


class FoldingBuilder(Builder):
    """A builder whose methods may return an earlier value instead of a new one."""

    def __init__(self, inputs: Sequence[Array]) -> None:
        super().__init__(inputs)
        self._known: dict[tuple[object, ...], int] = {}

    def copy(self, instruction: Instruction, operands: Sequence[int]) -> int:
        """Append an instruction of another program, applied to operands of this builder, folded again."""
        value = self._copied(instruction, operands)
        return self.name(value, instruction.name, instruction.note)

    def _copied(self, instruction: Instruction, operands: Sequence[int]) -> int:
        """Append an instruction of another program by the method for its operation."""
        match instruction.op:
            case Op.CONSTANT:
                return self._value(Instruction(Op.CONSTANT, number=instruction.number))
            case Op.INPUT:
                return self.input(instruction.array, instruction.index, instruction.name)
            case Op.ADD:
                return self.add(*operands)
            case Op.SUBTRACT:
                return self.subtract(*operands)
            case Op.MULTIPLY:
                return self.multiply(*operands)
            case Op.DIVIDE:
                return self.divide(*operands)
            case Op.NEGATE:
                return self.negate(*operands)
        return self.function(instruction.op, *operands)

    def add(self, a: int, b: int) -> int:
        """Return the sum a + b."""
        inner = self._negated(b)
        if inner is not None:
            return self.subtract(a, inner)
        inner = self._negated(a)
        if inner is not None:
            return self.subtract(b, inner)
        x, y = self._number(a), self._number(b)
        if x is not None and y is not None:
            return self.constant(x + y)
        if x == 0.0:
            return b
        if y == 0.0:
            return a
        return self._value(Instruction(Op.ADD, (min(a, b), max(a, b))))

    def subtract(self, a: int, b: int) -> int:
        """Return the difference a - b."""
        inner = self._negated(b)
        if inner is not None:
            return self.add(a, inner)
        inner = self._negated(a)
        if inner is not None:
            return self.negate(self.add(inner, b))
        x, y = self._number(a), self._number(b)
        if x is not None and y is not None:
            return self.constant(x - y)
        if y == 0.0:
            return a
        if x == 0.0:
            return self.negate(b)
        if a == b:
            return self.constant(0.0)
        if (Op.SUBTRACT, b, a) in self._known:
            return self.negate(self._known[Op.SUBTRACT, b, a])
        return self._value(Instruction(Op.SUBTRACT, (a, b)))

    def multiply(self, a: int, b: int) -> int:
        """Return the product a b."""
        inner = self._negated(a)
        if inner is not None:
            return self.negate(self.multiply(inner, b))
        inner = self._negated(b)
        if inner is not None:
            return self.negate(self.multiply(a, inner))
        x, y = self._number(a), self._number(b)
        if x is not None and y is not None:
            return self.constant(x * y)
        if y is not None:
            a, b, x, y = b, a, y, x
        if x is not None:
            if x == 0.0:
                return a
            if abs(x) == 1.0:
                return b if x > 0 else self.negate(b)
            if x < 0:
                return self.negate(self.multiply(self.constant(-x), b))
            return self._value(Instruction(Op.MULTIPLY, (a, b)))
        return self._value(Instruction(Op.MULTIPLY, (min(a, b), max(a, b))))

    def divide(self, a: int, b: int) -> int:
        """Return the quotient a / b."""
        x, y = self._number(a), self._number(b)
        if x is not None and y:
            return self.constant(x / y)
        if y == 1.0 or x == 0.0:
            return a
        inner = self._negated(a)
        if inner is not None:
            return self.negate(self.divide(inner, b))
        inner = self._negated(b)
        if inner is not None:
            return self.negate(self.divide(a, inner))
        return self._value(Instruction(Op.DIVIDE, (a, b)))

    def negate(self, a: int) -> int:
        """Return the sign change -a."""
        inner = self._negated(a)
        if inner is not None:
            return inner
        x = self._number(a)
        if x is not None:
            return self.constant(-x)
        return self._value(Instruction(Op.NEGATE, (a,)))

    def function(self, op: Op, *operands: int) -> int:
        """Return a function of one or more values."""
        a = operands[0]
        inner = self._negated(a)
        if inner is not None and op in ODD:
            return self.negate(self.function(op, inner))
        if inner is not None and op in EVEN:
            return self.function(op, inner)
        numbers = [self._number(operand) for operand in operands]
        if op is Op.SELECT and numbers[0] is not None:
            return operands[1] if numbers[0] > 0 else operands[2]
        if op is Op.EXP and numbers[0] is not None and abs(numbers[0]) > LARGEST_EXPONENT:
            return self.constant(math.inf if numbers[0] > 0 else 0.0)
        if all(number is not None for number in numbers) and _is_defined(op, numbers[0]):
            compute = function(op, getattr(numbers[0], "context", math))
            return self.constant(compute(*numbers))
        return self._value(Instruction(op, operands))

    def _number(self, value: int) -> Any:
        """Return the number that a value is, or None."""
        instruction = self._instructions[value]
        return instruction.number if instruction.op is Op.CONSTANT else None

    def _negated(self, value: int) -> int | None:
        """Return the value of which a value is the sign change, or None."""
        instruction = self._instructions[value]
        return instruction.operands[0] if instruction.op is Op.NEGATE else None

    def _value(self, instruction: Instruction) -> int:
        key: tuple[object, ...]
        if instruction.op is Op.CONSTANT:
            key = (Op.CONSTANT, instruction.number)
        elif instruction.op is Op.INPUT:
            key = (Op.INPUT, instruction.array, instruction.index)
        else:
            key = (instruction.op, *instruction.operands)
        known = self._known.get(key)
        if known is None:
            known = self._known[key] = super()._value(instruction)
        return known
