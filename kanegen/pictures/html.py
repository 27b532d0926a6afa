"""Parts of HTML for notebooks: sentences, tables and folded parts, with all text escaped.

    shown(sentence("{}: {} bodies", system.name, 8), folded("Parameters", table(("name", "default"), rows)))

A notebook stores what it shows, so long tables are cut, and say how to see the rest.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from markupsafe import Markup

MOST_ROWS = 40
"""Number of rows up to which a table is shown whole."""

MOST_LINES = 60
"""Number of lines up to which code is shown whole."""

_CELL = "padding: 0.1em 1em 0.1em 0; text-align: left; vertical-align: top"


def shown(*parts: Markup) -> str:
    """Return the HTML of an object: its parts under each other."""
    return str(Markup("<div>{}</div>").format(Markup("\n").join(part for part in parts if part)))


def sentence(text: str, *values: object, strong: object = None) -> Markup:
    """Return a line of text.

    Args:
        text: The text of the program, with {} for each value.
        values: Values that are put into it, escaped unless they are HTML.
        strong: What stands before it in bold, such as the name of a system.
    """
    start = Markup("<b>{}</b> ").format(name(strong)) if strong is not None else Markup("")
    line = Markup(text).format(*values)
    return Markup('<div style="margin: 0.2em 0">{}{}</div>').format(start, line)


def name(text: object) -> Markup:
    """Return a name in any script, which does not change the direction of what stands around it."""
    return Markup("<bdi>{}</bdi>").format(text)


def coloured(text: object, is_good: bool) -> Markup:
    """Return a verdict in green where it is good, else in red; both can be read on white and on black."""
    return Markup('<b style="color: {}">{}</b>').format("#2e9e44" if is_good else "#e5484d", text)


def table(
    head: Sequence[object], rows: Iterable[Sequence[object]], hint: str = "", most: int = MOST_ROWS
) -> Markup:
    """Return a table.

    Args:
        head: Headings of the columns.
        rows: Cells, row by row; text is escaped, HTML stays.
        hint: Python that gives what is left out where the table is cut, such as "system.freedom_names".
        most: Number of rows up to which it is shown whole.
    """
    every = list(rows)
    lines = [_row("th", head), *(_row("td", cells) for cells in every[:most])]
    whole = Markup('<table style="border-collapse: collapse; margin: 0.3em 0 0.6em">{}</table>').format(
        Markup("\n").join(lines)
    )
    return whole + _cut(len(every) - most, "rows", hint)


def code(text: str, hint: str = "", most: int = MOST_LINES) -> Markup:
    """Return lines of code or of other text with fixed width.

    Args:
        text: The lines.
        hint: Python that gives what is left out where the text is cut.
        most: Number of lines up to which it is shown whole.
    """
    lines = text.rstrip("\n").split("\n")
    block = Markup('<pre style="line-height: 1.3; overflow: auto">{}</pre>').format("\n".join(lines[:most]))
    return block + _cut(len(lines) - most, "lines", hint)


def folded(title: object, *parts: Markup) -> Markup:
    """Return parts that a click on their title shows."""
    return Markup("<details><summary>{}</summary>{}</details>").format(title, Markup("\n").join(parts))


def python(text: str) -> Markup:
    """Return Python within a sentence."""
    return Markup("<code>{}</code>").format(text)


def _row(tag: str, cells: Sequence[object]) -> Markup:
    """Return a row of a table; the direction of each cell is that of its own script."""
    cell = Markup('<{} dir="auto" style="{}">{}</{}>')
    return Markup("<tr>{}</tr>").format(Markup("").join(cell.format(tag, _CELL, one, tag) for one in cells))


def _cut(left_out: int, what: str, hint: str) -> Markup:
    """Return the sentence on what a cut table or text leaves out; nothing where it is whole."""
    if left_out <= 0:
        return Markup("")
    rest = Markup(": {}").format(python(hint)) if hint else Markup("")
    return Markup("<div>… {} more {}{}</div>").format(left_out, what, rest)
