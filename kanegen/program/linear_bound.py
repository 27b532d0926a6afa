"""Bounds on the changes of values that depend linearly on inputs, carried on state by state.

Changes of the inputs go from operation to operation as themselves. Coefficients are exact values near the
computed ones, whose magnitudes running errors bound: from above where they multiply, from below where they
divide.
"""

from __future__ import annotations

from collections.abc import Mapping

from kanegen.program.builder import Builder
from kanegen.program.ir import Instruction, Op, Program
from kanegen.program.running_error import RunningErrors


def linear_bound(
    errors: RunningErrors,
    builder: Builder,
    program: Program,
    changed: Mapping[int, int],
    wanted: list[int],
) -> list[int]:
    """Return bounds on the changes of values of a program that depend linearly on some of its inputs.

    Args:
        errors: Running errors of the program, in the builder.
        builder: The builder to which the bounds are appended.
        program: The program.
        changed: Bound on the change of each of these inputs, by instruction; the others do not change.
        wanted: Instructions whose changes are bounded.

    Raises:
        ArithmeticError: If a value does not depend linearly on the inputs that change.
    """
    found: dict[int, int | None] = {}
    for i, instruction in enumerate(program.instructions):
        found[i] = changed.get(i)
        inner = [found[j] for j in instruction.operands]
        if not any(one is not None for one in inner):
            continue
        found[i] = _moved(errors, builder, instruction, inner)
    zero = builder.constant(0.0)
    bounds = (found[i] for i in wanted)
    return [zero if bound is None else bound for bound in bounds]


def _moved(errors: RunningErrors, builder: Builder, instruction: Instruction, inner: list[int | None]) -> int:
    """Return the bound on the change of an instruction from those of its operands; None is no change."""
    op, operands = instruction.op, instruction.operands
    first, second = inner[0], inner[-1]
    if op is Op.NEGATE and first is not None:
        return first
    if op in (Op.ADD, Op.SUBTRACT):
        if first is not None and second is not None:
            return builder.add(first, second)
        only = second if first is None else first
        assert only is not None
        return only
    if op is Op.MULTIPLY and (first is None or second is None):
        change, factor = (second, operands[0]) if first is None else (first, operands[1])
        assert change is not None
        return builder.add(builder.multiply(change, errors.largest(factor)), errors.least)
    if op is Op.DIVIDE and first is not None and second is None:
        return builder.divide(first, errors.divisor(operands[1]))
    raise ArithmeticError(f"{op} is not linear in what changes")
