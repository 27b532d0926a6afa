"""Derivatives of a program with respect to its inputs, instruction by instruction, in forward mode.

Every value carries its derivatives in the directions that it depends on, and no others: derivatives that are
zero are never written down (Griewank and Walther 2008, chapters 3 and 7). Derivatives are values like all
others, so later passes share, fold and factor them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from kanegen.program.builder import Builder
from kanegen.program.constants import Constants
from kanegen.program.ir import Instruction, Op, Program
from kanegen.program.selection import dependencies

Tangent = dict[int, int]
"""Number of the value that is the derivative, by direction; directions with a zero derivative are absent."""


def tangents(
    builder: Builder,
    program: Program,
    moved: Mapping[int, int],
    directions: Mapping[int, int],
    wanted: Iterable[int],
    constants: Constants,
) -> dict[int, Tangent]:
    """Append the derivatives of values to a builder.

    Args:
        builder: The builder; it holds the instructions of the program already.
        program: The program to differentiate.
        moved: Value in the builder of each instruction of the program.
        directions: Direction in which the derivative of an instruction is 1, by instruction of the program.
        wanted: Instructions of the program whose derivatives are asked for.
        constants: The arithmetic of constants.

    Returns:
        Tangents by instruction, for all instructions that the wanted ones depend on.
    """
    rules = _Rules(builder, constants)
    found: dict[int, Tangent] = {}
    for i in dependencies(program, wanted):
        instruction = program.instructions[i]
        if i in directions:
            found[i] = {directions[i]: rules.one}
            continue
        inner = [found[j] for j in instruction.operands]
        values = [moved[j] for j in instruction.operands]
        active = dict.fromkeys(direction for tangent in inner for direction in tangent)
        found[i] = {}
        for direction in active:
            value = rules.derivative(instruction.op, moved[i], values, [t.get(direction) for t in inner])
            found[i][direction] = _named(builder, value, instruction, direction)
    return found


def _named(builder: Builder, value: int, instruction: Instruction, direction: int) -> int:
    """Name the derivative of a named instruction after it, with the direction at the end."""
    if not instruction.name:
        return value
    return builder.name(value, f"{instruction.name}_d{direction}", f"Derivatives. {instruction.note}")


class _Rules:
    """Appends the derivative of an operation, given those of its operands; None stands for a zero.

    Args:
        builder: The builder to which instructions are appended.
        constants: The arithmetic of constants.
    """

    def __init__(self, builder: Builder, constants: Constants) -> None:
        self._builder = builder
        self.one = builder.constant(constants.quotient(1, 1))
        self._half = builder.constant(constants.quotient(1, 2))

    def derivative(self, op: Op, value: int, operands: Sequence[int], inner: Sequence[int | None]) -> int:
        """Return the derivative of one operation; at least one operand has a derivative.

        Args:
            op: The operation.
            value: Value of the operation.
            operands: Operands of the operation.
            inner: Derivatives of the operands.
        """
        make = self._builder
        a, *more = operands
        da, db = (inner[0], inner[1]) if more else (inner[0], None)
        if op is Op.ADD:
            return self._sum(da, db)
        if op is Op.SUBTRACT:
            return self._difference(da, db)
        if op is Op.MULTIPLY:
            left = None if da is None else make.multiply(da, more[0])
            right = None if db is None else make.multiply(a, db)
            return self._sum(left, right)
        if op is Op.DIVIDE:
            fall = None if db is None else make.multiply(value, db)
            return make.multiply(self._difference(da, fall), make.divide(self.one, more[0]))
        assert da is not None
        if op is Op.NEGATE:
            return make.negate(da)
        if op is Op.SQRT:
            return make.multiply(da, make.divide(self._half, value))
        if op is Op.SIN:
            return make.multiply(make.function(Op.COS, a), da)
        assert op is Op.COS
        return make.negate(make.multiply(make.function(Op.SIN, a), da))

    def _sum(self, a: int | None, b: int | None) -> int:
        """Return a + b, of which at most one is zero."""
        if a is None or b is None:
            only = b if a is None else a
            assert only is not None
            return only
        return self._builder.add(a, b)

    def _difference(self, a: int | None, b: int | None) -> int:
        """Return a - b, of which at most one is zero."""
        if b is None:
            assert a is not None
            return a
        return self._builder.negate(b) if a is None else self._builder.subtract(a, b)
