"""Checks of names that a user chooses among, with error messages that suggest the nearest known name."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Iterable

from kanegen.errors import OptionError


def did_you_mean(word: object, known: Iterable[str]) -> str:
    """Return a sentence that names the known word nearest to `word` or, where none is near, all of them."""
    words = list(known)
    near = difflib.get_close_matches(str(word), words, n=1)
    if near:
        return f"Did you mean {near[0]!r}?"
    return f"Known are {', '.join(map(repr, words))}." if words else "None is known."


def require_one(label: str, value: object, known: Collection[object]) -> None:
    """Make sure that a value is known.

    Args:
        label: Kind of the value, such as "solver", used in the error message.
        value: The value that a user chose.
        known: All values that there are.

    Raises:
        OptionError: If the value is not known.
    """
    if isinstance(value, bool) or value not in tuple(known):
        raise OptionError(f"unknown {label} {value!r}. {did_you_mean(value, map(str, known))}")


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
    if not isinstance(asked, Iterable):
        raise OptionError(f"{option}: expected names, got {asked!r}. There are {', '.join(known)}.")
    names = (asked,) if isinstance(asked, str) else tuple(asked)
    for name in names:
        require_one(label, name, known)
    return tuple(name for name in known if name in names)
