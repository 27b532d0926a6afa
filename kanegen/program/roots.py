"""Square roots at zero, where their slopes have no limit unless the radicand is at a minimum.

The root of a sum of squares has there, with its radicand, the derivative 0. That of abs(u) has none although
the derivative of abs(u) counts as 0 where u is 0, also where functions such as tanh stand between the two:
this is what `kinks_of_roots` finds. In a product with a number that is 0 there as well, as in
abs(u) sqrt(abs(u)), the root does not count, but in sign(u) sqrt(abs(u)) it does: a sign is 0 in one place
alone, and so counts as 1 there.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

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


def kinks_of_roots(program: Program) -> dict[int, dict[int, tuple[int, ...]]]:
    """Return the magnitudes in radicands, by the instruction of a root and by that of a factor in a radicand.

    A factor is one of a term of the sum that a radicand is, and depends on its magnitudes, or is one itself.
    Roots and factors without magnitudes are absent. A root that something is divided by has no derivative at
    0 in any case, and is absent, too.
    """
    instructions = program.instructions
    if all(x.op is not Op.ABS for x in instructions):
        return {}
    divisors = {x.operands[1] for x in instructions if x.op is Op.DIVIDE}
    magnitudes: dict[int, frozenset[int]] = {}
    found = {}
    for i, x in enumerate(instructions):
        inner = [magnitudes[j] for j in x.operands if j in magnitudes]
        if x.op is Op.ABS:
            inner.append(frozenset({i}))
        if not inner:
            continue
        magnitudes[i] = frozenset[int]().union(*inner)
        if x.op is Op.SQRT and i not in divisors:
            factors = _factors(program, x.operands[0])
            found[i] = {j: tuple(sorted(magnitudes[j])) for j in factors if j in magnitudes}
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


def roots_in(program: Program, i: int, made_of: Collection[int]) -> list[int]:
    """Return the roots with kinks that an instruction is made of.

    Args:
        program: The program.
        i: The instruction, one of `steep`.
        made_of: All of `steep`.
    """
    found: dict[int, None] = {}
    waiting = [i]
    while waiting:
        j = waiting.pop()
        if program.instructions[j].op is Op.SQRT:
            found[j] = None
        else:
            waiting += [k for k in program.instructions[j].operands if k in made_of]
    return list(found)


def without_signs(make: Builder, program: Program, moved: Mapping[int, int], one: int) -> dict[int, int]:
    """Return the values of signs and of products with them, where signs count as 1, by instruction.

    Args:
        make: The builder to which instructions are appended.
        program: The program in which the products stand.
        moved: Value in the builder of each of its instructions.
        one: Value in the builder of the number 1.
    """
    found: dict[int, int] = {}
    for i, x in enumerate(program.instructions):
        if x.op is Op.SIGN:
            found[i] = one
        elif x.op in (Op.MULTIPLY, Op.NEGATE) and not found.keys().isdisjoint(x.operands):
            values = [found.get(j, moved[j]) for j in x.operands]
            found[i] = make.multiply(*values) if x.op is Op.MULTIPLY else values[0]
    return found


def slopes_by_roots(
    make: Builder, program: Program, moved: Mapping[int, int], i: int, one: int
) -> list[tuple[int, int]]:
    """Return the roots with kinks that one of `steep` is made of, with its slopes by them but for signs.

    Args:
        make: The builder to which instructions are appended.
        program: The program.
        moved: Value in the builder of each of its instructions, where signs count as 1.
        i: The instruction.
        one: Value in the builder of the number 1.
    """
    made_of, found, waiting = steep(program), list[tuple[int, int]](), [(i, one)]
    while waiting:
        j, slope = waiting.pop()
        x = program.instructions[j]
        if x.op is Op.SQRT:
            found.append((j, slope))
        elif x.op is Op.MULTIPLY:
            pairs = (x.operands, x.operands[::-1])
            waiting += [(k, make.multiply(slope, moved[m])) for k, m in pairs if k in made_of]
        else:
            waiting += [(k, slope) for k in x.operands if k in made_of]
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
