"""Sentences of a document in LaTeX or Markdown, with symbols as the equations have them."""

from __future__ import annotations

import re
from collections.abc import Callable

from kanegen.symbolic import notation
from kanegen.symbolic.printers import escaped

_SYMBOLS = {
    "[A]{ydot} = {f}": "[A]{ẏ} = {f}",
    "{xdot} = {y}": "{ẋ} = {y}",
    "{xdot}": "{ẋ}",
    "{ydot}": "{ẏ}",
    "FP_P_i": "F_PP,i",
    "MP_P_i": "M_PP,i",
    "F_K_i": "F'_K,i",
    "M_K_i": "M'_K,i",
    "S_K_i": "S_K,i",
    "C_K_i": "C_K,i",
    "h_K_1": "h_K",
}
"""Symbols in the notation of the notes, by the form that sentences in plain text have."""

_SYMBOL = re.compile(
    "|".join(map(re.escape, _SYMBOLS))
    + r"|(?:[\w']*\{[^{}\s]+\}|m_K(?=\[)|\[[^\][\s]*[^\W\d][^\][\s]*\])+|(?<!\w)[OGmQ]_[JK](?!\w)|\bx \d\b"
)


def prose(plain: str, escape: Callable[[str], str] = escaped) -> str:
    """Return a sentence in LaTeX or Markdown, with its symbols as formulas.

    Args:
        plain: The sentence in plain text.
        escape: What is done to everything else.

    Example:
        prose("[A] of Eq. (43)")  # "$[A]$ of Eq. (43)"
    """
    parts, place = [], 0
    for match in _SYMBOL.finditer(plain):
        parts += [escape(plain[place : match.start()]), _formula(match[0])]
        place = match.end()
    return "".join([*parts, escape(plain[place:])])


def _formula(symbol: str) -> str:
    """Return a symbol of a sentence as a formula."""
    if symbol.startswith("x "):
        return rf"$\times$ {symbol[2:]}"
    return f"${notation.latex(_SYMBOLS.get(symbol, symbol)).strip()}$"
