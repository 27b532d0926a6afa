"""The pass that takes common factors out of sums: a b + a c becomes a (b + c), one multiplication less."""

from __future__ import annotations

from collections import Counter

from kanegen.program.builder import Builder
from kanegen.program.ir import PARAMETERS, Instruction, Op, Program
from kanegen.program.selection import parameter_only


def factor(program: Program) -> Program:
    """Factor every sum of two products that share a factor and are used nowhere else.

    Sums that depend on parameters alone are left as they are: they go into `prepare`, which other functions
    share.
    """
    uses = Counter(operand for i in program.instructions for operand in i.operands)
    uses.update(program.results())
    prepared = _goes_into_prepare(program)
    factors = {
        i: None if prepared[i] else _shared_factor(program, x, uses)
        for i, x in enumerate(program.instructions)
    }
    absorbed = {j for i, shared in factors.items() if shared for j in program.instructions[i].operands}
    builder = Builder(program.inputs)
    moved: dict[int, int] = {}
    for i, instruction in enumerate(program.instructions):
        shared = factors[i]
        if shared is not None:
            common, left, right = (moved[j] for j in shared)
            combine = builder.add if instruction.op is Op.ADD else builder.subtract
            value = builder.multiply(common, combine(left, right))
            moved[i] = builder.name(value, instruction.name, instruction.note)
        elif i not in absorbed:
            moved[i] = builder.copy(instruction, [moved[j] for j in instruction.operands])
    return builder.program([output.renumbered(moved) for output in program.outputs])


def _goes_into_prepare(program: Program) -> list[bool]:
    """Return which instructions will move into `prepare`; in `prepare` itself, none."""
    if all(array.name == PARAMETERS for array in program.inputs):
        return [False] * len(program.instructions)
    return parameter_only(program)


def _shared_factor(
    program: Program, instruction: Instruction, uses: Counter[int]
) -> tuple[int, int, int] | None:
    """Return (a, b, c) where an instruction is a b +- a c and nothing else uses the two products."""
    if instruction.op not in (Op.ADD, Op.SUBTRACT):
        return None
    products = [program.instructions[j] for j in instruction.operands]
    if any(p.op is not Op.MULTIPLY for p in products) or any(uses[j] != 1 for j in instruction.operands):
        return None
    (a, b), (c, d) = (p.operands for p in products)
    for common, left, other, right in ((a, b, c, d), (a, b, d, c), (b, a, c, d), (b, a, d, c)):
        if common == other:
            return common, left, right
    return None
