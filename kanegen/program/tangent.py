"""Derivatives of a program with respect to its inputs, instruction by instruction, in forward mode.

Every value carries its derivatives in the directions that it depends on, and no others: derivatives that are
zero are never written down (Griewank and Walther 2008, chapters 3 and 7). Derivatives are values like all
others, so later passes share, fold and factor them. A component of a vector that is turned in a plane has the
other component as its derivative by the angle.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import reduce

from kanegen.program.builder import Builder
from kanegen.program.constants import Constants
from kanegen.program.ir import Instruction, Op, Program
from kanegen.program.plane_rotations import PlaneRotation, plane_rotations
from kanegen.program.roots import kinks_of_roots, roots_in, slopes_of_sum, steep, without_signs
from kanegen.program.selection import dependencies

FIRST_DIFFERENTIATED = {Op.SIGN: 1, Op.SELECT: 1}
"""The first operand on which the derivative of an operation depends, where it is not the first of all: a sign
and a condition are constant but for jumps, which derivatives leave out."""

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
        Tangents by instruction, for all instructions that the wanted ones depend on, but for products whose
        sums are components of turned vectors.
    """
    one = builder.constant(constants.quotient(1, 1))
    seeds = {i: {direction: one} for i, direction in directions.items()}
    return seeded_tangents(builder, program, moved, seeds, wanted, constants)


def seeded_tangents(
    builder: Builder,
    program: Program,
    moved: Mapping[int, int],
    seeds: Mapping[int, Tangent],
    wanted: Iterable[int],
    constants: Constants,
    mark: str = "_d{}",
) -> dict[int, Tangent]:
    """Append derivatives to a builder where those of some instructions are known.

    With the elements of a vector as the derivatives of the inputs, in one direction, the results are the
    product of the Jacobian and this vector.

    Args:
        builder: The builder; it holds the instructions of the program already.
        program: The program to differentiate.
        moved: Value in the builder of each instruction of the program.
        seeds: Tangents of some instructions, such as inputs; all other inputs are constant.
        wanted: Instructions of the program whose derivatives are asked for.
        constants: The arithmetic of constants.
        mark: End of the names of derivatives, with the direction left open.

    Returns:
        Tangents by instruction, as those of `tangents`.
    """
    rules, rotations = _Rules(builder, constants), plane_rotations(program)
    rotations = {i: one for i, one in rotations.items() if seeds.keys().isdisjoint(one.products)}
    products = {product for one in rotations.values() for product in one.products}
    divisors = {x.operands[1] for x in program.instructions if x.op is Op.DIVIDE}
    kinks, made_of = _kinks(builder, program, moved, rules.one), steep(program)
    unsigned = without_signs(builder, program, moved, rules.one) if made_of else {}
    found: dict[int, Tangent] = {}
    for i in dependencies(program, wanted):
        instruction = program.instructions[i]
        if i in seeds:
            found[i] = dict(seeds[i])
            continue
        if i in products:
            continue
        if i in rotations:
            turned = rules.of_rotation(rotations[i], moved, found).items()
            found[i] = {k: _named(builder, value, instruction, mark.format(k)) for k, value in turned}
            continue
        inner = [found[j] for j in instruction.operands]
        values = [moved[j] for j in instruction.operands]
        differentiated = inner[FIRST_DIFFERENTIATED.get(instruction.op, 0) :]
        active = dict.fromkeys(direction for tangent in differentiated for direction in tangent)
        found[i] = {}
        for direction in active:
            slopes = [t.get(direction) for t in inner]
            if instruction.op is Op.SQRT and i not in divisors:
                hidden = [
                    (moved[j], builder.multiply(slope, found[j][direction]))
                    for j, slope in kinks.get(i, ())
                    if direction in found[j]
                ]
                value = rules.derivative_of_root(moved[i], slopes[0], hidden)
            elif instruction.op is Op.MULTIPLY and not made_of.isdisjoint(instruction.operands):
                pairs = zip(instruction.operands, instruction.operands[::-1], strict=True)
                where = [
                    rules.counts(unsigned.get(k, moved[k]), [moved[m] for m in roots_in(program, j, made_of)])
                    if j in made_of
                    else None
                    for j, k in pairs
                ]
                value = rules.derivative_of_product(values, slopes, where)
            else:
                value = rules.derivative(instruction.op, moved[i], values, slopes)
            found[i][direction] = _named(builder, value, instruction, mark.format(direction))
    return found


def _kinks(
    builder: Builder, program: Program, moved: Mapping[int, int], one: int
) -> dict[int, list[tuple[int, int]]]:
    """Return the operands of magnitudes in radicands, each with the slope by its factor, by root."""
    found: dict[int, list[tuple[int, int]]] = {}
    for i, factors in kinks_of_roots(program).items():
        slopes = slopes_of_sum(builder, program, moved, program.instructions[i].operands[0], one)
        found[i] = [
            (program.instructions[k].operands[0], slopes[j]) for j, inner in factors.items() for k in inner
        ]
    return found


def _named(builder: Builder, value: int, instruction: Instruction, mark: str) -> int:
    """Name the derivative of a named instruction after it, with a mark at the end."""
    if not instruction.name:
        return value
    return builder.name(value, f"{instruction.name}{mark}", f"Derivatives. {instruction.note}")


def slope_of_tanh(make: Builder, one: int, a: int) -> int:
    """Return 1 - tanh^2 as (2 e/(1 + e^2))^2 with e = exp(-|a|), which keeps its digits for large a.

    Args:
        make: The builder to which instructions are appended.
        one: Its value of the number 1.
        a: The operand of tanh.
    """
    e = make.function(Op.EXP, make.negate(make.function(Op.ABS, a)))
    root = make.divide(make.add(e, e), make.add(one, make.multiply(e, e)))
    return make.multiply(root, root)


