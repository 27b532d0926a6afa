"""C expressions that compute exactly the operations of a program, in the same order.

C groups `a + b - c` and `a*b/c` from the left, so only other groupings get brackets. A sign is kept apart
until the expression is printed: it passes outward through products and quotients, and into the operator of a
sum. In IEEE arithmetic that changes no bit, because `a + (-b)` is `a - b` and `(-a) b` is `-(a b)`.
"""

from __future__ import annotations

import functools
import math
from enum import IntEnum
from typing import Any, NamedTuple

from kanegen.c.layout import BREAK, HINGE
from kanegen.program.ir import ARITY, Op
from kanegen.program.precision import DOUBLE, DOUBLE_DOUBLE, Precision


class Level(IntEnum):
    """The precedence of the outermost operator of an expression."""

    SUM = 1
    PRODUCT = 2
    ATOM = 3


class Expression(NamedTuple):
    """A C expression.

    Attributes:
        text: The expression without its sign.
        level: Precedence of the outermost operator.
        negative: Whether a minus belongs in front of the text.
        operations: Number of operations in the text; a sign is none.
    """

    text: str
    level: Level = Level.ATOM
    negative: bool = False
    operations: int = 0

    def __neg__(self) -> Expression:
        return self._replace(negative=not self.negative)

    def __str__(self) -> str:
        return f"-{_bracketed(self, Level.PRODUCT)}" if self.negative else self.text


def literal(number: Any, precision: Precision = DOUBLE) -> Expression:
    """Return a finite number as a literal that reads back to the nearest number of `precision`."""
    return Expression(precision.literal(abs(number)), negative=math.copysign(1.0, number) < 0)


def cast(kind: str, expression: Expression) -> Expression:
    """Return `expression` converted to the type `kind`."""
    return Expression(f"({kind}){_bracketed(expression, Level.ATOM)}", negative=expression.negative)


def converted(expression: Expression, source: Precision, target: Precision) -> Expression:
    """Return `expression` converted from one precision to another."""
    if source is target:
        return expression
    if target is DOUBLE_DOUBLE:
        return expression._replace(text=f"dd_of({expression.text})", level=Level.ATOM)
    if source is DOUBLE_DOUBLE:
        return expression._replace(text=f"dd_rounded({expression.text})", level=Level.ATOM)
    return cast(target.c_type, expression)


class Notation:
    """Operations on the numbers of C, written with operators."""

    def __init__(self, precision: Precision) -> None:
        self._precision = precision

    @property
    def nothing(self) -> str:
        """The expression of NaN."""
        return f"({self._precision.c_type})NAN"

    def text(self, expression: Expression) -> str:
        """Return the text of an expression with its sign."""
        return str(self.whole(expression))

    def whole(self, expression: Expression) -> Expression:
        """Return an expression whose sign, if any, an operator can write."""
        return expression

    def positive(self, text: str) -> str:
        """Return the condition that a value is positive."""
        return f"{text} > {self._precision.literal(0.0)}"

    def sum(self, a: Expression, b: Expression) -> Expression:
        """Return a + b, where a may be negative only if b is."""
        text = f"{a}{BREAK}{'-' if b.negative else '+'} {_bracketed(b, Level.PRODUCT)}"
        return Expression(text, Level.SUM, operations=a.operations + b.operations + 1)

    def product(self, op: Op, a: Expression, b: Expression) -> Expression:
        """Return the product or the quotient of a and b."""
        operator = "*" if op is Op.MULTIPLY else "/"
        return Expression(
            f"{_bracketed(a, Level.PRODUCT)}{HINGE}{operator}{_bracketed(b, Level.ATOM)}",
            Level.PRODUCT,
            negative=a.negative != b.negative,
            operations=a.operations + b.operations + 1,
        )


class DoubleDoubleNotation(Notation):
    """Operations on double-double numbers, written as calls of kanegen_double_double.h."""

    @property
    def nothing(self) -> str:
        """The expression of NaN."""
        return "dd_of((double)NAN)"

    def whole(self, expression: Expression) -> Expression:
        """Return an expression without a sign, which becomes a call."""
        if not expression.negative:
            return expression
        return expression._replace(text=f"dd_negate({expression.text})", negative=False)

    def positive(self, text: str) -> str:
        """Return the condition that a value is positive."""
        return f"dd_positive({text})"

    def sum(self, a: Expression, b: Expression) -> Expression:
        """Return a + b, where a may be negative only if b is."""
        if a.negative:
            return -self.sum(-a, -b)
        return self._call("subtract" if b.negative else "add", a, b)

    def product(self, op: Op, a: Expression, b: Expression) -> Expression:
        """Return the product or the quotient of a and b."""
        return self._call(op.value, a, b)._replace(negative=a.negative != b.negative)

    def _call(self, name: str, a: Expression, b: Expression) -> Expression:
        text = f"{self._precision.c_function(name)}({a.text},{BREAK}{b.text})"
        return Expression(text, operations=a.operations + b.operations + 1)


@functools.cache
def notation(precision: Precision) -> Notation:
    """Return the notation of operations in `precision`."""
    return DoubleDoubleNotation(precision) if precision is DOUBLE_DOUBLE else Notation(precision)


def apply(
    op: Op, operands: tuple[Expression, ...], function: str = "", written: Notation | None = None
) -> Expression:
    """Return the expression of an operation on `operands`.

    Args:
        op: The operation, any but an input or a constant.
        operands: Its operands, as many as `ARITY` says.
        function: Name of the C function for the operation, where it is a call.
        written: Notation of operations; by default that of double precision.
    """
    written = written or notation(DOUBLE)
    match op, operands:
        case Op.NEGATE, (a,):
            return -a
        case Op.ADD, (a, b):
            return _sum(a, b, written)
        case Op.SUBTRACT, (a, b):
            return _sum(a, -b, written)
        case ((Op.MULTIPLY | Op.DIVIDE), (a, b)):
            return written.product(op, a, b)
    if not function or len(operands) != ARITY[op]:
        raise ValueError(f"{op} is no operation on {len(operands)} operands")
    arguments = f",{BREAK}".join(map(written.text, operands))
    return Expression(f"{function}({arguments})", operations=sum(one.operations for one in operands) + 1)


def _sum(a: Expression, b: Expression, written: Notation) -> Expression:
    return written.sum(b, a) if a.negative and not b.negative else written.sum(a, b)


def _bracketed(expression: Expression, level: Level) -> str:
    """Return the text without sign, in brackets where it binds more loosely than `level`."""
    return expression.text if expression.level >= level else f"({expression.text})"
