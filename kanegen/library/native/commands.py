"""Commands of the operating system, such as compilers, run with or without a time limit."""

from __future__ import annotations

import os
import shlex
import signal
import subprocess
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from kanegen.errors import BuildError

_LONGEST_REASON = 300
"""Characters of a reason that no line of the output gives."""


class CommandError(BuildError):
    """A command that could not be started, ended with a status other than 0, or made no file.

    Attributes:
        output: What the command printed.
    """

    def __init__(self, message: str, output: str = "") -> None:
        super().__init__(message)
        self.output = output

    @property
    def reason(self) -> str:
        """The first line of the output that mentions an error, or the beginning of the output."""
        lines = [line for line in self.output.splitlines() if line.strip()]
        beginning = self.output[:_LONGEST_REASON] or str(self)
        return next((line for line in lines if "error" in line), beginning)


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
    try:
        process = subprocess.Popen(
            command,
            cwd=folder,
            start_new_session=seconds is not None,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            errors="replace",
        )
    except OSError as error:
        raise CommandError(f"{_joined(command)}: cannot be run: {error.strerror}.") from error
    with process:
        try:
            output, errors = process.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            _kill(process, has_group=True)
            raise TimeLimitError(command, seconds or 0.0) from None
        except BaseException:
            _kill(process, has_group=seconds is not None)
            raise
    return subprocess.CompletedProcess(command, process.returncode, output, errors)


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
            f"{_joined(command)}: failed with status {done.returncode}.\n{printed}", done.stderr or printed
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
    done = run(command, folder, seconds)
    if done.returncode != 0 or not (folder / file).is_file():
        printed = done.stdout + done.stderr
        raise CommandError(
            f"the compiler failed with status {done.returncode} and made no {file}.\n"
            f"command: {_joined(command)}\n{printed}",
            printed,
        )


def _kill(process: subprocess.Popen[str], has_group: bool) -> None:
    """Kill a process, and where it leads a group of its own, every process in that group."""
    if has_group and hasattr(os, "killpg"):
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    process.kill()


def _joined(command: Sequence[str | Path]) -> str:
    """Return a command as one line of a shell."""
    return shlex.join(map(str, command))
