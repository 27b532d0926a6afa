"""The notation of the notes: plain text such as `[^1R_2]{ω̂'_1} + {ω̂'_2}`, and the LaTeX that follows from it.

A symbol is a letter with accents, primes, an index before it, one below and one above. Text is the source;
LaTeX is derived from it, so that prose and equations in all formats have the same names.
"""

from __future__ import annotations

import re
import unicodedata

WIDTH = 92
"""Number of visible characters in a line of LaTeX."""

_ACCENTS = {"\u0302": r"\hat", "\u0303": r"\tilde", "\u0307": r"\dot", "\u0308": r"\ddot"}
"""Commands of LaTeX by combining character, the innermost first: a rate is that of a hatted letter."""

_GREEK = {
    "\u03b1": r"\alpha",
    "ε": r"\epsilon",
    "θ": r"\theta",
    "τ": r"\tau",
    "ω": r"\omega",
    "Σ": r"\sum",
}

_SYMBOL = re.compile(
    r"(?P<before>\^\w+)?"
    rf"(?P<letter>[^\W\d_])(?P<accents>[{''.join(_ACCENTS)}]*)"
    r"(?P<primes>'*)"
    r"(?:_(?P<below>\{[^{}]*\}|\w+(?:,\w+)*))?"
)
_SCRIPT = re.compile(r"\^(-?\w+)|_\{(\d+)x(\d+)\}|(?P<brace>[{}])|(?P<space> )")
_PART = re.compile(r"([A-Za-z]+)(\w*)")


def latex(text: str) -> str:
    r"""Return a formula in LaTeX.

    Args:
        text: The formula in plain text.

    Example:
        latex("[^1R_2]{p'_O1}")  # r"[{}^{1}R_{2}]\lbrace p'_{O_{1}}\rbrace "
    """
    plain = unicodedata.normalize("NFD", text)
    found, place = [], 0
    while place < len(plain):
        if match := _SYMBOL.match(plain, place):
            found.append(_symbol(match))
        elif match := _SCRIPT.match(plain, place):
            found.append(_script(match))
        else:
            found.append(plain[place])
        place = match.end() if match else place + 1
    return "".join(found)


def _symbol(match: re.Match[str]) -> str:
    """Return a letter with everything around it in LaTeX."""
    printed = _GREEK.get(match["letter"], match["letter"])
    for accent in sorted(match["accents"], key=list(_ACCENTS).index):
        printed = rf"{_ACCENTS[accent]}{{{printed}}}"
    before = rf"{{}}^{{{match['before'][1:]}}}" if match["before"] else ""
    below = ",".join(map(_index, match["below"].strip("{}").split(","))) if match["below"] else ""
    ends_in_command = re.search(r"\\[a-z]+$", printed) and not below and not match["primes"]
    return (
        before + printed + " " * bool(ends_in_command) + match["primes"] + (f"_{{{below}}}" if below else "")
    )


def _index(part: str) -> str:
    """Return a part of an index in LaTeX, such as G_{3} for G3."""
    match = _PART.fullmatch(part)
    if not match or (match[1].isupper() and len(match[1]) == 1 and not match[2]) or match[1].islower():
        return part if not match or not match[2] else f"{match[1]}_{{{match[2]}}}"
    letter, rest = match[1][0], match[1][1:] + match[2]
    return f"{letter}_{{{rest}}}"


def _script(match: re.Match[str]) -> str:
    """Return an exponent, a size such as 3x24, a brace or a space in LaTeX."""
    if match["brace"]:
        return r"\lbrace " if match["brace"] == "{" else r"\rbrace "
    if match["space"]:
        return " "
    return f"^{{{match[1]}}}" if match[1] else rf"_{{{match[2]}\times {match[3]}}}"


def lines(text: str, width: int = WIDTH) -> list[str]:
    """Return a formula in plain text, broken before signs and after commas where it is wider than a line."""
    found: list[str] = []
    for word in re.split(r" (?=[+-] )|(?<=,) ", text):
        joined = f"{found[-1]} {word}" if found else word
        if found and visible(joined) <= width:
            found[-1] = joined
        else:
            found.append(word)
    return found


def visible(text: str) -> int:
    """Return how many characters of a formula in plain text a reader sees beside each other."""
    plain = unicodedata.normalize("NFD", text)
    return len(re.sub(rf"[_^' {''.join(_ACCENTS)}]", "", plain)) + plain.count(" + ") + plain.count(" - ")
