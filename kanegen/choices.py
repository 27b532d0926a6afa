"""Names that a user chooses among: one of them, or several."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Iterable

from kanegen.errors import OptionError


def did_you_mean(word: object, known: Iterable[str]) -> str:
    """A sentence that names the nearest known word or, where none is near, all of them."""
    words = list(known)
    near = difflib.get_close_matches(str(word), words, n=1)
    if near:
        return f"Did you mean {near[0]!r}?"
    return f"Known are {', '.join(map(repr, words))}." if words else "None is known."


def require_one(what: str, value: object, known: Collection[object]) -> None:
    """Make sure that `value` is known; `what` says what it is.

    Raises:
        OptionError: If it is not.
    """
    if isinstance(value, bool) or value not in tuple(known):
        raise OptionError(f"unknown {what} {value!r}. {did_you_mean(value, map(str, known))}")


def several(option: str, what: str, asked: Iterable[str] | str, known: Collection[str]) -> tuple[str, ...]:
    """Names checked, each once, in the order in which they are known.

    Args:
        option: What they are given to.
        what: What one of them is.
        asked: The names, or a single one.
        known: All that there are.

    Raises:
        OptionError: If one is not known.
    """
    if not isinstance(asked, Iterable):
        raise OptionError(f"{option}: expected names, got {asked!r}. There are {', '.join(known)}.")
    names = (asked,) if isinstance(asked, str) else tuple(asked)
    for name in names:
        require_one(what, name, known)
    return tuple(name for name in known if name in names)
