"""Derivatives of a weighted sum of values by all inputs of a program at once, in reverse mode.

Every value has an adjoint, the derivative of the weighted sum by this value. Adjoints are found from the last
instruction to the first: an instruction adds to those of its operands its own adjoint times its slopes
(Griewank and Walther 2008, section 3.2). Only values between the inputs that are asked for and the weighted
ones have adjoints. Adjoints are values like all others, so later passes share, fold and factor them.

A branch of a condition that is not taken may be undefined, such as 1/x where x is 0, and a product with it
would be undefined, too. So the adjoint of a value in a branch remembers the condition, and becomes 0 where
the branch is not taken only in the last moment, where it is added to others.

The components of a vector that is turned in a plane have one another as derivatives by the angle. So each
adds one product to the adjoint of the angle, and nothing to those of its cosine and sine.
"""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import reduce
from itertools import takewhile

from kanegen.program.builder import Builder
from kanegen.program.constants import Constants
from kanegen.program.ir import Instruction, Op, Program
from kanegen.program.plane_rotations import plane_rotations
from kanegen.program.roots import kinks_of_roots, slopes_by_roots, slopes_of_sum, steep, without_signs
from kanegen.program.selection import dependencies
from kanegen.program.tangent import slope_of_tanh


@dataclass(frozen=True)
class Branch:
    """One branch of a condition.

    Attributes:
        condition: The value that decides.
        positive: Whether the branch is taken where that is positive.
    """

    condition: int
    positive: bool


Branches = tuple[Branch, ...]
"""Branches within each other, the outermost first; () where a value is always used."""

Share = tuple[int, Branches, int]
"""What an instruction adds to an adjoint: the instruction that has the adjoint, branches, value."""


def adjoints(
    builder: Builder,
    program: Program,
    moved: Mapping[int, int],
    weights: Mapping[int, int],
    wanted: Collection[int],
    constants: Constants,
) -> dict[int, int]:
    """Append the derivatives of a weighted sum of values to a builder.

    Args:
        builder: The builder; it holds the instructions of the program already.
        program: The program to differentiate.
        moved: Value in the builder of each instruction of the program.
        weights: Value in the builder of the weight of each instruction in the sum.
        wanted: Instructions of the program by which the sum is differentiated, such as inputs.
        constants: The arithmetic of constants.

    Returns:
        The derivatives by instruction of `wanted`; one that is zero is absent.
    """
    sweep = _Sweep(builder, program, moved, constants)
    active = _active(program, wanted, weights)
    for i, weight in weights.items():
        if i in active:
            sweep.add((i, (), weight))
    found: dict[int, int] = {}
    for i in reversed(active):
        if not sweep.reaches(i):
            continue  # only conditions depend on it
        if i in wanted:
            found[i] = sweep.settled(i, least=True)[1]
        else:
            branches, adjoint = sweep.settled(i)
            adjoint = _named(builder, adjoint, program.instructions[i])
            for share in sweep.shares(i, branches, adjoint):
                if share[0] in active:
                    sweep.add(share)
    return found


def _active(program: Program, wanted: Collection[int], weights: Collection[int]) -> dict[int, None]:
    """Return the instructions, in order, that depend on wanted ones and that weighted ones depend on."""
    active: dict[int, None] = {}
    for i in dependencies(program, weights):
        x = program.instructions[i]
        if i in wanted or (x.op is not Op.SIGN and any(j in active for j in _differentiated(x))):
            active[i] = None
    return active


def _differentiated(instruction: Instruction) -> tuple[int, ...]:
    """Return the operands on which the derivative of an operation depends: a condition is none of them."""
    return instruction.operands[1:] if instruction.op is Op.SELECT else instruction.operands


def _named(builder: Builder, value: int, instruction: Instruction) -> int:
    """Name the adjoint of a named instruction after it."""
    if not instruction.name:
        return value
    return builder.name(value, f"{instruction.name}_adj", f"Adjoints. {instruction.note}")


def _common(first: Branches, second: Branches) -> Branches:
    """Return the outer branches that two paths of branches have in common."""
    pairs = takewhile(lambda pair: pair[0] == pair[1], zip(first, second, strict=False))
    return tuple(branch for branch, _ in pairs)


