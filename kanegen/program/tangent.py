"""Derivatives of a program by its inputs, instruction by instruction, forward.

Every value carries its derivatives by those inputs that it depends on, and no others: what is zero is never
written down (Griewank and Walther 2008, chapters 3 and 7). They are values like all others, so that later
passes share, fold and factor them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from kanegen.program.builder import Builder
from kanegen.program.constants import Constants
from kanegen.program.ir import Instruction, Op, Program
from kanegen.program.selection import needed

Tangent = dict[int, int]
"""By direction the number of the value that is the derivative; none where it is zero."""


def tangents(
    builder: Builder,
    program: Program,
    moved: Mapping[int, int],
    directions: Mapping[int, int],
    wanted: Iterable[int],
    constants: Constants,
) -> dict[int, Tangent]:
    """Derivatives of values.

    Args:
        builder: Takes the instructions; it holds the program already.
        program: What is differentiated.
        moved: Where the builder has the program's values.
        directions: By instruction of the program the direction in which it changes by 1.
        wanted: Instructions of the program whose derivatives are asked for.
        constants: How exact numbers are.

    Returns:
        By instruction, for all that the wanted ones need.
    """
    rules = _Rules(builder, constants)
    found: dict[int, Tangent] = {}
    for i in needed(program, wanted):
        instruction = program.instructions[i]
        if i in directions:
            found[i] = {directions[i]: rules.one}
            continue
        own = [found[j] for j in instruction.operands]
        values = [moved[j] for j in instruction.operands]
        active = dict.fromkeys(direction for tangent in own for direction in tangent)
        found[i] = {
            direction: _named(
                builder,
                rules.derivative(instruction.op, moved[i], values, [t.get(direction) for t in own]),
                instruction,
                direction,
            )
            for direction in active
        }
    return found


def _named(builder: Builder, value: int, instruction: Instruction, direction: int) -> int:
    if not instruction.name:
        return value
    return builder.name(value, f"{instruction.name}_d{direction}", f"Derivatives. {instruction.note}")


class _Rules:
    """The derivative of an operation from those of its operands, None where these are zero."""

    def __init__(self, builder: Builder, constants: Constants) -> None:
        self._builder = builder
        self.one = builder.constant(constants.number(1, 1))
        self._half = builder.constant(constants.number(1, 2))

    def derivative(self, op: Op, value: int, operands: Sequence[int], own: Sequence[int | None]) -> int:
        """At least one operand changes.

        Args:
            op: The operation.
            value: Its result.
            operands: Its operands.
            own: Their derivatives.
        """
        make = self._builder
        a, *more = operands
        da, db = (own[0], own[1]) if more else (own[0], None)
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
        if a is None or b is None:
            only = b if a is None else a
            assert only is not None
            return only
        return self._builder.add(a, b)

    def _difference(self, a: int | None, b: int | None) -> int:
        if b is None:
            assert a is not None
            return a
        return self._builder.negate(b) if a is None else self._builder.subtract(a, b)
