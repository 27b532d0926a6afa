"""Expressions of C that compute exactly the operations they are made of, in the same order.

C groups `a + b - c` and `a*b/c` from the left, so only other groupings get brackets. A sign is kept apart
until it is printed: it passes outward through products and quotients, and into the operator of a sum. In
IEEE arithmetic that changes no bit, because `a + (-b)` is `a - b` and `(-a) b` is `-(a b)`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import IntEnum

from kanegen.c.layout import BREAK, HINGE
from kanegen.precision import DOUBLE, Precision
from kanegen.program.ir import Op


class Level(IntEnum):
    """How tightly the outermost operator of an expression binds."""

    SUM = 1
    PRODUCT = 2
    ATOM = 3


@dataclass(frozen=True, slots=True)
class Expression:
    """A C expression.

    Attributes:
        text: The expression without its sign.
        level: Its outermost operator.
        negative: Whether a minus belongs in front.
        operations: How many operations it holds; a sign counts nothing.
    """

    text: str
    level: Level = Level.ATOM
    negative: bool = False
    operations: int = 0

    def __neg__(self) -> Expression:
        return replace(self, negative=not self.negative)

    def __str__(self) -> str:
        return f"-{_bracketed(self, Level.PRODUCT)}" if self.negative else self.text


def literal(number: float, precision: Precision = DOUBLE) -> Expression:
    """A finite number; reading it back gives the same bits, or the nearest of a lower precision."""
    return Expression(precision.literal(abs(number)), negative=math.copysign(1.0, number) < 0)


def cast(kind: str, expression: Expression) -> Expression:
    """`expression` converted to the type `kind`."""
    return Expression(f"({kind}){_bracketed(expression, Level.ATOM)}", negative=expression.negative)


def apply(op: Op, operands: tuple[Expression, ...], function: str = "") -> Expression:
    """The operation `op`, any but an input or a constant, on `operands`.

    Args:
        op: What to compute.
        operands: As many as it takes.
        function: Name of the C function for it, where it is one.
    """
    match op, operands:
        case Op.NEGATE, (a,):
            return -a
        case Op.ADD, (a, b):
            return _sum(a, b)
        case Op.SUBTRACT, (a, b):
            return _sum(a, -b)
        case Op.MULTIPLY, (a, b):
            return _product(a, "*", b)
        case Op.DIVIDE, (a, b):
            return _product(a, "/", b)
        case ((Op.SQRT | Op.SIN | Op.COS), (a,)):
            return Expression(f"{function}({a})", operations=a.operations + 1)
    raise ValueError(f"{op} is no operation on {len(operands)} operands")


def _sum(a: Expression, b: Expression) -> Expression:
    if a.negative and not b.negative:
        a, b = b, a
    text = f"{a}{BREAK}{'-' if b.negative else '+'} {_bracketed(b, Level.PRODUCT)}"
    return Expression(text, Level.SUM, operations=a.operations + b.operations + 1)


def _product(a: Expression, operator: str, b: Expression) -> Expression:
    return Expression(
        f"{_bracketed(a, Level.PRODUCT)}{HINGE}{operator}{_bracketed(b, Level.ATOM)}",
        Level.PRODUCT,
        negative=a.negative != b.negative,
        operations=a.operations + b.operations + 1,
    )


def _bracketed(expression: Expression, level: Level) -> str:
    """The text without sign, in brackets where it binds more loosely than `level`."""
    return expression.text if expression.level >= level else f"({expression.text})"
