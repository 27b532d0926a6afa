"""Tables of a model file, and which keys they may have."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from kanegen.choices import did_you_mean
from kanegen.errors import ModelError

Table = Mapping[str, Any]

ORIGIN = (0, 0, 0)
"""Where a position is left out (m)."""


def check_keys(table: Table, known: Sequence[str], required: Sequence[str] = (), what: str = "") -> None:
    """Make sure that a table has no key but `known` ones, and all that are `required`.

    Raises:
        ModelError: If it does not; begins with `what`.
    """
    for key in table:
        if key not in known:
            raise ModelError(f"{what}unknown key {key!r}. {did_you_mean(key, known)}")
    for key in required:
        if key not in table:
            raise ModelError(f"{what}{key} is missing.")
