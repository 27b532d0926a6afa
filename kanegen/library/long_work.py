"""Work that takes long says so on a terminal, so that nobody takes a large build for a hang."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

from kanegen.options import Progress, quiet

PATIENCE = 5.0
"""Seconds after which work names its stage on a terminal."""


@contextmanager
def long_work(name: str, progress: Progress = quiet, patience: float = PATIENCE) -> Iterator[Progress]:
    """Yield the function to call with the name of each stage.

    Where the caller gave none and the standard error is a terminal, work that takes longer than `patience`
    names its stage there, then each further one, and its time at the end. Elsewhere nothing is printed.

    Args:
        name: What is worked on.
        progress: Function that the caller gave.
        patience: Seconds until the first line.

    Example:
        with long_work(system.name) as progress:
            progress("compiling")
    """
    if progress is not quiet or not sys.stderr.isatty():
        yield progress
        return
    start, stages, speaks = time.monotonic(), ["starting"], threading.Event()

    def say(text: str) -> None:
        print(f"kanegen: {name}: {text}", file=sys.stderr, flush=True)

    def first() -> None:
        speaks.set()
        say(f"{stages[-1]} ...")

    def stage(text: str) -> None:
        stages.append(text)
        if speaks.is_set():
            say(f"{text} ...")

    timer = threading.Timer(patience, first)
    timer.daemon = True
    timer.start()
    try:
        yield stage
    finally:
        timer.cancel()
        if speaks.is_set():
            say(f"{time.monotonic() - start:.0f} s")
