"""A program that takes part: it gives its results, and it gives its times."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from kanegen.errors import MissingError
from kanegen.library.native import commands
from kanegen.studies.bench.results import Results, Task, read
from kanegen.studies.bench.settings import Setting


@dataclass(frozen=True)
class Contestant:
    """A driver with its states; drivers/contest.h says how drivers are called.

    Attributes:
        name: Program and coordinates.
        setting: Of the compiler.
        command: The driver.
        states: Its file of states.
        tasks: What it computes, in its order.
        arguments: Further arguments of the driver.
        convert: From its coordinates to those of kanegen.
        loads: Compiled code that the driver opens; named before the further arguments.
    """

    name: str
    setting: Setting
    command: tuple[str, ...]
    states: Path
    tasks: tuple[Task, ...]
    arguments: tuple[str, ...] = ()
    convert: Callable[[Results], Results] = lambda results: results
    loads: tuple[Path, ...] = ()

    def results(self, n: int) -> Results:
        """What it computes, in kanegen's coordinates.

        Raises:
            MissingError: If the driver cannot compute the model.
        """
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "results"
            self._run(self.command[0], "results", str(out), self.loads)
            return self.convert(read(out, self.tasks, n))

    def times(self, seconds: float) -> dict[str, float]:
        """Nanoseconds of an evaluation by task, each over about `seconds`, in a process of its own.

        Compiled code runs from a fresh copy: where its file happens to lie in memory can change its times by
        half, and stays the same as long as the file does.

        Raises:
            MissingError: If the driver fails.
        """
        driver, *others = self.command
        with tempfile.TemporaryDirectory() as folder:
            fresh = driver if others else shutil.copy2(driver, folder)
            loads = tuple(Path(shutil.copy2(file, folder)) for file in self.loads)
            printed = self._run(fresh, "times", repr(seconds), loads)
        pairs = (line.rsplit(" ", 1) for line in printed.splitlines())
        return {task: float(value) for task, value in pairs}

    def _run(self, driver: str, mode: str, last: str, loads: tuple[Path, ...]) -> str:
        between = (mode, str(self.states), last, *map(str, loads))
        command = [driver, *self.command[1:], *between, *self.arguments]
        done = commands.run(command)
        if done.returncode:
            lines = done.stderr.strip().splitlines() or [f"status {done.returncode}"]
            raise MissingError(f"its driver failed: {lines[-1]}")
        return done.stdout
