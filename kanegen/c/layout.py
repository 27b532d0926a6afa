"""Line breaks of the generated C."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence

from kanegen.model.quoting import c_comment

WIDTH = 110
"""Columns of a generated line."""

BREAK = "\t"
"""Character in a text for `wrap` that becomes a space or the end of a line."""

HINGE = "\v"
"""Character in a text for `wrap` that becomes nothing, or the end of a line where no `BREAK` is near."""


def wrap(text: str, indent: str = "    ", hanging: str = "        ") -> list[str]:
    """Return lines of at most `WIDTH` columns, if `text` has enough places to break it.

    Args:
        text: With `BREAK` and `HINGE` where it may be broken.
        indent: Indentation of the first line.
        hanging: Indentation of the other lines.
    """
    lines: list[str] = []
    line, separator = indent, ""
    for space, fragment in _fragments(text, WIDTH - len(hanging)):
        glue = separator and space
        if separator and len(line) + len(glue) + len(fragment) > WIDTH:
            lines.append(line)
            line, glue = hanging, ""
        line += glue + fragment
        separator = " "
    return [*lines, line]


def _fragments(text: str, room: int) -> Iterator[tuple[str, str]]:
    """Yield the unbreakable fragments of a text, each with its separator from the fragment before it."""
    for chunk in text.split(BREAK):
        parts = chunk.split(HINGE)
        if len(chunk) - len(parts) + 1 <= room:
            parts = ["".join(parts)]
        yield " ", parts[0]
        for part in parts[1:]:
            yield "", part


def comment(text: str, indent: str = "    ") -> list[str]:
    """Return `text` as lines of a C comment, in which no part of the text can end the comment."""
    width = WIDTH - len(indent) - len("/*  */")
    lines = textwrap.wrap(c_comment(text), width, break_long_words=False) or [""]
    lines[1:] = [f"{indent}   {line}" for line in lines[1:]]
    lines[0] = f"{indent}/* {lines[0]}"
    lines[-1] += " */"
    return lines


def columns(rows: Sequence[Sequence[str]], width: int = WIDTH, gap: str = "  ") -> list[str]:
    """Return a table as lines with aligned columns, the last column wrapped; [] for an empty table."""
    if not rows:
        return []
    widths = [max(map(len, column)) for column in list(zip(*rows, strict=True))[:-1]]
    lines = []
    for *cells, last in rows:
        start = "".join(cell.ljust(length) + gap for cell, length in zip(cells, widths, strict=True))
        lines += textwrap.wrap(
            last or " ",
            width,
            initial_indent=start,
            subsequent_indent=" " * len(start),
            break_long_words=False,
            drop_whitespace=True,
        ) or [start.rstrip()]
    return lines
