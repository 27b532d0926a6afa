"""Factors of base parameters that change with run-time parameters, written in these where they are products.

A factor such as 1 m may be the default of a length. It is found as one of the factors that differ between
several values of the parameters. Where it is a product of powers of parameters with a number, which two
values of each parameter show, it is written so, as "l1**2"; any other keeps its number at the defaults.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kanegen.model.arrays import Floats

SAME = 1e-8
"""Relative difference up to which two factors, or a power and a whole number, are the same."""

HIGHEST = 4
"""Largest power of a parameter that is looked for; inertias have squares of lengths."""


@dataclass(frozen=True)
class Factor:
    """A factor of an inertial parameter that changes with run-time parameters.

    Attributes:
        number: The number before `symbols`, or the whole factor at the defaults where `symbols` is "".
        symbols: The product of powers of parameters, such as "l1**2".
        parameters: Names of the parameters that change it.
    """

    number: float
    symbols: str
    parameters: tuple[str, ...]

    @property
    def text(self) -> str:
        """The factor without its sign, such as "2*l1" or, at the defaults, "1"."""
        size = f"{abs(self.number):.6g}"
        return f"{size}*{self.symbols}".removeprefix("1*") if self.symbols else size


def changing_factors(
    default: tuple[Floats, Sequence[float]],
    general: tuple[Floats, Sequence[float]],
    changed: Mapping[str, tuple[Floats, float]],
) -> dict[tuple[int, int], Factor]:
    """Return the factors in [K] that change with parameters, by row and column.

    Args:
        default: (b, 10 N) [K] for the defaults of all parameters, and these.
        general: [K] for other values, at which nothing vanishes by accident, and these.
        changed: By the name of each parameter, in the order of the values, [K] where it alone has another
            value than the general one, and this value.
    """
    tables = [matrix for matrix, _ in changed.values()]
    differs = [~np.isclose(table, general[0], rtol=SAME, atol=0.0) for table in tables]
    places = np.argwhere(np.any(differs, axis=0)).tolist()
    return {(i, j): _factor((i, j), default, general, changed) for i, j in places}


def _factor(
    place: tuple[int, int],
    default: tuple[Floats, Sequence[float]],
    general: tuple[Floats, Sequence[float]],
    changed: Mapping[str, tuple[Floats, float]],
) -> Factor:
    """Return the factor at a place of [K]; see `changing_factors`."""
    here, there = float(general[0][place]), float(default[0][place])
    powers: dict[str, int] = {}
    number, at_default = here, 1.0
    is_product = here != 0.0
    names = []
    values = zip(changed.items(), general[1], default[1], strict=True)
    for (name, (matrix, other)), value, usual in values:
        ratio = float(matrix[place]) / here if here else 0.0
        if here and abs(ratio - 1.0) <= SAME:
            continue
        names.append(name)
        power = np.log(ratio) / np.log(other / value) if ratio > 0 else 0.0
        whole = round(power)
        is_product &= 0 < whole <= HIGHEST and abs(power - whole) <= SAME
        if is_product:
            powers[name] = whole
            number /= value**whole
            at_default *= usual**whole
    if is_product and np.isclose(number * at_default, there, rtol=SAME, atol=0.0):
        symbols = "*".join(name if power == 1 else f"{name}**{power}" for name, power in powers.items())
        return Factor(number, symbols, tuple(names))
    return Factor(there, "", tuple(names))
