"""The likeliest meaning of a misspelt word."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def did_you_mean(word: object, known: Iterable[str]) -> str:
    """A sentence that names the nearest known word or, where none is near, all of them."""
    words = list(known)
    near = difflib.get_close_matches(str(word), words, n=1)
    if near:
        return f"Did you mean {near[0]!r}?"
    return f"Known are {', '.join(map(repr, words))}." if words else "None is known."
