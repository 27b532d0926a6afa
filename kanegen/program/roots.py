"""Square roots at zero, where their slopes have no limit unless the radicand is at a minimum.

The root of a sum of squares has there, with its radicand, the derivative 0. That of abs(u) has none although
the derivative of abs(u) counts as 0 where u is 0: this is what `Kinks` finds. In a product with a number that
is 0 there as well, as in abs(u) sqrt(abs(u)), the root does not count.
"""

from __future__ import annotations

from collections.abc import Mapping

from kanegen.program.builder import Builder
from kanegen.program.ir import Op, Program


def slopes_of_sum(
    make: Builder, program: Program, moved: Mapping[int, int], i: int, one: int
) -> dict[int, int]:
    """Return the derivatives of a sum by the factors of its terms, by instruction.

    Args:
        make: The builder to which instructions are appended.
        program: The program in which the sum stands.
        moved: Value in the builder of each of its instructions.
        i: The instruction of the sum.
        one: Value in the builder of the number 1.
    """
    found: dict[int, int] = {}
    waiting = [(i, one)]
    while waiting:
        j, slope = waiting.pop()
        x = program.instructions[j]
        match x.op:
            case Op.ADD:
                waiting += [(k, slope) for k in x.operands]
            case Op.SUBTRACT:
                waiting += [(x.operands[0], slope), (x.operands[1], make.negate(slope))]
            case Op.NEGATE:
                waiting += [(x.operands[0], make.negate(slope))]
            case Op.MULTIPLY:
                (k, m), (a, b) = x.operands, (moved[operand] for operand in x.operands)
                for factor, value in ((k, make.multiply(slope, b)), (m, make.multiply(slope, a))):
                    found[factor] = make.add(found[factor], value) if factor in found else value
            case _:
                found[j] = make.add(found[j], slope) if j in found else slope
    return found


def kinks_of_roots(program: Program) -> dict[int, list[int]]:
    """Return the magnitudes among the factors of radicands, by instruction of a root that has some.

    A root that something is divided by has no derivative at 0 in any case, and is absent, too.
    """
    divisors = {x.operands[1] for x in program.instructions if x.op is Op.DIVIDE}
    found = {}
    for i, x in enumerate(program.instructions):
        if x.op is Op.SQRT and i not in divisors:
            factors = _factors(program, x.operands[0])
            magnitudes = [j for j in factors if program.instructions[j].op is Op.ABS]
            if magnitudes:
                found[i] = magnitudes
    return found


def steep(program: Program) -> set[int]:
    """Return the roots with kinks, products with them, and sums with them that are only factors of products.

    Where such a root is 0 they have no slope. In a product with a number that is 0 there it does not count.
    """
    found = set(kinks_of_roots(program))
    if not found:
        return found
    summed = {j for x in program.instructions if x.op not in (Op.MULTIPLY, Op.NEGATE) for j in x.operands}
    for i, x in enumerate(program.instructions):
        is_factor = x.op in (Op.ADD, Op.SUBTRACT) and i not in summed
        if (is_factor or x.op in (Op.MULTIPLY, Op.NEGATE)) and not found.isdisjoint(x.operands):
            found.add(i)
    return found


def _factors(program: Program, i: int) -> dict[int, None]:
    """Return the factors of the terms of a sum."""
    found: dict[int, None] = {}
    waiting = [i]
    while waiting:
        j = waiting.pop()
        x = program.instructions[j]
        if x.op in (Op.ADD, Op.SUBTRACT, Op.NEGATE):
            waiting += x.operands
        else:
            found.update(dict.fromkeys(x.operands if x.op is Op.MULTIPLY else (j,)))
    return found
