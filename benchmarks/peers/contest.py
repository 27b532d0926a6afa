"""Contestants on one model: first they must agree, then they take turns."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.peers.building import Setting
from benchmarks.peers.results import TOLERANCE, Results, Task, difference, read


@dataclass(frozen=True)
class Contestant:
    """A driver with its states.

    Attributes:
        name: Program and coordinates.
        setting: Of the compiler.
        program: The driver.
        states: Its file of states.
        tasks: What it computes, in its order.
        arguments: Further arguments of the driver.
        convert: From its coordinates to those of kanegen.
    """

    name: str
    setting: Setting
    program: Path
    states: Path
    tasks: tuple[Task, ...]
    arguments: tuple[str, ...] = ()
    convert: Callable[[Results], Results] = lambda results: results

    def results(self, n: int) -> Results:
        """What it computes, in kanegen's coordinates."""
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "results"
            self._run("results", str(out))
            return self.convert(read(out, self.tasks, n))

    def times(self, seconds: float) -> dict[str, float]:
        """Nanoseconds of an evaluation by task, each over about `seconds`, in a process of its own."""
        pairs = (line.rsplit(" ", 1) for line in self._run("times", str(seconds)).splitlines())
        return {task: float(value) for task, value in pairs}

    def _run(self, mode: str, last: str) -> str:
        command = [str(self.program), mode, str(self.states), last, *self.arguments]
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout


@dataclass(frozen=True)
class Entry:
    """A contestant's task and what came of it.

    Attributes:
        contestant: Its name.
        setting: Of its compiler.
        task: What was timed.
        error: Largest difference from the first contestant's result, relative.
        times: ns an evaluation, one number a round; empty where the results do not agree.
    """

    contestant: str
    setting: Setting
    task: Task
    error: float
    times: tuple[float, ...]

    @property
    def median(self) -> float:
        """ns an evaluation."""
        return float(np.median(self.times))

    @property
    def agrees(self) -> bool:
        """Whether the results are those of the first contestant."""
        return self.error <= TOLERANCE


def entries(contestants: Sequence[Contestant], n: int, rounds: int, seconds: float) -> list[Entry]:
    """Agreement with the first contestant, then `rounds` in which everybody has a turn."""
    results = [contestant.results(n) for contestant in contestants]
    standard = {task.quantity: results[0][task.name] for task in reversed(contestants[0].tasks)}
    errors = {
        (place, task): difference(results[place][task.name], standard[task.quantity])
        for place, contestant in enumerate(contestants)
        for task in contestant.tasks
    }
    times: dict[tuple[int, str], list[float]] = {}
    for _ in range(rounds):
        for place, contestant in enumerate(contestants):
            for task, value in contestant.times(seconds).items():
                times.setdefault((place, task), []).append(value)
    return [
        Entry(
            contestants[place].name,
            contestants[place].setting,
            task,
            error,
            tuple(times[place, task.name]) if error <= TOLERANCE else (),
        )
        for (place, task), error in errors.items()
    ]
