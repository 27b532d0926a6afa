"""Run a command that may take too long, such as a compiler on a large file."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Sequence
from pathlib import Path


def run(command: Sequence[str], folder: Path, seconds: float | None) -> subprocess.CompletedProcess[str]:
    """What the command says; a compiler that is stopped takes the processes that it has started with it.

    Raises:
        subprocess.TimeoutExpired: If it takes more than `seconds`.
    """
    with subprocess.Popen(
        command,
        cwd=folder,
        start_new_session=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            output, errors = process.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            if hasattr(os, "killpg"):
                os.killpg(process.pid, signal.SIGKILL)
            process.kill()
            raise
    return subprocess.CompletedProcess(command, process.returncode, output, errors)
