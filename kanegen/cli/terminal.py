"""What every command needs of a terminal: progress, warnings, errors."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import NoReturn, TextIO

from rich.console import Console
from rich.markup import escape

from kanegen.errors import KanegenWarning

BAD_INPUT = 2
"""Exit status of an error in a model or an option; the same as of a misspelt command."""

FAILED = 1
"""Exit status of a check that ran and did not pass."""

errors = Console(stderr=True, highlight=False, soft_wrap=True)
screen = Console(highlight=False)


@contextmanager
def progress() -> Iterator[Callable[[str], None]]:
    """A function that shows the stage at work, on a terminal only."""
    if not errors.is_terminal:
        yield lambda stage: None
        return
    with errors.status("starting") as status:
        yield lambda stage: status.update(escape(stage))


def show_warning(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    file: TextIO | None = None,
    line: str | None = None,
) -> None:
    """Print a warning as one line; stands in for `warnings.showwarning`, whose signature this is."""
    errors.print(f"[yellow]warning:[/] {escape(str(message))}")


def show_warnings() -> None:
    """Show kanegen's own warnings, each time."""
    warnings.simplefilter("always", KanegenWarning)
    warnings.showwarning = show_warning


@contextmanager
def unheard() -> Iterator[None]:
    """Without kanegen's warnings, of what has been said before."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", KanegenWarning)
        yield


def fail(error: Exception) -> NoReturn:
    """Print an error as one line and leave with `BAD_INPUT`."""
    errors.print(f"[bold red]error:[/] {escape(str(error))}")
    sys.exit(BAD_INPUT)
