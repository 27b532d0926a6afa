"""Commands of the operating system, such as compilers, run with or without a time limit.

Every command leads a session of its own, so that it can be ended together with the processes that it started:
when its time is up, and when this process is interrupted while it waits.
"""

from __future__ import annotations

import os
import shlex
import signal
import subprocess
import time
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from kanegen.errors import LONGEST_OUTPUT, BuildError, excerpt
from kanegen.files import reason
from kanegen.library.native import processor

_AT_ONCE = 2
"""Commands at a time for each processor: the one that is waited for may not be the first to end."""

_LONGEST_REASON = 300
"""Characters of a reason that no line of the output gives."""


class CommandError(BuildError):
    """A command that could not be started, ended with a status other than 0, or made no file.

    Args:
        message: What happened; the first error of the output is added to it.
        output: What the command printed, which becomes a note of the exception.

    Attributes:
        output: What the command printed.
    """

    def __init__(self, message: str, output: str = "") -> None:
        self.output = output
        super().__init__(f"{message} It says: {self._first_error}" if output.strip() else message)
        if output.strip():
            self.add_note(f"Its output:\n{excerpt(output, LONGEST_OUTPUT, lines=True)}")

    @property
    def reason(self) -> str:
        """The first line of the output that mentions an error, or the beginning of the output."""
        return self._first_error or str(self)

    @property
    def _first_error(self) -> str:
        """The first line of the output that mentions an error, or its beginning in one line."""
        lines = [" ".join(line.split()) for line in self.output.splitlines() if line.strip()]
        return next((line for line in lines if "error" in line), " ".join(lines)[:_LONGEST_REASON])


class TimeLimitError(CommandError):
    """A command that was stopped because it exceeded its time limit.

    Attributes:
        seconds: The time limit, s.
    """

    def __init__(self, command: Sequence[str | Path], seconds: float) -> None:
        super().__init__(f"{_joined(command)}: took more than {seconds:g} s.")
        self.seconds = seconds


def run(
    command: Sequence[str | Path], folder: Path | None = None, seconds: float | None = None
) -> subprocess.CompletedProcess[str]:
    """Run a command without input and wait until it ends.

    A command that exceeds its time limit is killed together with the processes that it started.

    Args:
        command: Program and arguments.
        folder: Working directory; by default that of this process.
        seconds: Time limit, s; by default there is none.

    Returns:
        Status, standard output and standard error.

    Raises:
        CommandError: If the command cannot be started.
        TimeLimitError: If it takes more than `seconds`.
    """
    (done,) = run_all([command], folder, seconds)
    return done


def run_all(
    commands: Sequence[Sequence[str | Path]], folder: Path | None = None, seconds: float | None = None
) -> list[subprocess.CompletedProcess[str]]:
    """Run commands, some of them at the same time, and wait until all have ended.

    They start in order, at most `_AT_ONCE` at a time for each processor that this process may use.

    Args:
        commands: Program and arguments of each.
        folder: Working directory of all; by default that of this process.
        seconds: Time limit of all together, s; by default there is none.

    Raises:
        CommandError: If a command cannot be started; the others are then killed.
        TimeLimitError: If they take more than `seconds`; all are then killed.
    """
    deadline = None if seconds is None else time.monotonic() + seconds
    with ExitStack() as stack:
        waiting, running = deque(commands), deque[subprocess.Popen[str]]()
        done = []
        for command in commands:
            while waiting and len(running) < _AT_ONCE * processor.usable():
                running.append(stack.enter_context(_started(waiting.popleft(), folder)))
            process = running.popleft()
            left = None if deadline is None else max(deadline - time.monotonic(), 0.0)
            try:
                output, errors = process.communicate(timeout=left)
            except subprocess.TimeoutExpired:
                raise TimeLimitError(command, seconds or 0.0) from None
            done.append(subprocess.CompletedProcess(command, process.returncode, output, errors))
        return done


@contextmanager
def _started(command: Sequence[str | Path], folder: Path | None) -> Iterator[subprocess.Popen[str]]:
    """Start a command in a session of its own; at the end of the context it is killed if it still runs.

    Raises:
        CommandError: If the command cannot be started.
    """
    try:
        process = subprocess.Popen(
            command,
            cwd=folder,
            start_new_session=True,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            errors="replace",
        )
    except (OSError, ValueError) as error:
        raise CommandError(f"{_joined(command)}: cannot be run: {reason(error)}.") from error
    with process:
        try:
            yield process
        finally:
            if process.returncode is None:
                _kill(process)


def output(command: Sequence[str | Path], folder: Path | None = None, seconds: float | None = None) -> str:
    """Return the standard output of a command that must succeed.

    Args:
        command: Program and arguments.
        folder: Working directory; by default that of this process.
        seconds: Time limit, s; by default there is none.

    Raises:
        CommandError: If the command cannot be started or its status is not 0.
        TimeLimitError: If it takes more than `seconds`.
    """
    done = run(command, folder, seconds)
    if done.returncode != 0:
        printed = done.stdout + done.stderr
        raise CommandError(
            f"{_joined(command)}: failed with status {done.returncode}.", done.stderr or printed
        )
    return done.stdout


def make(command: Sequence[str], file: str, folder: Path, seconds: float | None = None) -> None:
    """Run a compiler that must make a file.

    Args:
        command: Compiler and arguments.
        file: The file that it makes, relative to `folder`.
        folder: Working directory of the compiler.
        seconds: Time limit, s; by default there is none.

    Raises:
        CommandError: If the compiler cannot be started, its status is not 0, or it makes no such file.
        TimeLimitError: If it takes more than `seconds`.
    """
    make_all({file: command}, folder, seconds)


def make_all(commands: Mapping[str, Sequence[str]], folder: Path, seconds: float | None = None) -> None:
    """Run compilers, several at the same time, each of which must make a file.

    Args:
        commands: Compiler and arguments by the file that it makes, relative to `folder`.
        folder: Working directory of the compilers.
        seconds: Time limit of all together, s; by default there is none.

    Raises:
        CommandError: If a compiler cannot be started, its status is not 0, or it does not make its file.
        TimeLimitError: If they take more than `seconds`.
    """
    finished = run_all(list(commands.values()), folder, seconds)
    for (file, command), done in zip(commands.items(), finished, strict=True):
        if done.returncode != 0 or not (folder / file).is_file():
            printed = done.stdout + done.stderr
            raise CommandError(
                f"{_joined(command)}: failed with status {done.returncode} and made no {file}.", printed
            )


def _kill(process: subprocess.Popen[str]) -> None:
    """Kill a process that leads a session, and every process in its group."""
    if hasattr(os, "killpg"):
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, signal.SIGKILL)
    process.kill()


def _joined(command: Sequence[str | Path]) -> str:
    """Return a command as one line of a shell."""
    return shlex.join(map(str, command))
