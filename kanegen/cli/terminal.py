"""The terminal: progress, tables, warnings, errors and exit statuses of all commands."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import NoReturn, TextIO

from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from kanegen.errors import LONGEST_MESSAGE, QUOTED, KanegenWarning, excerpt

BAD_INPUT = 2
"""Exit status after an error in a model or an option; typer uses the same after a misspelt command."""

FAILED = 1
"""Exit status after a check that ran and did not pass."""

INTERRUPTED = 130
"""Exit status after Ctrl-C."""

errors = Console(stderr=True, highlight=False, soft_wrap=True)
"""Standard error, for progress, warnings and errors."""

screen = Console(highlight=False)
"""Standard output, for results."""


@contextmanager
def progress(is_long: bool = False) -> Iterator[Callable[[str], None]]:
    """Yield a function that shows the name of the current stage on a terminal, and nothing elsewhere.

    The work of a command begins here, after its input is accepted, so warnings are shown before.

    Args:
        is_long: Whether the work takes minutes. Then each stage is a line where there is no terminal, so that
            a log shows how far the work is.
    """
    notices.release()
    if not errors.is_terminal:
        yield (lambda stage: errors.print(escape(stage))) if is_long else (lambda stage: None)
        return
    with errors.status("starting") as status:
        yield lambda stage: status.update(escape(stage))


def print_plain(text: str) -> None:
    """Print a line of text as it is, wrapped by the terminal only."""
    screen.print(escape(text), soft_wrap=True)


def print_table(head: Sequence[str], rows: Sequence[Sequence[str]], left: int = 1) -> None:
    """Print a table whose first `left` columns are aligned to the left, the others, numbers, to the right.

    A terminal wraps cells to its width. Elsewhere every row is one line, which other programs can read.
    """
    if screen.is_terminal:
        screen.print(_wrapped_table(head, rows, left))
        return
    for line in plain_table(head, rows, left):
        print_plain(line)
    print_plain("")


def plain_table(head: Sequence[str], rows: Sequence[Sequence[str]], left: int = 1) -> list[str]:
    """Return the lines of a table: its head, a rule, and a line for each row, two spaces between columns."""
    widths = [max(map(len, cells)) for cells in zip(head, *rows, strict=True)]

    def line(cells: Sequence[str]) -> str:
        """Return the cells of a row, padded to the widths of the columns."""
        padded = [
            cell.ljust(width) if place < left else cell.rjust(width)
            for place, (cell, width) in enumerate(zip(cells, widths, strict=True))
        ]
        return "  ".join(padded).rstrip()

    return [line(head), "  ".join("-" * width for width in widths), *map(line, rows)]


def _wrapped_table(head: Sequence[str], rows: Sequence[Sequence[str]], left: int) -> Table:
    """Build a table for a terminal.

    No column becomes narrower than its longest word, so that lines break between words only.
    """
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for place, cells in enumerate(zip(head, *rows, strict=True)):
        longest = max(len(word) for cell in cells for word in cell.split(" "))
        table.add_column(head[place], justify="left" if place < left else "right", min_width=longest)
    for row in rows:
        table.add_row(*map(escape, row))
    return table


class Notices:
    """Warnings of a command, each text once, held back until all that the command was given is accepted.

    A warning of a model may be long. Before an error that ends the command it would hide the one line that
    tells what to mend, so there only its beginning and its end are shown.
    """

    def __init__(self) -> None:
        self.start()

    def start(self) -> None:
        """Begin with a new command."""
        self._known: set[str] = set()
        self._held: list[str] = []
        self._is_holding = True

    def add(self, text: str) -> None:
        """Show a warning, at once or later, unless it is known already."""
        if text not in self._known:
            self._known.add(text)
            self._held.append(text)
        if not self._is_holding:
            self.release()

    def release(self, longest: int = LONGEST_MESSAGE) -> None:
        """Show all held warnings, each with at most `longest` characters, and hold none from now on."""
        for text in self._held:
            errors.print(f"[yellow]warning:[/] {escape(excerpt(text, longest))}")
        self._held.clear()
        self._is_holding = False


notices = Notices()
"""The warnings of the command that runs."""


def show_warnings() -> None:
    """Show every warning of kanegen as one line, as `notices` does."""

    def show(
        message: Warning | str,
        category: type[Warning],
        filename: str,
        lineno: int,
        file: TextIO | None = None,
        line: str | None = None,
    ) -> None:
        """Show a warning; this replaces `warnings.showwarning` and has its signature."""
        notices.add(str(message))

    notices.start()
    warnings.simplefilter("always", KanegenWarning)
    warnings.showwarning = show


@contextmanager
def collected_warnings() -> Iterator[list[str]]:
    """Yield a list that receives kanegen's warnings, each once, in place of the terminal.

    If an error ends the command, they are shown before it.
    """
    found: list[str] = []
    kept: set[int] = set()
    caught: list[warnings.WarningMessage] = []
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", KanegenWarning)
            yield found
        kept = {i for i, one in enumerate(caught) if issubclass(one.category, KanegenWarning)}
        found += dict.fromkeys(str(caught[i].message) for i in sorted(kept))
    finally:
        for i, one in enumerate(caught):
            if i not in kept:
                warnings.showwarning(one.message, one.category, one.filename, one.lineno)


@contextmanager
def without_warnings() -> Iterator[None]:
    """Suppress kanegen's warnings, for a model that is read again."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", KanegenWarning)
        yield


def fail(error: Exception) -> NoReturn:
    """Print an error as one line, after short forms of warnings still held, and exit with `BAD_INPUT`."""
    notices.release(QUOTED)
    errors.print(f"[bold red]error:[/] {escape(str(error))}")
    sys.exit(BAD_INPUT)
