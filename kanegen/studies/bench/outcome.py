"""What comes of a contest on one model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from kanegen.measure.timing import Times
from kanegen.studies.bench.results import TOLERANCE, Task
from kanegen.studies.bench.settings import EXACT, Setting

KANEGEN = "kanegen"
PYTHON = "kanegen from Python"
UNTIMED = Times(())


@dataclass(frozen=True)
class BenchOptions:
    """How a contest is held.

    Attributes:
        states: How many random states everybody computes.
        rounds: In each of which everybody has one turn.
        seconds: Of every task in every round.
    """

    states: int = 256
    rounds: int = 9
    seconds: float = 0.05


@dataclass(frozen=True)
class Entry:
    """A contestant's task and what came of it.

    Attributes:
        contestant: Its name.
        setting: Of its compiler.
        task: What was timed.
        error: Largest difference from the first contestant's result, relative.
        times: Times of an evaluation; without rounds where the results do not agree.
    """

    contestant: str
    setting: Setting
    task: Task
    error: float
    times: Times = UNTIMED

    @property
    def median(self) -> float:
        """ns an evaluation."""
        return self.times.median

    @property
    def agrees(self) -> bool:
        """Whether the results are those of the first contestant."""
        return self.error <= TOLERANCE


@dataclass(frozen=True)
class Absence:
    """Who was left out, and why."""

    name: str
    reason: str


@dataclass(frozen=True)
class Outcome:
    """One model: who computed what in what time.

    Attributes:
        model: Its name.
        n: Number of freedoms.
        entries: The first one's contestant is the standard: results are compared with its results, and
            ratios are over its times.
        absences: Who was left out.
        notes: What was changed in the model so that everybody can take it.
    """

    model: str
    n: int
    entries: tuple[Entry, ...]
    absences: tuple[Absence, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def standard(self) -> str:
        """Name of the contestant with which the others are compared."""
        return self.entries[0].contestant

    @property
    def agrees(self) -> bool:
        """Whether all results are those of the standard."""
        return all(entry.agrees for entry in self.entries)

    def best(
        self, contestant: str, quantity: str, setting: Setting | None = None, batch: bool = False
    ) -> Entry | None:
        """The fastest of a contestant's ways to compute a quantity."""
        timed = [
            entry
            for entry in self.entries
            if entry.times.rounds
            and (entry.contestant, entry.task.quantity, entry.task.batch) == (contestant, quantity, batch)
            and setting in (None, entry.setting)
        ]
        return min(timed, key=lambda entry: entry.median, default=None)

    def overhead(self, quantity: str) -> float | None:
        """ns that a call from Python takes beyond the same C called from C."""
        call, own = self.best(PYTHON, quantity), self.best(KANEGEN, quantity, EXACT)
        return None if call is None or own is None else call.median - own.median

    def as_dict(self) -> dict[str, Any]:
        """Everything as plain data."""
        return {
            "model": self.model,
            "freedoms": self.n,
            "standard": self.standard,
            "notes": list(self.notes),
            "left_out": [{"name": absence.name, "reason": absence.reason} for absence in self.absences],
            "entries": [
                {
                    "contestant": entry.contestant,
                    "setting": entry.setting.name,
                    "flags": list(entry.setting.flags),
                    "task": entry.task.name,
                    "quantity": entry.task.quantity,
                    "batch": entry.task.batch,
                    "difference": entry.error if np.isfinite(entry.error) else None,
                    "nanoseconds": list(entry.times.rounds),
                }
                for entry in self.entries
            ],
        }