class _Rules:
    """Appends the derivative of an operation, given those of its operands; None stands for a zero.

    Args:
        builder: The builder to which instructions are appended.
        constants: The arithmetic of constants.
    """

    def __init__(self, builder: Builder, constants: Constants) -> None:
        self._builder, self._constants = builder, constants
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
            return self.derivative_of_product(operands, inner, (None, None))
        if op is Op.DIVIDE:
            fall = None if db is None else make.multiply(value, db)
            return make.multiply(self._difference(da, fall), make.divide(self.one, more[0]))
        if op in (Op.MIN, Op.MAX):
            first_less_second = make.subtract(a, more[0])
            later = make.negate(first_less_second) if op is Op.MAX else first_less_second
            return make.function(Op.SELECT, later, self._or_zero(db), self._or_zero(da))
        if op is Op.SELECT:
            return make.function(Op.SELECT, a, self._or_zero(db), self._or_zero(inner[2]))
        if op is Op.ATAN2:
            return self._of_arctangent(a, more[0], da, db)
        assert da is not None
        return self._of_one(op, value, a, da)

    def of_rotation(
        self, rotation: PlaneRotation, moved: Mapping[int, int], found: Mapping[int, Tangent]
    ) -> Tangent:
        """Return the derivatives of a component of a turned vector, by direction.

        Args:
            rotation: The component.
            moved: Value in the builder of each instruction of the program.
            found: Tangents of the numbers that are turned and of the angle.
        """
        make, result = self._builder, dict[int, int]()
        for i, slope, sign in rotation.slopes:
            for direction, change in found[i].items():
                share = make.multiply(moved[slope], change)
                if direction not in result:
                    result[direction] = share if sign > 0 else make.negate(share)
                else:
                    combine = make.add if sign > 0 else make.subtract
                    result[direction] = combine(result[direction], share)
        return result

    def derivative_of_product(
        self, operands: Sequence[int], inner: Sequence[int | None], where: Sequence[int | None]
    ) -> int:
        """Return the derivative of a product of two numbers.

        Args:
            operands: The numbers.
            inner: Their derivatives.
            where: For each of them a number that is positive where its derivative counts; None for all.
        """
        (a, b), (da, db), make = operands, inner, self._builder
        left = None if da is None else make.multiply(da, b)
        right = None if db is None else make.multiply(a, db)
        if left is not None and where[0] is not None:
            left = make.function(Op.SELECT, where[0], left, self._or_zero(None))
        if right is not None and where[1] is not None:
            right = make.function(Op.SELECT, where[1], right, self._or_zero(None))
        return self._sum(left, right)

    def counts(self, other: int, roots: Sequence[int]) -> int:
        """Return a number that is positive where the slope of a factor with roots counts in a product.

        Args:
            other: The other factor, where signs count as 1.
            roots: The roots, one of which must be 0 where the slope does not count.
        """
        make = self._builder
        return make.add(make.function(Op.ABS, other), reduce(make.multiply, roots))

    def derivative_of_root(self, value: int, da: int | None, hidden: Sequence[tuple[int, int]]) -> int:
        """Return the derivative of a square root, 0 where the root is 0 and its operand does not change.

        Where a root is 0, its derivative has no limit. But where also that of its operand is 0, as that of a
        sum of squares, the root is at a minimum, and 0 is the derivative that makes products with it finite.

        Args:
            value: The root.
            da: Derivative of its operand.
            hidden: Derivatives of the operand that count as 0 at kinks, as if there were none, each after the
                number that is 0 at its kink.
        """
        assert da is not None
        make = self._builder
        slope = make.multiply(da, make.divide(self._half, value))
        change = make.add(
            value, make.function(Op.ABS, da)
        )  # also positive where it is smooth, for tangents of this
        for number, one in hidden:
            away = make.function(Op.ABS, number)
            at_kink = make.function(Op.SELECT, away, self._or_zero(None), make.function(Op.ABS, one))
            change = make.add(change, at_kink)
        return make.function(Op.SELECT, change, slope, self._or_zero(None))

    def _of_one(self, op: Op, value: int, a: int, da: int) -> int:
        """Return the derivative of a function of one operand."""
        make = self._builder
        match op:
            case Op.NEGATE:
                return make.negate(da)
            case Op.ABS:
                return make.multiply(make.function(Op.SIGN, a), da)
            case Op.SQRT:
                return make.multiply(da, make.divide(self._half, value))
            case Op.SIN:
                return make.multiply(make.function(Op.COS, a), da)
            case Op.EXP:
                return make.multiply(value, da)
            case Op.LOG:
                return make.divide(da, a)
            case Op.TANH:
                return make.multiply(slope_of_tanh(make, self.one, a), da)
        assert op is Op.COS
        return make.negate(make.multiply(make.function(Op.SIN, a), da))

    def _of_arctangent(self, y: int, x: int, dy: int | None, dx: int | None) -> int:
        """Return (x dy - y dx)/(x^2 + y^2), the derivative of the angle of the point (x, y)."""
        make = self._builder
        left = None if dy is None else make.multiply(x, dy)
        right = None if dx is None else make.multiply(y, dx)
        squared = make.add(make.multiply(x, x), make.multiply(y, y))
        return make.divide(self._difference(left, right), squared)

    def _or_zero(self, a: int | None) -> int:
        """Return a derivative as a value, 0 where there is none."""
        return self._builder.constant(self._constants.quotient(0, 1)) if a is None else a

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
