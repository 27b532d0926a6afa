"""Differences between plain data: the statements of a certificate and what is derived again."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

TOLERANCE = 1e-6
"""Relative difference up to which two measured numbers are the same.

Exact results are known to 2^-20 of a roundoff, and condition numbers to the rounding of an eigenvalue.
"""


def differences(place: str, stated: Any, derived: Any) -> Iterator[str]:
    """Yield a text for every place where two structures of mappings, lists, texts and numbers differ.

    Floating-point numbers are the same if they agree to `TOLERANCE`; everything else must be equal and of the
    same type. The order of the members of mappings does not matter.

    Args:
        place: Name of the place of the structures, the beginning of every text.
        stated: The structure as it was read.
        derived: The structure as it should be.

    Example:
        >>> list(differences("claim", {"error": 1e-9}, {"error": 1e-6}))
        ["claim.error is 1e-09, derived 1e-06"]
    """
    if isinstance(stated, Mapping) and isinstance(derived, Mapping):
        for name in dict.fromkeys([*derived, *stated]):
            if name not in stated:
                yield f"{place}.{name} is missing"
            elif name not in derived:
                yield f"{place}.{name} has no place here"
            else:
                yield from differences(f"{place}.{name}", stated[name], derived[name])
    elif isinstance(stated, list) and isinstance(derived, list | tuple) and len(stated) == len(derived):
        for number, pair in enumerate(zip(stated, derived, strict=True)):
            yield from differences(f"{place}[{number}]", *pair)
    elif not _are_equal(stated, derived):
        yield f"{place} is {_short(stated)}, derived {_short(derived)}"


def _are_equal(stated: Any, derived: Any) -> bool:
    """Return whether two values that are no structures of the same kind are the same."""
    if type(stated) is not type(derived):
        return False
    if isinstance(stated, float) and math.isfinite(stated):
        return bool(abs(stated - derived) <= TOLERANCE * abs(derived))
    return bool(stated == derived)


def _short(value: Any) -> str:
    """Return a value as a text of at most some 60 characters."""
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:56]} ..."
