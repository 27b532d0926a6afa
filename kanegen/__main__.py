"""The program `kanegen`, also as `python -m kanegen`: the command line, which Ctrl-C ends at any time."""

from __future__ import annotations

import os
import signal
import sys
from contextlib import suppress
from types import FrameType
from typing import NoReturn

INTERRUPTED = 130
"""Exit status after Ctrl-C, as shells have it."""


def main() -> None:
    """Run the command line; after Ctrl-C, one word is printed and the exit status is `INTERRUPTED`.

    Some packages answer an interruption of their import with an error of their own. Whatever ends the command
    after Ctrl-C therefore counts as the interruption.
    """
    interrupted = False

    def interrupt(_signal: int, _frame: FrameType | None) -> NoReturn:
        nonlocal interrupted
        interrupted = True
        raise KeyboardInterrupt

    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # not where the signal is ignored
        signal.signal(signal.SIGINT, interrupt)
    try:
        from kanegen.cli import main as command_line

        command_line()
    except BaseException:
        if not interrupted:
            raise
        _exit()
    if interrupted:
        _exit()


def _exit() -> NoReturn:
    """End the process at once: what Ctrl-C interrupted may be in no state for the end of the interpreter."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with suppress(OSError, ValueError):  # whoever read the output may be gone
        sys.stdout.flush()
        print("interrupted", file=sys.stderr, flush=True)
    os._exit(INTERRUPTED)


if __name__ == "__main__":
    main()
