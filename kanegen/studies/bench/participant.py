"""A program that takes part in a comparison, ready to run."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from kanegen.errors import MissingError
from kanegen.library.native import commands
from kanegen.studies.bench.results import Results, Task, read
from kanegen.studies.bench.settings import Setting


@dataclass(frozen=True)
class Participant:
    """A driver program with its states, ready to run; drivers/driver.h describes its command line.

    Attributes:
        name: Name of the program, and of its coordinates where they are not kanegen's.
        setting: Compiler setting of the program.
        command: Command that starts the driver.
        states: File of the states that the driver reads.
        tasks: Tasks that the driver computes, in its order.
        arguments: Further arguments of the driver.
        convert: Function from results in the program's coordinates to results in kanegen's.
        loads: Files of compiled code that the driver opens; they come before `arguments`.
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
        """Compute every task in all states, in the coordinates of kanegen.

        Args:
            n: Number of freedoms of the model.

        Raises:
            MissingError: If the driver cannot compute the model.
        """
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "results"
            self._run(self.command[0], "results", str(out), self.loads)
            return self.convert(read(out, self.tasks, n))

    def times(self, seconds: float) -> dict[str, float]:
        """Time every task for about `seconds` in a new process.

        Compiled code runs from a fresh copy, since the place of a file in memory can change its times by half
        and stays the same as long as the file does.

        Returns:
            Nanoseconds of one evaluation by name of the task.

        Raises:
            MissingError: If the driver fails.
        """
        with tempfile.TemporaryDirectory() as folder:
            return self._timed(self._copied(Path(folder)), seconds)

    def times_together(self, seconds: float, processes: int) -> dict[str, float]:
        """Time every task in several processes that run at the same time.

        Returns:
            Nanoseconds in which all processes together have computed one state more, by name of the task.

        Raises:
            MissingError: If the driver fails.
        """
        with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(processes) as pool:
            # All copies are complete before a process starts: a file that is being written cannot be run.
            copies = []
            for number in range(processes):
                own = Path(folder) / str(number)
                own.mkdir()
                copies.append(self._copied(own))
            found = list(pool.map(self._timed, copies, [seconds] * processes))
        return {task: 1 / sum(1 / one[task] for one in found) for task in found[0]}

    def _copied(self, folder: Path) -> tuple[str, tuple[Path, ...]]:
        """Return a fresh copy of the compiled program, and of the files that it opens."""
        driver, *others = self.command
        fresh = driver if others else str(shutil.copy2(driver, folder))
        return fresh, tuple(Path(shutil.copy2(file, folder)) for file in self.loads)

    def _timed(self, copy: tuple[str, tuple[Path, ...]], seconds: float) -> dict[str, float]:
        """Run a copy of the program and return nanoseconds of one evaluation by name of the task."""
        printed = self._run(copy[0], "times", repr(seconds), copy[1])
        pairs = (line.rsplit(" ", 1) for line in printed.splitlines())
        return {task: float(value) for task, value in pairs}

    def _run(self, driver: str, mode: str, last: str, loads: tuple[Path, ...]) -> str:
        """Run the driver and return its output."""
        between = (mode, str(self.states), last, *map(str, loads))
        command = [driver, *self.command[1:], *between, *self.arguments]
        done = commands.run(command)
        if done.returncode:
            lines = done.stderr.strip().splitlines() or [f"status {done.returncode}"]
            raise MissingError(f"its driver failed: {lines[-1]}")
        return done.stdout