class _Sweep:
    """The sweep from the last instruction to the first.

    Args:
        builder: The builder to which instructions are appended.
        program: The program that is differentiated.
        moved: Value in the builder of each of its instructions.
        constants: The arithmetic of constants.
    """

    def __init__(
        self, builder: Builder, program: Program, moved: Mapping[int, int], constants: Constants
    ) -> None:
        self._builder, self._program, self._moved = builder, program, moved
        self._zero, self._half, self._one = (
            builder.constant(constants.quotient(*pair)) for pair in ((0, 1), (1, 2), (1, 1))
        )
        self._shares: dict[int, dict[Branches, list[int]]] = {}
        self._rotations = plane_rotations(program)
        self._divisors = {x.operands[1] for x in program.instructions if x.op is Op.DIVIDE}
        self._kinks, self._steep = kinks_of_roots(program), steep(program)
        self._unsigned = without_signs(builder, program, moved, self._one) if self._steep else {}

    def add(self, share: Share) -> None:
        """Add a share to the adjoint of an instruction."""
        i, branches, value = share
        self._shares.setdefault(i, {}).setdefault(branches, []).append(value)

    def reaches(self, i: int) -> bool:
        """Return whether an instruction has a share of an adjoint."""
        return i in self._shares

    def settled(self, i: int, *, least: bool = False) -> tuple[Branches, int]:
        """Return the adjoint of an instruction, the sum of its shares, and the branches that it stands in.

        Args:
            i: The instruction.
            least: Whether the adjoint shall stand in no branch.
        """
        shares = self._shares.pop(i)
        common = () if least else reduce(_common, shares)
        sums = []
        for branches, values in shares.items():
            value = reduce(self._builder.add, values)
            for branch in reversed(branches[len(common) :]):
                value = self._where(branch, value)
            sums.append(value)
        return common, reduce(self._builder.add, sums)

    def _where(self, branch: Branch, value: int) -> int:
        """Return a value where a branch is taken, and 0 elsewhere."""
        chosen = (value, self._zero) if branch.positive else (self._zero, value)
        return self._builder.function(Op.SELECT, branch.condition, *chosen)

    def shares(self, i: int, branches: Branches, adjoint: int) -> Iterator[Share]:
        """Yield what an instruction adds to the adjoints of its operands."""
        x = self._program.instructions[i]
        values = [self._moved[j] for j in x.operands]
        if x.op in (Op.MIN, Op.MAX, Op.SELECT):
            yield from self._of_choice(x, values, branches, adjoint)
        elif i in self._rotations:
            for j, value in self._of_rotation(i, adjoint):
                yield j, branches, value
        elif x.op is Op.SQRT and i not in self._divisors:
            for j, value in self._of_root(i, x.operands[0], adjoint):
                yield j, branches, value
        elif len(values) == 1:
            yield x.operands[0], branches, self._of_one(x.op, self._moved[i], values[0], adjoint)
        else:
            for j, value in self._of_two(i, adjoint):
                yield j, branches, value

    def _of_choice(
        self, instruction: Instruction, values: list[int], branches: Branches, adjoint: int
    ) -> Iterator[Share]:
        """Yield the shares of the operands among which an operation chooses, each in its branch."""
        make = self._builder
        if instruction.op is Op.SELECT:
            condition, (_, first, second) = values[0], instruction.operands
        else:
            second, first = instruction.operands
            condition = make.subtract(*values)
            condition = make.negate(condition) if instruction.op is Op.MAX else condition
        yield first, (*branches, Branch(condition, positive=True)), adjoint
        yield second, (*branches, Branch(condition, positive=False)), adjoint

    def _of_one(self, op: Op, value: int, a: int, adjoint: int) -> int:
        """Return the share of the operand of a function of one operand."""
        make = self._builder
        match op:
            case Op.NEGATE:
                return make.negate(adjoint)
            case Op.ABS:
                return make.multiply(make.function(Op.SIGN, a), adjoint)
            case Op.SQRT:
                return make.multiply(adjoint, make.divide(self._half, value))
            case Op.SIN:
                return make.multiply(make.function(Op.COS, a), adjoint)
            case Op.EXP:
                return make.multiply(value, adjoint)
            case Op.LOG:
                return make.divide(adjoint, a)
            case Op.TANH:
                return make.multiply(slope_of_tanh(make, self._one, a), adjoint)
        assert op is Op.COS
        return make.negate(make.multiply(make.function(Op.SIN, a), adjoint))

    def _of_two(self, i: int, adjoint: int) -> Iterator[tuple[int, int]]:
        """Yield the shares of the operands of a function of two operands, and of roots in them."""
        make, x = self._builder, self._program.instructions[i]
        (j, k), (a, b) = x.operands, (self._moved[operand] for operand in x.operands)
        match x.op:
            case Op.ADD:
                left, right = adjoint, adjoint
            case Op.SUBTRACT:
                left, right = adjoint, make.negate(adjoint)
            case Op.MULTIPLY:
                left, right = make.multiply(adjoint, b), make.multiply(a, adjoint)
            case Op.DIVIDE:
                left = make.multiply(adjoint, make.divide(self._one, b))
                right = make.negate(make.multiply(self._moved[i], left))
            case _:
                assert x.op is Op.ATAN2
                squared = make.add(make.multiply(b, b), make.multiply(a, a))
                share = make.divide(adjoint, squared)
                left, right = make.multiply(b, share), make.negate(make.multiply(a, share))
        yield j, left
        yield k, right
        if x.op is Op.MULTIPLY:
            yield from self._of_root_with_sign(j, k, adjoint)
            yield from self._of_root_with_sign(k, j, adjoint)

    def _of_rotation(self, i: int, adjoint: int) -> Iterator[tuple[int, int]]:
        """Yield the shares of the angle and the numbers that a component of a turned vector is made of."""
        make = self._builder
        for j, slope, sign in self._rotations[i].slopes:
            share = make.multiply(self._moved[slope], adjoint)
            yield j, share if sign > 0 else make.negate(share)

    def _of_root_with_sign(self, i: int, other: int, adjoint: int) -> Iterator[tuple[int, int]]:
        """Yield what the roots in a factor of a product have besides, where the other factor is 0 by a sign.

        There the adjoint of such a root is 0, but the root has no slope that could be left out, see `roots`.

        Args:
            i: The instruction of the factor.
            other: That of the other factor.
            adjoint: Adjoint of the product.
        """
        if i not in self._steep or other not in self._unsigned:
            return
        make, moved = self._builder, self._moved
        weight = make.multiply(adjoint, self._unsigned[other])
        values = ChainMap(self._unsigned, dict(moved))
        for j, slope in slopes_by_roots(make, self._program, values, i, self._one):
            by_root = make.multiply(weight, slope)
            infinite = make.function(
                Op.SELECT, make.function(Op.ABS, by_root), make.divide(by_root, moved[j]), self._zero
            )
            away = make.add(make.function(Op.ABS, moved[j]), make.function(Op.ABS, moved[other]))
            yield j, make.function(Op.SELECT, away, self._zero, infinite)

    def _of_root(self, i: int, radicand: int, adjoint: int) -> Iterator[tuple[int, int]]:
        """Yield the shares of the terms whose sum has the root, and of factors of these.

        Where a root is 0, its slope has no limit. But where also that of its radicand is 0, as that of a sum
        of squares, the root is at a minimum, and 0 is the derivative, as in `tangent`. So the slopes of the
        radicand by the factors of its terms are formed first. A magnitude in one of these has itself a slope
        that counts as 0, see `roots`; the share of such a factor is 0 where the adjoint of the root is.
        """
        make, root, kinks = self._builder, self._moved[i], self._kinks.get(i, {})
        slopes = slopes_of_sum(make, self._program, self._moved, radicand, self._one)
        for j, slope in slopes.items():
            steep = make.multiply(slope, make.divide(self._half, root))
            not_at_minimum = make.add(root, make.function(Op.ABS, slope))
            here = make.function(Op.SELECT, not_at_minimum, steep, self._zero)
            share = make.multiply(adjoint, here)
            if j in kinks:
                counts = make.add(root, make.function(Op.ABS, adjoint))
                share = make.function(Op.SELECT, counts, share, self._zero)
            yield j, share
