"""The legend of the names in generated code: the patterns that occur in it, with their meanings.

`meanings` has the tables of patterns. Here their placeholders become regular expressions, and a legend shows
the patterns without braces.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache, cached_property

from kanegen.recursion.meanings import (
    FREEDOMS,
    MARKS,
    NAMES,
    PLACES,
    TURN_STEPS,
    TURNED,
    TURNED_WHOLE,
    WHOLE_TURN_STEPS,
)


def _turning() -> Iterator[tuple[str, str]]:
    """Yield the intermediates of turns of matrices."""
    symmetric = ((matrix, "{xx}", TURN_STEPS) for matrix in TURNED)
    others = ((matrix, "{x}_{y}", WHOLE_TURN_STEPS) for matrix in TURNED_WHOLE)
    for matrix, entry, steps in (*symmetric, *others):
        parts = (f"{matrix}_{{i}}", f"{matrix}_{{i}}_{{i}}")
        for part in parts:
            yield f"{part}_{entry}", f"{shown(matrix)} on its way through several turns, below turn i"
        for name in (matrix, *parts):
            for ending, meaning in steps:
                yield f"{name}{ending}", meaning.replace("{0}", shown(name))


_PLACE = r"\d+(?:j|o|a\d?u?|c\du?|tu?)?"
_FREEDOM = r"\d+(?:a\d|s\d+|t\d|w\d|r\d+|y\d+)"
_PLACEHOLDERS = {
    "{K}": r"\d+",
    "{J}": r"\d+",
    "{n}": r"\d+",
    "{m}": r"\d+",
    "{0}": "0",
    "{i}": r"\d",
    "{ij}": r"\d\d",
    "{P}": f"(?P<place>{_PLACE})",
    "{L}": f"(?P<freedom>{_FREEDOM})",
    "{x}": "[xyz]",
    "{y}": "[xyz]",
    "{xx}": "(?:xx|yy|zz|xy|xz|yz)",
    "{name}": r"\w+",
}
"""Regular expression of each placeholder."""


def shown(pattern: str) -> str:
    """Return a pattern as a legend shows it, without braces."""
    return pattern.replace("{", "").replace("}", "")


def expression(pattern: str) -> re.Pattern[str]:
    """Return the regular expression of a pattern."""
    parts = re.split(r"(\{\w+\})", pattern)
    return re.compile("".join(_PLACEHOLDERS.get(part, re.escape(part)) for part in parts))


@dataclass(frozen=True)
class Entry:
    """One line of a legend.

    Attributes:
        pattern: Pattern of names, with placeholders in braces.
        meaning: What the names mean.
    """

    pattern: str
    meaning: str

    @cached_property
    def regex(self) -> re.Pattern[str]:
        """The regular expression of the names."""
        return expression(self.pattern)

    @property
    def line(self) -> tuple[str, str]:
        """The line as a legend shows it."""
        return shown(self.pattern), self.meaning


@dataclass(frozen=True)
class Legend:
    """The meanings of the names in some code; every line applies to at least one name.

    Attributes:
        names: Patterns of names and meanings.
        places: Patterns of the values of P, and meanings.
        freedoms: Patterns of the values of L, and meanings.
        unknown: Names that no pattern fits.
    """

    names: tuple[tuple[str, str], ...]
    places: tuple[tuple[str, str], ...]
    freedoms: tuple[tuple[str, str], ...]
    unknown: tuple[str, ...]


@cache
def entries() -> tuple[Entry, ...]:
    """Return every entry of names, in the order in which they are tried."""
    after = [pattern for pattern, _ in NAMES].index("Ic_{P}_{xx}") + 1
    return tuple(Entry(*entry) for entry in (*NAMES[:after], *_turning(), *NAMES[after:]))


@cache
def _entries_from(letter: str) -> tuple[Entry, ...]:
    """Return the entries that may explain names with a first letter, in the order in which they are tried."""
    return tuple(entry for entry in entries() if entry.pattern[0] in (letter, "{"))


_PLACE_ENTRIES = tuple(Entry(*entry) for entry in PLACES)
_FREEDOM_ENTRIES = tuple(Entry(*entry) for entry in FREEDOMS)
_MARKS = tuple((Entry(*entry), re.compile(f"_*{expression(entry[0]).pattern}$")) for entry in MARKS)


def legend(names: Iterable[str]) -> Legend:
    """Return the legend of the names that occur in some code."""
    used: set[Entry] = set()
    unknown: list[str] = []
    for name in sorted(set(names)):
        found = _explained(name)
        used.update(found)
        if not found:
            unknown.append(name)

    def lines(among: Iterable[Entry]) -> tuple[tuple[str, str], ...]:
        return tuple(entry.line for entry in among if entry in used)

    marks = (mark for mark, _ in _MARKS)
    return Legend(
        (*lines(entries()), *lines(marks)), lines(_PLACE_ENTRIES), lines(_FREEDOM_ENTRIES), tuple(unknown)
    )


def meaning_at_places(name: str) -> str:
    """Return the meaning of a name that says at which places its freedoms are, with their numbers; or "".

    Example:
        meaning_at_places("D_3i")  # "1 over the pivot of the freedom at place 3"
    """
    entry = next((entry for entry in _entries_from(name[0]) if entry.regex.fullmatch(name)), None)
    if entry is None or "at place" not in entry.meaning:
        return ""
    letters, numbers = re.findall(r"{(\w+)}", entry.pattern), re.findall(r"\d+", name)
    places = dict(zip(letters, numbers, strict=False))
    return re.sub(r"at place (\w)\b", lambda m: f"at place {places.get(m[1], m[1])}", entry.meaning)


def _explained(name: str) -> list[Entry]:
    """Return the entries that explain a name, its place and its marks; [] if there is none."""
    for entry in _entries_from(name[0]):
        if match := entry.regex.fullmatch(name):
            found = [entry]
            parts = match.groupdict()
            for group, among in (("place", _PLACE_ENTRIES), ("freedom", _FREEDOM_ENTRIES)):
                part = parts.get(group)
                found += [one for one in among if part and one.regex.fullmatch(part)]
            return found
    for mark, ending in _MARKS:
        if (match := ending.search(name)) and match.start() > 0:
            inner = _explained(name[: match.start()])
            if inner:
                return [*inner, mark]
    return []
