"""The precisions in which generated code can compute, by name: double, float, long double, double-double."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kanegen.choices import did_you_mean, is_among, require_one
from kanegen.errors import ModelError, OptionError, quoted
from kanegen.program.constants import DOUBLE_CONSTANTS, MULTIPRECISION, WIDE_CONSTANTS, Constants


@dataclass(frozen=True)
class Precision:
    """A floating-point format of C and its counterpart in NumPy.

    Attributes:
        name: Name of the option, such as "double-double".
        label: Name in a sentence, such as "single" before the word "precision".
        c_type: Type of a number in C.
        libm_suffix: Suffix of the functions of libm for this type, such as "f".
        dtype: NumPy's type of a number, or of each of its parts.
        bytes: Size of a number in bytes.
        significand_bits: Bits of the significand; the largest relative error of an operation is a few times
            `roundoff`.
        decimal_digits: Significant decimal digits that tell any two numbers apart.
        storage_names: Names of the precisions that arrays may have, the default first.
        required_properties: Properties of floating-point arithmetic, see `semantics.PROPERTIES`, without
            which the operations of this precision are wrong.
    """

    name: str
    label: str
    c_type: str
    libm_suffix: str
    dtype: np.dtype[Any]
    bytes: int
    significand_bits: int
    decimal_digits: int
    storage_names: tuple[str, ...] = ("double", "float", "long double")
    required_properties: frozenset[str] = frozenset()

    @property
    def roundoff(self) -> float:
        """The unit roundoff u, the largest relative error of one rounding."""
        return 2.0**-self.significand_bits

    @property
    def trailing_shape(self) -> tuple[int, ...]:
        """Axes that NumPy's arrays of such numbers have after the axes of the array in C."""
        return ()

    @property
    def has_simd(self) -> bool:
        """Whether there are SIMD vectors of such numbers."""
        return True

    @property
    def has_sincos(self) -> bool:
        """Whether a function of C returns sine and cosine together."""
        return False

    @property
    def constants(self) -> Constants:
        """The constants of a program before they are rounded."""
        return DOUBLE_CONSTANTS

    def c_function(self, name: str) -> str:
        """Return the name in C of `sin`, `cos` or `sqrt` for this type."""
        return f"{name}{self.libm_suffix}"

    def rounded(self, number: Any, name: str) -> float:
        """Return the nearest number of this precision, or of double where it is wider; 0 on underflow.

        Args:
            number: Any real number.
            name: Name of the number, used in the error message.

        Raises:
            ModelError: If `number` is beyond the largest number of this precision.
        """
        with np.errstate(over="ignore", under="ignore"):
            nearest = float(self.dtype.type(float(number)))
        if not math.isfinite(nearest):
            raise ModelError(
                f"{name}: {float(number)!r} leaves the range of {self.label} precision; choose units nearer "
                "to 1, or double precision."
            )
        return nearest

    def literal(self, number: Any) -> str:
        """Return a C literal of a number >= 0: the fewest digits that read back to the nearest number."""
        with np.errstate(under="ignore"):
            digits = np.format_float_scientific(self.dtype.type(float(number)))
        return f"{float(digits)!r}{self.libm_suffix}"

    def from_doubles(self, values: NDArray[np.float64]) -> NDArray[Any]:
        """Convert doubles to an array of this precision, rounding where it has fewer digits."""
        with np.errstate(over="ignore", under="ignore"):
            return values.astype(self.dtype)

    def to_doubles(self, values: NDArray[Any]) -> NDArray[np.float64]:
        """Convert an array of this precision to the nearest doubles."""
        return self.parts(values)[0]

    def parts(self, values: NDArray[Any]) -> tuple[NDArray[np.float64], ...]:
        """Return arrays of doubles whose exact sum is `values`; the first holds the nearest doubles."""
        return (values.astype(np.float64),)


@dataclass(frozen=True)
class LongDouble(Precision):
    """`long double`, which has at least 64 bits on machines where it is wider than double."""

    @property
    def has_simd(self) -> bool:
        """False: no processor has SIMD vectors of `long double`."""
        return False

    @property
    def constants(self) -> Constants:
        """Constants whose rotations have more digits than doubles."""
        return WIDE_CONSTANTS

    def literal(self, number: Any) -> str:
        """Return a C literal of a number >= 0, with at most the digits of the widest `long double`."""
        wide = MULTIPRECISION.mpf(number)
        return f"{MULTIPRECISION.nstr(wide, self.decimal_digits, strip_zeros=True)}L"

    def parts(self, values: NDArray[Any]) -> tuple[NDArray[np.float64], ...]:
        """Return three arrays of doubles whose exact sum is `values`."""
        found, rest = [], np.asarray(values, np.longdouble)
        for _ in range(3):
            found.append(rest.astype(np.float64))
            with np.errstate(invalid="ignore"):
                rest = rest - found[-1]
        return tuple(found)


