"""How C functions differ: for one state or for several side by side, and in their precision.

The statements are the same; types, literals, functions, and how a value that must be positive is watched are
not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from kanegen.c.expression import Expression, Notation, converted, literal, notation
from kanegen.c.formats import Formats, uniform
from kanegen.program.ir import Array, Op
from kanegen.program.precision import DOUBLE, Precision

FUNCTIONS = (Op.SIN, Op.COS, Op.SQRT)
"""Operations that are functions in C."""


@dataclass(frozen=True)
class Dialect:
    """Words of the C functions of one kind.

    Attributes:
        formats: Precision of the arrays.
        arithmetic: Precision of everything between.
        number: Type of a value that differs between states.
        prefix: Start of the names of functions of such values.
        reserved: Names that no local may take.
        own: Whether sine and cosine are those of kanegen_sincos.h, else those of libm.
    """

    formats: Formats
    arithmetic: Precision
    number: str
    prefix: str
    reserved: frozenset[str]
    own: bool = False

    @property
    def is_scalar(self) -> bool:
        """Whether it is for one state."""
        return not self.prefix

    @property
    def common(self) -> str:
        """Type of a value that is the same in all states."""
        return self.arithmetic.c_type

    @property
    def notation(self) -> Notation:
        """How operations are written."""
        return notation(self.arithmetic)

    @property
    def has_waves(self) -> bool:
        """Whether the angles of one state may be taken side by side."""
        alike = self.formats.every == (self.arithmetic,)
        return self.own and self.is_scalar and alike

    @property
    def has_pairs(self) -> bool:
        """Whether sine and cosine of an angle come from one call."""
        return self.own or self.arithmetic.has_sincos or not self.is_scalar

    @property
    def status(self) -> str:
        """What a function returns that watches values."""
        return "int" if self.is_scalar else "lanes_bits"

    def function(self, op: Op, everywhere: bool) -> str:
        """Name of the function for `op`, of values that are the same everywhere or of those that differ."""
        if self.own and op is not Op.SQRT and (self.is_scalar or everywhere):
            return f"kanegen_{op.value}{self.arithmetic.libm_suffix}"
        if self.is_scalar or everywhere:
            return self.arithmetic.c_function(op.value)
        return f"{self.prefix}{op.value}"

    def pair(self, angle: str, sine: str, cosine: str) -> str:
        """A call that sets both of the angle, the name of a local."""
        if self.own and self.is_scalar:
            return f"kanegen_sincos{self.arithmetic.libm_suffix}({angle}, &{sine}, &{cosine});"
        name = self.arithmetic.c_function("sincos") if self.is_scalar else f"{self.prefix}sincos"
        return f"{name}(&{angle}, &{sine}, &{cosine});"

    def read(self, array: str, element: str) -> Expression:
        """An element of an input array, for computing with it."""
        return converted(Expression(element), self.formats.of(array), self.arithmetic)

    def written(self, array: str, expression: Expression) -> Expression:
        """A value as an output array holds it."""
        held = self.formats.of(array)
        return notation(held).whole(converted(expression, self.arithmetic, held))

    def number_in(self, array: str, number: Any) -> str:
        """A number as an output array holds it, rounded once: as the arithmetic has it, if that has less."""
        held = self.formats.of(array)
        coarser = min(self.arithmetic, held, key=lambda precision: precision.significand_bits)
        text = notation(held).text(converted(literal(number, coarser), coarser, held))
        return self.everywhere(text)

    def everywhere(self, text: str) -> str:
        """An expression that is the same in all states, as one of type `number`."""
        return text if self.is_scalar else f"{self.prefix}of({text})"

    def condition(self, text: str, place: int) -> str:
        """Watch the value `text`; the first to be computed that is not positive decides."""
        if self.is_scalar:
            return f"if (!failed && !({self.notation.positive(text)})) failed = {place};"
        return f"good &= {self.prefix}positive({text});"

    def margin(self, value: Expression, place: int) -> str:
        """Watch a value that must be positive for accuracy; the least of them decides, or the first NaN."""
        if not self.is_scalar:
            return f"fine &= {self.prefix}positive({value});"
        rounded = converted(value, self.arithmetic, self.arithmetic if self._is_ordered else DOUBLE)
        return f"if (!({rounded} > least) && least == least) least = {rounded}, doubtful = -{place};"

    @property
    def _is_ordered(self) -> bool:
        """Whether < is an operator on its numbers."""
        return type(self.notation) is Notation

    def opening(self, has_margins: bool) -> list[str]:
        """Begin a function that watches values, also such that accuracy needs if `has_margins`."""
        if not self.is_scalar:
            lines = ["    lanes_bits good = ~(lanes_bits){0};"]
            return [*lines, "    lanes_bits fine = ~(lanes_bits){0};"] if has_margins else lines
        if not has_margins:
            return ["    int failed = 0;"]
        kind = self.arithmetic if self._is_ordered else DOUBLE
        return ["    int failed = 0, doubtful = 0;", f"    {kind.c_type} least = {kind.literal(0.0)};"]

    def closing(self, spoilt: Sequence[Array], has_margins: bool) -> list[str]:
        """End a function that watches values.

        Args:
            spoilt: The outputs that may not hold.
            has_margins: As for `opening`.
        """
        if not self.is_scalar:
            return [*(["    *accurate = fine;"] if has_margins else []), "    return good;"]
        lines = []
        for array in spoilt:
            lines += [
                f"    for (int i = 0; failed && i < {array.size}; ++i) {{",
                f"        {array.name}[i] = {notation(self.formats.of(array.name)).nothing};",
                "    }",
            ]
        return [*lines, f"    return {'failed ? failed : doubtful' if has_margins else 'failed'};"]


def scalar(formats: Formats, arithmetic: Precision | None = None, own: bool = False) -> Dialect:
    """One state: numbers of C; computes in the arithmetic of `formats` unless told otherwise."""
    inner = arithmetic or formats.arithmetic
    reserved = {inner.c_function(op.value) for op in FUNCTIONS} | {
        "failed",
        "doubtful",
        "least",
        "i",
        "sines",
        "cosines",
        "lanes_waves",
    }
    return Dialect(formats, inner, inner.c_type, "", frozenset(reserved), own)


def lanes(precision: Precision = DOUBLE, own: bool = False) -> Dialect:
    """Several states: the types and functions of kanegen_lanes.h."""
    functions = {f"lanes_{name}" for name in (*FUNCTIONS, "sincos", "of", "positive")}
    reserved = scalar(uniform(precision)).reserved | functions | {"lanes", "good", "fine", "accurate"}
    return Dialect(uniform(precision), precision, "lanes", "lanes_", reserved, own)


SCALAR = scalar(uniform(DOUBLE))
"""One state in double precision."""

LANES = lanes()
"""Several states in double precision."""
