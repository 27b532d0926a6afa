"""A program that takes part in a comparison, and the compiler settings of such programs."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from kanegen.errors import MissingError
from kanegen.library.native import commands
from kanegen.options import STRICT
from kanegen.studies.bench.results import Results, Task, read


@dataclass(frozen=True)
class Setting:
    """Compiler flags and the name under which they are reported."""

    name: str
    flags: tuple[str, ...]


EXACT = Setting("exact", STRICT.flags)
"""The setting that kanegen uses by default."""

NATIVE = Setting("native", ("-O3", "-march=native"))
"""The setting of every program: code for this processor, which may fuse a product and a sum."""

RELAXED = Setting(
    "relaxed",
    (
        "-O3",
        "-march=native",
        "-ffp-contract=fast",
        "-fno-math-errno",
        "-fno-trapping-math",
        "-fno-signed-zeros",
        "-fassociative-math",
    ),
)
"""The fastest setting that leaves the floating-point environment of the process alone, unlike -ffast-math."""

AS_SHIPPED = Setting("as shipped", ("-O2",))
"""The setting of drivers for a library that is installed in compiled form."""

SETTINGS = (EXACT, NATIVE, RELAXED, AS_SHIPPED)
"""All settings, in the order of the documentation."""


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
        driver, *others = self.command
        with tempfile.TemporaryDirectory() as folder:
            fresh = driver if others else shutil.copy2(driver, folder)
            loads = tuple(Path(shutil.copy2(file, folder)) for file in self.loads)
            printed = self._run(fresh, "times", repr(seconds), loads)
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
