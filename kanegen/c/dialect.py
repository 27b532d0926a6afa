"""Dialects: the notation of the statements of a function, for one state or for several in SIMD lanes.

A function body consists of the same operations in every dialect. Dialects differ in types, literals, names of
functions, declarations of locals, and the test of values that must be positive.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from kanegen.c.expression import Expression, Notation, converted, literal, notation
from kanegen.c.formats import Formats, uniform
from kanegen.c.simd import SIMD as VECTORS
from kanegen.c.usage import NO_NAMES, Run, element
from kanegen.program.ir import CHOICES, TRANSCENDENTAL, WORKSPACE, Array, Op
from kanegen.program.precision import DOUBLE, DOUBLE_DOUBLE, PRECISIONS, Precision

FUNCTIONS = (Op.SIN, Op.COS, Op.SQRT, Op.ABS)
"""Operations that are calls of functions of libm, or of kanegen in their place."""

ELEMENTARY = (*CHOICES, *TRANSCENDENTAL)
"""Operations that are calls of functions of the headers `kanegen_elementary`."""


def elementary_function(op: Op, precision: Precision) -> str:
    """Return the name of the C function for one of `ELEMENTARY`."""
    if precision is DOUBLE_DOUBLE:
        return precision.c_function(op.value)
    return f"kanegen_{op.value}{precision.libm_suffix}"


def finite_test(precision: Precision) -> str:
    """Return the name of the C function that tests whether all numbers of an array are finite."""
    return f"all_finite{'_dd' if precision is DOUBLE_DOUBLE else precision.libm_suffix}"


_RESERVED = frozenset(
    {
        "failed",
        "inaccurate",
        "least_margin",
        "status",
        "i",
        "sines",
        "cosines",
        "simd_vector_sincos",
        *map(finite_test, PRECISIONS.values()),
    }
)
"""Names in the body of a function for one state that no local may take."""

_RESERVED_SIMD = frozenset({"simd", "valid", "within_margin", "accurate"})
"""Further names in the body of a function for several states."""


@dataclass(frozen=True)
class Dialect:
    """Functions for one state in C; other dialects derive from it.

    Attributes:
        formats: Precisions of the arrays.
        arithmetic: Precision of everything that is computed.
        kanegen_sincos: Whether sine and cosine are those of kanegen_sincos.h, else those of libm.
        places: Enumerators of the places of some arrays, by name of the array.
        has_lanes: Whether kanegen_simd.h stands beside the code.
        in_pieces: Whether parts of functions stand in pieces of a file, which may be compiled each by itself.
    """

    formats: Formats
    arithmetic: Precision
    kanegen_sincos: bool = False
    places: Mapping[str, Sequence[str]] = field(default_factory=dict)
    has_lanes: bool = True
    in_pieces: bool = False

    @property
    def is_scalar(self) -> bool:
        """Whether the function is for one state."""
        return True

    @property
    def number(self) -> str:
        """Type of a value that differs between states."""
        return self.arithmetic.c_type

    @property
    def common(self) -> str:
        """Type of a value that is the same in all states."""
        return self.arithmetic.c_type

    @property
    def reserved(self) -> frozenset[str]:
        """Names that no local may take."""
        return _RESERVED | {self.arithmetic.c_function(op.value) for op in FUNCTIONS}

    @property
    def notation(self) -> Notation:
        """The notation of operations on numbers of the arithmetic."""
        return notation(self.arithmetic)

    @property
    def vector_sincos(self) -> str:
        """Name of the function that computes sines and cosines of several coordinates, "" without one."""
        has_any = self.has_lanes and self.kanegen_sincos and self.formats.every == (self.arithmetic,)
        return "simd_vector_sincos" if has_any else ""

    @property
    def spread(self) -> int:
        """Most elements for each angle, whatever lies between, of which `vector_sincos` computes sines.

        Two lanes hold two angles in the time of one.
        """
        return 2

    @property
    def has_columns_in_lanes(self) -> bool:
        """Whether several columns of a solution may be computed in SIMD lanes."""
        return self.has_lanes and self.arithmetic in VECTORS and self.formats.every == (self.arithmetic,)

    @property
    def has_sincos(self) -> bool:
        """Whether one call gives sine and cosine of an angle."""
        return self.kanegen_sincos or self.arithmetic.has_sincos

    @property
    def status(self) -> str:
        """Type that a function returns if its outputs may fail."""
        return "int"

    def local(self, kind: str, name: str, text: str) -> str:
        """Return the statement that defines the constant local `name` of type `kind`."""
        return f"const {kind} {name} = {text};"

    def before(self, first: int, last: int) -> list[str]:
        """Return the statements that stand before instruction `last` and behind the one before `first`."""
        return []

    def ignored(self, name: str) -> str:
        """Return the statement that marks an unused argument."""
        return f"(void){name};"

    def workspace(self, size: int) -> list[str]:
        """Return the declaration of the array in which parts of a function leave values for later parts."""
        return [f"    {self.number} {WORKSPACE}[{size}];"]

    def argument(self, array: str, is_common: bool, is_read: bool) -> str:
        """Return the declaration of an array that a part of a function takes.

        Args:
            array: Name of the array.
            is_common: Whether all states have the array in common.
            is_read: Whether the part reads the array, or else fills it.
        """
        kind = self.formats.of(array).c_type if self.is_scalar or is_common else self.number
        return f"{'const ' * is_read}{kind} *{array}"

    def part(self, name: str, may_fail: bool, arrays: Sequence[str]) -> str:
        """Return the beginning of the definition of a part of a function, up to its arguments.

        Args:
            name: Name of the part.
            may_fail: Whether it returns a status.
            arrays: Names of the arrays that it takes.
        """
        return f"{self._linkage} {self.status if may_fail else 'void'} {name}"

    @property
    def _linkage(self) -> str:
        """Linkage of the parts of functions."""
        return "PART" if self.in_pieces else "static NOINLINE"

    def function(self, op: Op, everywhere: bool) -> str:
        """Return the name of the function for `op`.

        Args:
            op: One of `FUNCTIONS` or `ELEMENTARY`.
            everywhere: Whether its arguments are the same in all states.
        """
        if op in ELEMENTARY:
            return elementary_function(op, self.arithmetic)
        if self.kanegen_sincos and op in (Op.SIN, Op.COS):
            return f"kanegen_{op.value}{self.arithmetic.libm_suffix}"
        return self.arithmetic.c_function(op.value)

    def sincos(self, angle: str, sine: str, cosine: str) -> str:
        """Return the call that sets the locals `sine` and `cosine` from the local `angle`."""
        if self.kanegen_sincos:
            return f"kanegen_sincos{self.arithmetic.libm_suffix}({angle}, &{sine}, &{cosine});"
        return f"{self.arithmetic.c_function('sincos')}(&{angle}, &{sine}, &{cosine});"

    def element(self, array: Array, index: int) -> str:
        """Return the text of element `index` of an array."""
        return element(array, index, self.places.get(array.name, ()))

    def read(self, array: str, element: str) -> Expression:
        """Return an element of an input array, converted to the arithmetic."""
        return converted(Expression(element), self.formats.of(array), self.arithmetic)

    def written(self, array: str, expression: Expression) -> Expression:
        """Return a value converted to the precision of an output array."""
        stored = self.formats.of(array)
        return notation(stored).whole(converted(expression, self.arithmetic, stored))

    def number_in(self, array: str, number: Any) -> str:
        """Return a constant as an output array holds it, rounded once to the coarser precision."""
        stored = self.formats.of(array)
        coarser = min(self.arithmetic, stored, key=lambda precision: precision.significand_bits)
        text = notation(stored).text(converted(literal(number, coarser), coarser, stored))
        return self.everywhere(text)

    def everywhere(self, text: str) -> str:
        """Return an expression that is the same in all states as one of type `number`."""
        return text

    def condition(self, text: str, place: int) -> str:
        """Return the statement that tests a value; the first value that is not positive sets the status."""
        return f"if (!failed && !({self.notation.positive(text)})) {{ failed = {place}; }}"

    def margin(self, value: Expression, place: int) -> str:
        """Return the statement that tests a value required positive for accuracy; the least counts."""
        rounded = converted(value, self.arithmetic, self.arithmetic if self._is_ordered else DOUBLE)
        return (
            f"if (!({rounded} > least_margin) && least_margin == least_margin) "
            f"{{ least_margin = {rounded}; inaccurate = -{place}; }}"
        )

    @property
    def _is_ordered(self) -> bool:
        """Whether < is an operator on numbers of the arithmetic."""
        return type(self.notation) is Notation

    def opening(self, has_margins: bool) -> list[str]:
        """Return the first lines of a function that tests values.

        Args:
            has_margins: Whether the function also tests values required positive for accuracy.
        """
        if not has_margins:
            return ["    int failed = 0;"]
        kind = self.arithmetic if self._is_ordered else DOUBLE
        return [
            "    int failed = 0, inaccurate = 0;",
            f"    {kind.c_type} least_margin = {kind.literal(0.0)};",
        ]

    def closing(self, may_fail: Sequence[Array], has_margins: bool) -> list[str]:
        """Return the last lines of a function that tests values, before it returns: NaN on failure.

        Args:
            may_fail: Outputs that hold NaN where a condition fails.
            has_margins: As for `opening`.
        """
        lines = []
        for array in may_fail:
            lines += [
                f"    for (int i = 0; failed && i < {array.size}; ++i) {{",
                f"        {array.name}[i] = {notation(self.formats.of(array.name)).nothing};",
                "    }",
            ]
        return lines

    def tested(self, has_margins: bool) -> str:
        """Return the expression of the status that the tests of a function give."""
        return "failed ? failed : inaccurate" if has_margins else "failed"

    def all_finite(self, run: Run) -> str:
        """Return the condition that every number in a run of an output array is finite."""
        first = f"&{self.element(run.array, run.start)}" if run.start else run.array.name
        return f"{finite_test(self.formats.of(run.array.name))}({first}, {run.stop - run.start})"


@dataclass(frozen=True)
class SimdDialect(Dialect):
    """Functions for several states in SIMD lanes, with the types and functions of kanegen_simd.h.

    Attributes:
        joins_parts: Whether a compiler joins the parts of a function where there are many vector registers.
    """

    joins_parts: bool = False

    @property
    def is_scalar(self) -> bool:
        """False: every value of type `number` holds one number for each of several states."""
        return False

    @property
    def number(self) -> str:
        """Type of a value that differs between states."""
        return "simd"

    @property
    def reserved(self) -> frozenset[str]:
        """Names that no local may take."""
        functions = {f"simd_{name}" for name in (*FUNCTIONS, "sincos", "of", "positive")}
        return super().reserved | functions | _RESERVED_SIMD

    @property
    def vector_sincos(self) -> str:
        """Name of the function that computes sines and cosines of several coordinates in all lanes."""
        return "simd_sincos"

    @property
    def spread(self) -> int:
        """One element for each angle: another would take the time of an angle."""
        return 1

    @property
    def has_columns_in_lanes(self) -> bool:
        """False: the lanes hold several states already."""
        return False

    @property
    def has_sincos(self) -> bool:
        """True: one call gives sine and cosine in all lanes."""
        return True

    @property
    def status(self) -> str:
        """Type that a function returns if its outputs may fail: one bit pattern a lane."""
        return "simd_bits"

    def function(self, op: Op, everywhere: bool) -> str:
        """Return the name of the function for `op`; a value that is the same everywhere needs no lanes."""
        return super().function(op, everywhere) if everywhere else f"simd_{op.value}"

    def sincos(self, angle: str, sine: str, cosine: str) -> str:
        """Return the call that sets `sine` and `cosine` to those of `angle` in all lanes."""
        return f"simd_sincos(1, &{angle}, &{sine}, &{cosine});"

    def everywhere(self, text: str) -> str:
        """Return an expression that is the same in all states as one of type `number`."""
        return f"simd_of({text})"

    @property
    def _linkage(self) -> str:
        """Linkage of the parts of functions."""
        return "SIMD_PART" if self.joins_parts else super()._linkage

    def condition(self, text: str, place: int) -> str:
        """Return the statement that tests a value in every lane."""
        return f"valid &= simd_positive({text});"

    def margin(self, value: Expression, place: int) -> str:
        """Return the statement that tests a value required positive for accuracy in every lane."""
        return f"within_margin &= simd_positive({value});"

    def opening(self, has_margins: bool) -> list[str]:
        """Return the first lines of a function that tests values."""
        lines = ["    simd_bits valid = ~(simd_bits){0};"]
        return [*lines, "    simd_bits within_margin = ~(simd_bits){0};"] if has_margins else lines

    def closing(self, may_fail: Sequence[Array], has_margins: bool) -> list[str]:
        """Return the last lines of a function that tests values, before it returns; its caller writes NaN."""
        return ["    *accurate = within_margin;"] if has_margins else []

    def tested(self, has_margins: bool) -> str:
        """Return the expression of the lanes in which all results exist."""
        return "valid"


SCALAR = Dialect(Formats(), DOUBLE)
"""One state in double precision."""

SIMD = SimdDialect(Formats(), DOUBLE)
"""Several states in double precision."""


def scalar(
    formats: Formats,
    arithmetic: Precision | None = None,
    kanegen_sincos: bool = False,
    places: Mapping[str, Sequence[str]] = NO_NAMES,
    has_lanes: bool = True,
    in_pieces: bool = False,
) -> Dialect:
    """Return the dialect for one state, which computes in the arithmetic of `formats` by default."""
    return Dialect(formats, arithmetic or formats.arithmetic, kanegen_sincos, places, has_lanes, in_pieces)


def simd(
    precision: Precision = DOUBLE,
    kanegen_sincos: bool = False,
    places: Mapping[str, Sequence[str]] = NO_NAMES,
    in_pieces: bool = False,
    joins_parts: bool = False,
) -> SimdDialect:
    """Return the dialect for several states in SIMD lanes of one precision."""
    return SimdDialect(
        uniform(precision), precision, kanegen_sincos, places, in_pieces=in_pieces, joins_parts=joins_parts
    )
