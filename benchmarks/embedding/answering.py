"""Programs that run turns of calls by themselves: a line of input names a call, and they answer its time."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

Turns = Callable[[str], Callable[[], float]]
"""A function from the name of a call to one that runs a turn of it and returns nanoseconds of a call."""


@contextmanager
def answering(command: Sequence[str], folder: Path) -> Iterator[Turns]:
    """Run a program in a folder, and yield its turns.

    Example:
        with answering(["node", "turns.mjs"], folder) as turns:
            in_turns(alone, turns("arguments"))
    """
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True, "bufsize": 1}
    with subprocess.Popen(command, cwd=folder, **pipes) as process:

        def turn(call: str) -> float:
            process.stdin.write(f"{call}\n")
            return float(process.stdout.readline())

        yield lambda call: lambda: turn(call)
        process.stdin.close()
