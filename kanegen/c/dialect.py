"""How C functions differ: for one state or for several side by side, in double or in single precision.

The statements are the same; types, literals, functions, and how a value that must be positive is watched are
not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from kanegen.c.expression import Expression, cast
from kanegen.precision import DOUBLE, Precision
from kanegen.program.ir import Array, Op

FUNCTIONS = (Op.SIN, Op.COS, Op.SQRT)
"""Operations that are functions in C."""


@dataclass(frozen=True)
class Dialect:
    """Words of the C functions of one kind.

    Attributes:
        arrays: Precision of the numbers that come in and go out.
        arithmetic: Precision of everything between.
        number: Type of a value that differs between states.
        prefix: Start of the names of functions of such values.
        reserved: Names that no local may take.
        opening: Begins a function that watches values.
    """

    arrays: Precision
    arithmetic: Precision
    number: str
    prefix: str
    reserved: frozenset[str]
    opening: str

    @property
    def is_scalar(self) -> bool:
        """Whether it is for one state."""
        return not self.prefix

    @property
    def common(self) -> str:
        """Type of a value that is the same in all states."""
        return self.arithmetic.name

    @property
    def has_waves(self) -> bool:
        """Whether the angles of one state may be taken side by side."""
        return self.is_scalar and self.arrays is self.arithmetic

    @property
    def status(self) -> str:
        """What a function returns that watches values."""
        return "int" if self.is_scalar else "lanes_bits"

    def function(self, op: Op, everywhere: bool) -> str:
        """Name of the function for `op`, of values that are the same everywhere or of those that differ."""
        if self.is_scalar or everywhere:
            return f"{op.value}{self.arithmetic.suffix}"
        return f"{self.prefix}{op.value}"

    def read(self, element: str) -> Expression:
        """An element of an input array, for computing with it."""
        whole = Expression(element)
        return whole if self.arrays is self.arithmetic else cast(self.common, whole)

    def written(self, expression: Expression) -> Expression:
        """A value as an output array holds it."""
        return expression if self.arrays is self.arithmetic else cast(self.arrays.name, expression)

    def everywhere(self, text: str) -> str:
        """An expression that is the same in all states, as one of type `number`."""
        return text if self.is_scalar else f"{self.prefix}of({text})"

    def condition(self, text: str, place: int) -> str:
        """Watch the value `text`; the first to be computed that is not positive decides."""
        if self.is_scalar:
            return f"if (!failed && !({text} > {self.arithmetic.literal(0.0)})) failed = {place};"
        return f"good &= {self.prefix}positive({text});"

    def closing(self, spoilt: Sequence[Array]) -> list[str]:
        """End a function that watches values; `spoilt` are the outputs that may not hold."""
        if not self.is_scalar:
            return ["    return good;"]
        lines = []
        for array in spoilt:
            lines += [
                f"    for (int i = 0; failed && i < {array.size}; ++i) {{",
                f"        {array.name}[i] = ({self.arrays.name})NAN;",
                "    }",
            ]
        return [*lines, "    return failed;"]


def scalar(arrays: Precision = DOUBLE, arithmetic: Precision | None = None) -> Dialect:
    """One state: numbers of C and the functions of libm; computes in `arrays` unless told otherwise."""
    inner = arithmetic or arrays
    reserved = {f"{op.value}{inner.suffix}" for op in FUNCTIONS} | {
        "failed",
        "i",
        "sines",
        "cosines",
        "lanes_waves",
    }
    return Dialect(arrays, inner, inner.name, "", frozenset(reserved), "    int failed = 0;")


def lanes(precision: Precision = DOUBLE) -> Dialect:
    """Several states: the types and functions of kanegen_lanes.h."""
    own = {f"lanes_{name}" for name in (*FUNCTIONS, "sincos", "of", "positive")}
    reserved = scalar(precision).reserved | own | {"lanes", "good"}
    return Dialect(
        precision, precision, "lanes", "lanes_", reserved, "    lanes_bits good = ~(lanes_bits){0};"
    )


SCALAR = scalar()
"""One state in double precision."""

LANES = lanes()
"""Several states in double precision."""
