"""Equations as LaTeX for notebooks: matrices whole where they fit a line, else entry by entry.

    display([*matrix("[A]", "A", form.A, names, "equations.A", symmetric=True)])

What is too long is cut, with the Python that gives the rest. Notebooks show LaTeX by MathJax, and
the site by MathML, so that only commands of amsmath occur that both have.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence

from sympy import Expr, ImmutableMatrix, Symbol

from kanegen.symbolic import notation
from kanegen.symbolic.printers import latex, latex_lines, latex_matrix, matrix_width

LINE = 76
"""Width in characters after which a long sum continues in the next line: a notebook beside its margins."""

MOST_ENTRIES = 36
"""Number of entries up to which a matrix may be shown whole."""

MOST_LINES = 24
"""Number of lines up to which the entries of a matrix are shown."""

MOST_LINES_OF_ENTRY = 3
"""Number of lines up to which an entry is shown where there is no room for all."""

_SPECIAL = {
    **{character: f"\\{character}" for character in "{}_&%$#"},
    "\\": r"\backslash ",
    "^": r"\wedge ",
    "~": r"\sim ",
    "<": r"\lt ",
}
"""LaTeX of formulas for characters that MathJax does not show within text."""

_LARGER = re.compile(r"\\big[lr](?![A-Za-z])")
"""Commands that make a bracket larger."""

_PARTS = re.compile(rf"[{re.escape(''.join(_SPECIAL))}]|[^{re.escape(''.join(_SPECIAL))}]+")
"""Special characters, and the words between them."""


def display(lines: Iterable[str]) -> str:
    """Return lines of LaTeX, each with an & where they are aligned, as one formula of a notebook.

    Brackets keep the size of letters: what converts LaTeX to MathML loses the lines between larger ones.
    """
    body = _LARGER.sub("", " \\\\\n".join(lines)).replace("<", r"\lt ")
    return f"$$\n\\begin{{aligned}}\n{body}\n\\end{{aligned}}\n$$"


def matrix(
    name: str,
    letter: str,
    value: ImmutableMatrix,
    names: Mapping[Symbol, str],
    hint: str,
    symmetric: bool = False,
) -> Iterator[str]:
    """Yield the lines of a matrix or column: whole if it fits a line, else its entries that are not zero.

    Args:
        name: The matrix in the notation of the notes, such as "[A]".
        letter: Its letter in LaTeX, of which entries are indexed.
        value: The matrix.
        names: LaTeX of the symbols in it.
        hint: Python that gives the whole matrix.
        symmetric: Whether the entries below the diagonal are left out where it is shown by entries.
    """
    if len(value) <= MOST_ENTRIES and matrix_width(value, names) <= LINE:
        yield f"{notation.latex(name)} &= {latex_matrix(value, names)}"
        return
    rows, columns = value.shape
    places = [(i, j) for i in range(rows) for j in range(i if symmetric else 0, columns) if value[i, j] != 0]
    yield rf"{notation.latex(name)} &\in \mathbb{{R}}^{{{rows} \times {columns}}}, \text{{ with}}"
    left = MOST_LINES
    for count, (entry, (i, j)) in enumerate(zip(_entries(value, places, names), places, strict=True)):
        left -= len(entry)
        if left < 0:
            yield cut(len(places) - count, "entries that are not zero", hint)
            return
        index = f"{i + 1}" if columns == 1 else f"{i + 1},{j + 1}"
        yield f"{letter}_{{{index}}} &= {entry[0]}"
        yield from (f"&\\quad {line}" for line in entry[1:])


def _entries(
    value: ImmutableMatrix, places: Sequence[tuple[int, int]], names: Mapping[Symbol, str]
) -> Iterator[list[str]]:
    """Yield the lines of entries in order: whole if there is room for all of them, else long ones cut."""
    room = MOST_LINES
    found: list[list[str]] = []
    for i, j in places:
        found.append(latex_lines(value[i, j], names, LINE))
        room -= len(found[-1])
        if room < 0:
            break
    else:
        yield from found
        return
    yield from map(_shortened, found)
    for i, j in places[len(found) :]:
        yield _shortened(latex_lines(value[i, j], names, LINE))


def equation(name: str, value: Expr, names: Mapping[Symbol, str], hint: str) -> Iterator[str]:
    """Yield the lines of a quantity; `name` is in plain text and `hint` is Python that gives the quantity."""
    first, *others = latex_lines(value, names, LINE)
    yield f"{words(name)} &= {first}"
    yield from (f"&\\quad {line}" for line in others[: MOST_LINES - 1])
    if len(others) >= MOST_LINES:
        yield cut(len(others) - MOST_LINES + 1, "lines", hint)


def conditions(positive: Iterable[Expr], names: Mapping[Symbol, str]) -> Iterator[str]:
    """Yield a line for each expression that must be positive."""
    yield from (rf"&\text{{where }} {latex(one, names)} > 0" for one in positive)


def cut(left_out: int, what: str, hint: str) -> str:
    """Return the line that says what is left out, and the Python that gives it."""
    return "&" + words(f"… {left_out} more {what}: {hint}")


def words(text: str) -> str:
    """Return text within a formula, its special characters outside of the words."""
    parts = (_SPECIAL.get(part) or rf"\text{{{part}}}" for part in _PARTS.findall(text))
    return "".join(parts)


def _shortened(lines: list[str]) -> list[str]:
    """Return the first lines of an entry, and how many more it has."""
    rest = len(lines) - MOST_LINES_OF_ENTRY
    if rest < 2:
        return lines
    return [*lines[:MOST_LINES_OF_ENTRY], rf"+ \ldots \text{{ ({rest} more lines)}}"]
