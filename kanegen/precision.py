"""The floating-point formats that code can be generated for."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from kanegen.errors import ModelError, OptionError
from kanegen.suggest import did_you_mean


@dataclass(frozen=True)
class Precision:
    """A floating-point format of C.

    Attributes:
        name: Its type in C, which is also what users call it.
        words: What it is called in a sentence.
        suffix: What literals and functions of libm end in.
        bytes: Size of a number.
        digits: Bits of the significand.
        decimals: Significant decimals that tell any two numbers apart.
    """

    name: str
    words: str
    suffix: str
    bytes: int
    digits: int
    decimals: int

    @property
    def dtype(self) -> np.dtype[Any]:
        """The type of NumPy arrays."""
        return np.dtype(f"f{self.bytes}")

    @property
    def roundoff(self) -> float:
        """The largest relative error of one rounding, u."""
        return 2.0**-self.digits

    def rounded(self, number: float, what: str) -> float:
        """The nearest number of this format; below the smallest that is 0.

        Raises:
            ModelError: If it is beyond the largest.
        """
        with np.errstate(over="ignore", under="ignore"):
            nearest = float(self.dtype.type(number))
        if not math.isfinite(nearest):
            raise ModelError(
                f"{what}: {number!r} leaves the range of {self.words} precision; choose units nearer to 1, "
                "or double precision."
            )
        return nearest

    def literal(self, number: float) -> str:
        """A number that is not negative in C: the fewest digits that read back to the nearest."""
        with np.errstate(under="ignore"):
            digits = np.format_float_scientific(self.dtype.type(number))
        return f"{float(digits)!r}{self.suffix}"


DOUBLE = Precision("double", "double", "", 8, 53, 17)
FLOAT = Precision("float", "single", "f", 4, 24, 9)

PRECISIONS = {precision.name: precision for precision in (DOUBLE, FLOAT)}
"""What can be asked for."""


def named(name: str) -> Precision:
    """The format that is called `name`.

    Raises:
        OptionError: If there is none.
    """
    if isinstance(name, str) and name in PRECISIONS:
        return PRECISIONS[name]
    raise OptionError(f"unknown precision {name!r}. {did_you_mean(name, PRECISIONS)}")
