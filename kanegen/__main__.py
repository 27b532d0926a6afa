"""The program `kanegen`, also as `python -m kanegen`: the command line, which Ctrl-C ends at any time."""

from __future__ import annotations

import os
import signal
import sys
from contextlib import suppress
from types import FrameType
from typing import NoReturn

WORDS = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated"}
"""What is printed after a signal that ends the command; the exit status is 128 and the signal's number."""


def main() -> None:
    """Run the command line; Ctrl-C or SIGTERM ends it, and the compilers that it runs, with one word.

    Some packages answer an interruption of their import with an error of their own. Whatever ends the command
    after the signal therefore counts as its answer.
    """
    received: list[signal.Signals] = []

    def end(number: int, _frame: FrameType | None) -> NoReturn:
        received.append(signal.Signals(number))
        raise KeyboardInterrupt

    for number in WORDS:
        if signal.getsignal(number) in (signal.default_int_handler, signal.SIG_DFL):  # else it is ignored
            signal.signal(number, end)
    try:
        from kanegen.cli import main as command_line

        command_line()
    except BaseException:
        if not received:
            raise
    if received:
        _exit(received[0])


def _exit(number: signal.Signals) -> NoReturn:
    """End the process at once: what was interrupted may be in no state for the end of the interpreter."""
    for other in WORDS:
        signal.signal(other, signal.SIG_IGN)
    with suppress(OSError, ValueError):  # whoever read the output may be gone
        sys.stdout.flush()
        print(WORDS[number], file=sys.stderr, flush=True)
    os._exit(128 + number)


if __name__ == "__main__":
    main()
