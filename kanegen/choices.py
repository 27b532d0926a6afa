"""Checks of names that a user chooses among, with error messages that suggest the nearest known name."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Iterable
from typing import Any

from kanegen.errors import OptionError, quoted

MOST_NAMED = 30
"""Largest number of known names that a message lists."""

LONGEST_WORD = 200
"""Number of characters beyond which a word is not compared with the known names."""


def did_you_mean(word: object, known: Iterable[str]) -> str:
    """Return a sentence that names the known word nearest to `word`, or where none is near all of them."""
    words = list(known)
    text = word if isinstance(word, str) else quoted(word)
    near = difflib.get_close_matches(text, words, n=1) if len(text) <= LONGEST_WORD else []
    if near:
        return f"Did you mean {quoted(near[0])}?"
    if not words:
        return "None is known."
    further = len(words) - MOST_NAMED
    more = f", and {further} more" if further > 0 else ""
    return f"Known are {', '.join(map(quoted, words[:MOST_NAMED]))}{more}."


def is_among(value: object, known: Iterable[object]) -> bool:
    """Return whether a value of any type, also an array, is one of the known ones."""
    try:
        return value in tuple(known)
    except (TypeError, ValueError):  # as comparisons with arrays raise
        return False


def chosen(asked: object) -> tuple[Any, ...] | None:
    """Return one or several chosen items as a tuple; None if `asked` is neither a string nor a collection."""
    if isinstance(asked, str):
        return (asked,)
    try:
        return tuple(asked) if isinstance(asked, Iterable) else None
    except TypeError:  # an array without dimensions
        return None


def flag(option: str, value: object) -> bool:
    """Return whether an option is set.

    Raises:
        OptionError: If the value is an array or anything else that is neither true nor false.
    """
    try:
        return bool(value)
    except (TypeError, ValueError):
        raise OptionError(f"{option}: {quoted(value)} is not true or false.") from None


def require_one(label: str, value: object, known: Collection[object]) -> None:
    """Make sure that a value is known.

    Args:
        label: Kind of the value, such as "solver", used in the error message.
        value: The value that a user chose.
        known: All values that there are.

    Raises:
        OptionError: If the value is not known.
    """
    if isinstance(value, bool) or not is_among(value, known):
        raise OptionError(f"unknown {label} {quoted(value)}. {did_you_mean(value, map(str, known))}")


def several(option: str, label: str, asked: Iterable[str] | str, known: Collection[str]) -> tuple[str, ...]:
    """Return the names that a user chose, checked, each once, in the order in which they are known.

    Args:
        option: Name of the option, used in error messages.
        label: Kind of one name, such as "output", used in error messages.
        asked: The names, or a single one.
        known: All names that there are.

    Raises:
        OptionError: If a name is not known, or `asked` holds no names.
    """
    names = chosen(asked)
    if names is None:
        raise OptionError(f"{option}: expected names, got {quoted(asked)}. There are {', '.join(known)}.")
    for name in names:
        require_one(label, name, known)
    return tuple(name for name in known if name in names)
