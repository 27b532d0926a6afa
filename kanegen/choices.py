"""Checks of names that a user chooses among, with error messages that suggest the nearest known name."""

from __future__ import annotations

import difflib
import re
from collections.abc import Collection, Iterable
from itertools import zip_longest
from typing import Any

from kanegen.errors import OptionError, quoted

MOST_NAMED = 30
"""Largest number of known names that a message lists."""

LONGEST_WORD = 200
"""Number of characters beyond which a word is not compared with the known names."""

ALIKE = 0.65
"""Least likeness, as `difflib` measures it, of a part of a name and a misspelt form of it."""


def did_you_mean(word: object, known: Iterable[str]) -> str:
    """Return a sentence that names the known word of which `word` is a misspelt form, or else all of them.

    Where several are equally near it names each of these, of vjp, jvp and hvp for vpj those with its letters.

    Names that differ in a number, such as theta4 and theta3, or in a whole part, such as forward_dynamics and
    inverse_dynamics, mean different things, so neither is proposed for the other.
    """
    words = list(dict.fromkeys(known))
    text = word if isinstance(word, str) else quoted(word)
    likenesses = [_likeness(text, one) for one in words]
    if nearest := max(likenesses, default=0.0):
        near = [one for one, likeness in zip(words, likenesses, strict=True) if likeness == nearest]
        near = [one for one in near if sorted(one) == sorted(text)] or near
        return f"Did you mean {' or '.join(map(quoted, near))}?"
    part_of = sorted((one for one in words if _is_part(text, one)), key=len)
    if part_of and all(_is_part(part_of[0], one) for one in part_of[1:]):
        return f"Did you mean {quoted(part_of[0])}?"
    if not words:
        return "None is known."
    further = len(words) - MOST_NAMED
    more = f", and {further} more" if further > 0 else ""
    return f"Known are {', '.join(map(quoted, words[:MOST_NAMED]))}{more}."


def _likeness(word: str, known: str) -> float:
    """Return how much a word looks like a misspelt form of a known one, from 0 to 1."""
    if max(len(word), len(known)) > LONGEST_WORD or _NUMBER.findall(word) != _NUMBER.findall(known):
        return 0.0
    letters = _NO_LETTERS.sub("", word.lower())
    if letters and letters == _NO_LETTERS.sub("", known.lower()):
        return 1.0
    pairs = list(zip_longest(_parts(word), _parts(known), fillvalue=""))
    likenesses = [difflib.SequenceMatcher(None, a, b).ratio() for a, b in pairs if a != b]
    alike = all(min(len(a), len(b)) > 1 for a, b in pairs if a != b)
    likeness = min(likenesses, default=0.0)
    return likeness if alike and likeness >= ALIKE else 0.0


def _is_part(word: str, known: str) -> bool:
    """Return whether a word is the beginning or the end of a known one that has further parts."""
    parts, all_parts = _parts(word), _parts(known)
    count = len(parts)
    return 0 < count < len(all_parts) and parts in (all_parts[:count], all_parts[-count:])


def _parts(name: str) -> list[str]:
    """Return the parts of a name between dots, blanks, hyphens and underscores, in lower case."""
    return [part for part in _SEPARATOR.split(name.lower()) if part]


_NUMBER = re.compile(r"\d+")
_SEPARATOR = re.compile(r"[\s._:/-]+")
_NO_LETTERS = re.compile(r"[\W_]+")


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


def known_spelling(value: Any, known: Iterable[str]) -> Any:
    """Return the known name that differs in nothing but capitals, blanks, hyphens and underscores.

    Anything else comes back as it is, for `require_one` to refuse.

    Example:
        known_spelling("implicit midpoint", ["implicit_midpoint"])  # "implicit_midpoint"
    """
    if not isinstance(value, str) or len(value) > LONGEST_WORD:
        return value
    return next((one for one in known if _parts(one) == _parts(value)), value)


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