@dataclass(frozen=True)
class DoubleDouble(LongDouble):
    """Unevaluated sums of two doubles; NumPy's arrays hold the two parts along a last axis."""

    @property
    def trailing_shape(self) -> tuple[int, ...]:
        """One axis for the high and the low part."""
        return (2,)

    @property
    def has_sincos(self) -> bool:
        """True: the header of this type defines such a function."""
        return True

    def c_function(self, name: str) -> str:
        """Return the name of `sin`, `cos` or `sqrt` in the header kanegen_double_double.h."""
        return f"dd_{name}"

    def literal(self, number: Any) -> str:
        """Return a C expression of a number >= 0 from its two parts, or from one if the other is 0."""
        high, low = double_double_parts(number)
        return f"dd_literal({high!r}, {low!r})" if low else f"dd_of({high!r})"

    def from_doubles(self, values: NDArray[np.float64]) -> NDArray[Any]:
        """Convert doubles to double-doubles whose low part is 0."""
        return np.stack([values, np.zeros_like(values)], axis=-1)

    def parts(self, values: NDArray[Any]) -> tuple[NDArray[np.float64], ...]:
        """Return the high and the low parts."""
        return values[..., 0], values[..., 1]


def double_double_parts(number: Any) -> tuple[float, float]:
    """Return the double nearest to a number, such as a fraction, and the double nearest to the rest."""
    high = float(number)
    return high, float(number - type(number)(high))


_DOUBLE = np.dtype(np.float64)

DOUBLE = Precision("double", "double", "double", "", _DOUBLE, 8, 53, 17)
FLOAT = Precision(
    "float", "single", "float", "f", np.dtype(np.float32), 4, 24, 9, ("float", "double", "long double")
)
LONG_DOUBLE = LongDouble(
    name="long double",
    label="long double",
    c_type="long double",
    libm_suffix="l",
    dtype=np.dtype(np.longdouble),
    bytes=16,
    significand_bits=64,
    decimal_digits=36,
    storage_names=("long double", "double", "float"),
    required_properties=frozenset({"subnormal numbers"}),  # no mode of its registers flushes them to zero
)
DOUBLE_DOUBLE = DoubleDouble(
    name="double-double",
    label="double-double",
    c_type="kanegen_double_double",
    libm_suffix="",
    dtype=_DOUBLE,
    bytes=16,
    significand_bits=106,
    decimal_digits=33,
    storage_names=("double", "double-double"),
    required_properties=frozenset(
        {
            "subnormal numbers",
            "products rounded by themselves",
            "order of sums",
            "rounding of quotients",
            "rounding of roots",
            "no excess precision",
        }
    ),
)

PRECISIONS = {precision.name: precision for precision in (DOUBLE, FLOAT, LONG_DOUBLE, DOUBLE_DOUBLE)}
"""All precisions, by the name of the option."""


_SINGLE = "single"
"""The name that users give single precision, after the tier."""


def precision_named(name: str) -> Precision:
    """Return the precision of that name.

    Raises:
        OptionError: If there is no precision of that name.
    """
    if not is_among(name, PRECISIONS):
        proposed = did_you_mean(name, (_SINGLE, *PRECISIONS))
        if proposed == f"Did you mean {quoted(_SINGLE)}?":
            raise OptionError(f"unknown precision {quoted(name)}. Single precision is {quoted(FLOAT.name)}.")
    require_one("precision", name, PRECISIONS)
    return PRECISIONS[name]


def storage_precision(precision: str, name: str = "") -> Precision:
    """Return the precision of arrays for code that computes in `precision`.

    Args:
        precision: Name of the precision of the arithmetic.
        name: Name of the precision of arrays; by default the one that belongs to the arithmetic.

    Raises:
        OptionError: If there is no such precision, or it does not go with `precision`.
    """
    allowed = precision_named(precision).storage_names
    found = precision_named(name or allowed[0])
    if found.name not in allowed:
        raise OptionError(
            f"storage {name!r} does not go with precision {precision!r}, which takes {', '.join(allowed)}."
        )
    return found
