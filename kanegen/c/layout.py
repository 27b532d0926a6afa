"""Line breaks of the generated C."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence

WIDTH = 110
"""Columns of a generated line."""

BREAK = "\t"
"""In a text for `wrap`: a space, or the end of a line."""

HINGE = "\v"
"""In a text for `wrap`: nothing, or the end of a line where no `BREAK` helps."""


def wrap(text: str, indent: str = "    ", hanging: str = "        ") -> list[str]:
    """Lines of at most `WIDTH` columns where `text` has enough places to break it.

    Args:
        text: With `BREAK` and `HINGE` where it may be broken.
        indent: What the first line begins with.
        hanging: What the other lines begin with.
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
    """What must stay together, each with what stands before it on the same line."""
    for chunk in text.split(BREAK):
        parts = chunk.split(HINGE)
        if len(chunk) - len(parts) + 1 <= room:
            parts = ["".join(parts)]
        yield " ", parts[0]
        for part in parts[1:]:
            yield "", part


def comment(text: str, indent: str = "    ") -> list[str]:
    """`text` as a comment of C; whatever it says, it cannot end the comment."""
    inner = text.replace("*/", "* /")
    lines = textwrap.wrap(inner, WIDTH - len(indent) - len("/*  */"), break_long_words=False) or [""]
    lines[1:] = [f"{indent}   {line}" for line in lines[1:]]
    lines[0] = f"{indent}/* {lines[0]}"
    lines[-1] += " */"
    return lines


def columns(rows: Sequence[Sequence[str]], width: int = WIDTH, gap: str = "  ") -> list[str]:
    """`rows` as lines whose columns are aligned, the last one wrapped; an empty table has no line."""
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
