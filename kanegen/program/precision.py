"""The precisions that there are, by name."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kanegen.choices import require_one
from kanegen.errors import ModelError, OptionError
from kanegen.program.constants import DOUBLES, WIDE, Constants


@dataclass(frozen=True)
class Precision:
    """A kind of real numbers in C.

    Attributes:
        name: What users call it.
        words: What it is called in a sentence.
        type: Its type in C.
        suffix: What functions of libm end in.
        dtype: NumPy's type of a number, or of its parts.
        bytes: Size of a number.
        digits: Bits of the significand; the largest relative error of an operation is a few times `roundoff`.
        decimals: Significant decimals that tell any two numbers apart.
        storages: Names of the precisions that arrays may have, its own default first.
        needs: Properties of `selftest.c` without which its operations are wrong.
    """

    name: str
    words: str
    type: str
    suffix: str
    dtype: np.dtype[Any]
    bytes: int
    digits: int
    decimals: int
    storages: tuple[str, ...] = ("double", "float", "long double")
    needs: frozenset[str] = frozenset()

    @property
    def roundoff(self) -> float:
        """The largest relative error of one rounding, u."""
        return 2.0**-self.digits

    @property
    def tail(self) -> tuple[int, ...]:
        """Further axes of NumPy's arrays."""
        return ()

    @property
    def has_lanes(self) -> bool:
        """Whether there are vectors of such numbers."""
        return True

    @property
    def takes_together(self) -> bool:
        """Whether a function of C gives sine and cosine at once."""
        return False

    @property
    def constants(self) -> Constants:
        """How exact what is computed before any state must be."""
        return DOUBLES

    def function(self, name: str) -> str:
        """What `sin`, `cos` and `sqrt` are called in C."""
        return f"{name}{self.suffix}"

    def rounded(self, number: Any, what: str) -> float:
        """The nearest number of this precision, or of double; below the smallest that is 0.

        Raises:
            ModelError: If it is beyond the largest.
        """
        with np.errstate(over="ignore", under="ignore"):
            nearest = float(self.dtype.type(float(number)))
        if not math.isfinite(nearest):
            raise ModelError(
                f"{what}: {float(number)!r} leaves the range of {self.words} precision; choose units nearer "
                "to 1, or double precision."
            )
        return nearest

    def literal(self, number: Any) -> str:
        """A number that is not negative in C: the fewest digits that read back to the nearest."""
        with np.errstate(under="ignore"):
            digits = np.format_float_scientific(self.dtype.type(float(number)))
        return f"{float(digits)!r}{self.suffix}"

    def stored(self, values: NDArray[np.float64]) -> NDArray[Any]:
        """Doubles as an array of this precision, rounded where it has fewer digits."""
        with np.errstate(over="ignore", under="ignore"):
            return values.astype(self.dtype)

    def nearest(self, values: NDArray[Any]) -> NDArray[np.float64]:
        """The nearest doubles of an array of this precision."""
        return self.parts(values)[0]

    def parts(self, values: NDArray[Any]) -> tuple[NDArray[np.float64], ...]:
        """Arrays of doubles whose exact sum an array of this precision is, the sum rounded first."""
        return (values.astype(np.float64),)


@dataclass(frozen=True)
class LongDouble(Precision):
    """`long double`, which has at least 64 bits where it is any wider than double."""

    @property
    def has_lanes(self) -> bool:
        """No."""
        return False

    @property
    def constants(self) -> Constants:
        """Wide."""
        return WIDE

    def literal(self, number: Any) -> str:
        """As many digits as the widest `long double` needs, or all where they are fewer."""
        wide = WIDE.functions
        return f"{wide.nstr(wide.mpf(number), self.decimals, strip_zeros=True)}L"

    def parts(self, values: NDArray[Any]) -> tuple[NDArray[np.float64], ...]:
        """As `Precision.parts`."""
        found, rest = [], np.asarray(values, np.longdouble)
        for _ in range(3):
            found.append(rest.astype(np.float64))
            with np.errstate(invalid="ignore"):
                rest = rest - found[-1]
        return tuple(found)


@dataclass(frozen=True)
class Pairs(LongDouble):
    """Sums of two doubles; NumPy's arrays have them along a last axis."""

    @property
    def tail(self) -> tuple[int, ...]:
        """The parts."""
        return (2,)

    @property
    def takes_together(self) -> bool:
        """Yes."""
        return True

    def function(self, name: str) -> str:
        """Those of kanegen_pairs.h."""
        return f"pair_{name}"

    def literal(self, number: Any) -> str:
        """The two parts; one where that is all."""
        high, low = split(number)
        return f"pair_literal({high!r}, {low!r})" if low else f"pair_of({high!r})"

    def stored(self, values: NDArray[np.float64]) -> NDArray[Any]:
        """Pairs whose second part is 0."""
        return np.stack([values, np.zeros_like(values)], axis=-1)

    def parts(self, values: NDArray[Any]) -> tuple[NDArray[np.float64], ...]:
        """As `Precision.parts`."""
        return values[..., 0], values[..., 1]


def split(number: Any) -> tuple[float, float]:
    """The pair of doubles nearest to a number, such as a fraction: the nearest one, and that to the rest."""
    high = float(number)
    return high, float(number - type(number)(high))


_DOUBLE = np.dtype(np.float64)

DOUBLE = Precision("double", "double", "double", "", _DOUBLE, 8, 53, 17)
FLOAT = Precision(
    "float", "single", "float", "f", np.dtype(np.float32), 4, 24, 9, ("float", "double", "long double")
)
LONG_DOUBLE = LongDouble(
    name="long double",
    words="long double",
    type="long double",
    suffix="l",
    dtype=np.dtype(np.longdouble),
    bytes=16,
    digits=64,
    decimals=36,
    storages=("long double", "double", "float"),
    needs=frozenset({"subnormal numbers"}),  # which no mode of its registers gives up
)
DOUBLE_DOUBLE = Pairs(
    name="double-double",
    words="double-double",
    type="kanegen_pair",
    suffix="",
    dtype=_DOUBLE,
    bytes=16,
    digits=106,
    decimals=33,
    storages=("double", "double-double"),
    needs=frozenset(
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
"""What can be asked for."""


def named(name: str) -> Precision:
    """The precision that is called `name`.

    Raises:
        OptionError: If there is none.
    """
    require_one("precision", name, PRECISIONS)
    return PRECISIONS[name]


def storage(precision: str, name: str = "") -> Precision:
    """The precision of arrays: `name`, or the own one of `precision` where there is none.

    Raises:
        OptionError: If there is no such precision, or it does not go with `precision`.
    """
    own = named(precision).storages
    found = named(name or own[0])
    if found.name not in own:
        raise OptionError(
            f"storage {name!r} does not go with precision {precision!r}, which takes {', '.join(own)}."
        )
    return found
