"""Units of FMI: an SI unit as exponents of the base units."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping

from kanegen.errors import OptionError, quoted

_BASE: Mapping[str, Mapping[str, int]] = {
    "1": {},
    "kg": {"kg": 1},
    "m": {"m": 1},
    "s": {"s": 1},
    "rad": {"rad": 1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
}
"""Exponents of the base units of FMI in each unit that kanegen's arrays have."""

_FACTOR = re.compile(r"([A-Za-z]+|1)(?:\^(\d+))?")


def exponents(unit: str) -> dict[str, int]:
    """Return the exponents of the base units in a unit, without those that are 0.

    Args:
        unit: Units with blanks between them and at most one stroke, such as "kg m^2/s" or "1/(kg m)".

    Raises:
        OptionError: If the text is no such unit.

    Example:
        exponents("N m")  # {"kg": 1, "m": 2, "s": -2}
    """
    found: Counter[str] = Counter()
    for sign, part in zip((1, -1), unit.split("/"), strict=False):
        for factor in part.strip().removeprefix("(").removesuffix(")").split():
            match = _FACTOR.fullmatch(factor)
            if match is None or match[1] not in _BASE:
                raise OptionError(f"fmi: {quoted(unit)} is no unit that FMI could be told.")
            for base, exponent in _BASE[match[1]].items():
                found[base] += sign * exponent * int(match[2] or 1)
    return {base: exponent for base, exponent in found.items() if exponent}
