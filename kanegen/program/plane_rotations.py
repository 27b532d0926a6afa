"""Components of vectors that are turned in a plane, whose derivatives by the angle are components, too.

With c and s the cosine and the sine of an angle, p = c a + s b has by this angle the derivative c b - s a,
which is the other component of the turned vector. Where a program has that one, its derivative costs nothing.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace

from kanegen.program.ir import Op, Program

Slope = tuple[int, int, int]
"""An instruction, and the one whose value, times the sign 1 or -1, is the derivative by it."""


@dataclass(frozen=True)
class PlaneRotation:
    """A component of a turned vector.

    Attributes:
        slopes: The two numbers that are turned, and the angle, with the derivatives of the component by them.
        products: The instructions of the products, and of their negatives, that nothing else uses.
    """

    slopes: tuple[Slope, Slope, Slope]
    products: tuple[int, ...]


def plane_rotations(program: Program) -> dict[int, PlaneRotation]:
    """Return the components of turned vectors whose derivatives by the angle are in a program.

    Args:
        program: The program; what it computes twice is not found.

    Returns:
        The components by instruction.
    """
    uses = Counter(j for x in program.instructions for j in x.operands)
    uses.update(value for output in program.outputs for value in output.values)
    components = {i: one for i in range(len(program.instructions)) if (one := _component(program, i, uses))}
    places = {one.key: i for i, one in components.items()}
    found = {}
    for i, one in components.items():
        other = places.get(one.key_of_slope)
        if other is not None:
            of_angle = one.angle, other, one.sine.sign * components[other].cosine.sign
            found[i] = PlaneRotation(
                (one.cosine.slope, one.sine.slope, of_angle), (*one.cosine.products, *one.sine.products)
            )
    return found


@dataclass(frozen=True)
class _Product:
    """A cosine or sine times a number.

    Attributes:
        op: `COS` or `SIN`.
        angle: The instruction of the angle.
        factor: That of the cosine or sine.
        number: That of the number.
        sign: Sign of the product in a sum, 1 or -1.
        products: The instructions of the product and of its negative.
    """

    op: Op
    angle: int
    factor: int
    number: int
    sign: int
    products: tuple[int, ...]

    @property
    def slope(self) -> Slope:
        """The derivative of the sum by the number."""
        return self.number, self.factor, self.sign


@dataclass(frozen=True)
class _Component:
    """The sum of a product with the cosine and one with the sine of an angle."""

    cosine: _Product
    sine: _Product

    @property
    def angle(self) -> int:
        """The instruction of the angle."""
        return self.cosine.angle

    @property
    def key(self) -> tuple[int, int, int, int]:
        """What the component has in common with its negative alone."""
        return self.angle, self.cosine.number, self.sine.number, self.cosine.sign * self.sine.sign

    @property
    def key_of_slope(self) -> tuple[int, int, int, int]:
        """The key of its derivative by the angle."""
        return self.angle, self.sine.number, self.cosine.number, -self.cosine.sign * self.sine.sign


def _component(program: Program, i: int, uses: Counter[int]) -> _Component | None:
    """Return the component that an instruction computes, None for any other instruction."""
    x = program.instructions[i]
    if x.op not in (Op.ADD, Op.SUBTRACT):
        return None
    j, k = x.operands
    for one in _products(program, j, uses):
        for other in _products(program, k, uses):
            if one.angle == other.angle and one.op is not other.op:
                second = replace(other, sign=-other.sign) if x.op is Op.SUBTRACT else other
                return _Component(one, second) if one.op is Op.COS else _Component(second, one)
    return None


def _products(program: Program, i: int, uses: Counter[int]) -> Iterator[_Product]:
    """Yield an instruction that is used once as a cosine or sine times a number, in all ways."""
    x, sign = program.instructions[i], 1
    products: tuple[int, ...] = (i,)
    while x.op is Op.NEGATE and uses[i] == 1:
        i, sign = x.operands[0], -sign
        x, products = program.instructions[i], (*products, i)
    if x.op is Op.MULTIPLY and uses[i] == 1:
        for factor, number in (x.operands, x.operands[::-1]):
            y = program.instructions[factor]
            if y.op in (Op.COS, Op.SIN):
                yield _Product(y.op, y.operands[0], factor, number, sign, products)
