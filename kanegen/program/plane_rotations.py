"""Components of vectors that are turned in a plane, whose derivatives by the angle are components, too.

With c and s the cosine and the sine of an angle, p = c a + s b has by this angle the derivative c b - s a,
which is the other component of the turned vector. Where a program has that one, its derivative costs nothing.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace

from kanegen.program.ir import Op, Program


@dataclass(frozen=True)
class Component:
    """The sum of two products, which nothing else uses, with the cosine and with the sine of an angle.

    Attributes:
        angle: The instruction of the angle.
        cosine: Instruction of its cosine.
        sine: Instruction of its sine.
        a: Instruction of the number that is multiplied by the cosine.
        b: That of the number that is multiplied by the sine.
        signs: Signs of the two products in the sum, 1 or -1.
    """

    angle: int
    cosine: int
    sine: int
    a: int
    b: int
    signs: tuple[int, int]

    @property
    def key(self) -> tuple[int, int, int, int]:
        """What this component has in common with its negative."""
        return self.angle, self.a, self.b, self.signs[0] * self.signs[1]

    @property
    def key_of_slope(self) -> tuple[int, int, int, int]:
        """The key of its derivative by the angle."""
        return self.angle, self.b, self.a, -self.signs[0] * self.signs[1]


def plane_rotations(program: Program) -> dict[int, tuple[Component, int, int]]:
    """Return the components of turned vectors whose derivatives by the angle are in the program.

    Args:
        program: A program in which equal values are one instruction.

    Returns:
        By instruction the component, the instruction of its derivative, and the sign of that, 1 or -1.
    """
    uses = Counter(j for x in program.instructions for j in x.operands)
    uses.update(value for output in program.outputs for value in output.values)
    components = {i: one for i in range(len(program.instructions)) if (one := _component(program, i, uses))}
    places = {one.key: i for i, one in components.items()}
    found = {}
    for i, one in components.items():
        slope = places.get(one.key_of_slope)
        if slope is not None:
            found[i] = one, slope, one.signs[1] * components[slope].signs[0]
    return found


def _component(program: Program, i: int, uses: Counter[int]) -> Component | None:
    """Return the component that an instruction computes, None for any other instruction."""
    x = program.instructions[i]
    if x.op not in (Op.ADD, Op.SUBTRACT):
        return None
    first, second = (_Product.all_of(program, j, uses) for j in x.operands)
    second_sign = 1 if x.op is Op.ADD else -1
    for one in first:
        for other in second:
            if one.angle == other.angle and one.op is not other.op:
                pair = one, replace(other, sign=second_sign * other.sign)
                cosine, sine = pair if one.op is Op.COS else reversed(pair)
                factors = cosine.factor, sine.factor, cosine.number, sine.number
                return Component(one.angle, *factors, (cosine.sign, sine.sign))
    return None


@dataclass(frozen=True)
class _Product:
    """A cosine or sine times a number.

    Attributes:
        op: `COS` or `SIN`.
        angle: The instruction of the angle.
        factor: That of the cosine or sine.
        number: That of the number.
        sign: Sign of the product, 1 or -1.
    """

    op: Op
    angle: int
    factor: int
    number: int
    sign: int

    @classmethod
    def all_of(cls, program: Program, i: int, uses: Counter[int]) -> list[_Product]:
        """Return an instruction as a cosine or sine times a number, in all ways, if it is used once."""
        x, sign = program.instructions[i], 1
        while x.op is Op.NEGATE and uses[i] == 1:
            i, sign = x.operands[0], -sign
            x = program.instructions[i]
        if x.op is not Op.MULTIPLY or uses[i] > 1:
            return []
        ways = x.operands, x.operands[::-1]
        turning = [(program.instructions[factor], factor, number) for factor, number in ways]
        return [cls(y.op, y.operands[0], k, m, sign) for y, k, m in turning if y.op in (Op.COS, Op.SIN)]
