"""The result of a comparison on one model: times and differences of every program, as data and as JSON."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from kanegen import __version__
from kanegen.measure.machine import Machine
from kanegen.measure.timing import Times
from kanegen.studies.bench.participant import EXACT, Setting
from kanegen.studies.bench.results import TOLERANCE, Task

KANEGEN = "kanegen"
"""Name of the participant that is kanegen's C called from C."""

PYTHON = "kanegen from Python"
"""Name of the participant that is kanegen's C called from Python."""

UNTIMED = Times(())
"""The times of a task whose results do not agree with the standard."""


@dataclass(frozen=True)
class BenchOptions:
    """The extent of a comparison.

    Attributes:
        states: Number of random states that every program computes.
        rounds: Number of rounds; every program has one turn in each.
        seconds: Duration of each task of a program in every round (s).
    """

    states: int = 256
    rounds: int = 9
    seconds: float = 0.05


@dataclass(frozen=True)
class Entry:
    """The result of one task of one participant.

    Attributes:
        participant: Name of the participant.
        setting: Compiler setting of the participant.
        task: The task that was timed.
        error: Largest difference from the standard, relative to the largest entry of the standard.
        times: Times of one evaluation; without rounds if the results do not agree.
    """

    participant: str
    setting: Setting
    task: Task
    error: float
    times: Times = UNTIMED

    @property
    def median(self) -> float:
        """The median time of one evaluation (ns)."""
        return self.times.median

    @property
    def agrees(self) -> bool:
        """Whether the results agree with the standard to `TOLERANCE`."""
        return self.error <= TOLERANCE


@dataclass(frozen=True)
class Absence:
    """A program that was left out, and the reason."""

    name: str
    reason: str


@dataclass(frozen=True)
class Comparison:
    """The results of all programs on one model.

    Attributes:
        model: Name of the model.
        n: Number of freedoms.
        entries: One entry for each task of each participant. The participant of the first entry is the
            standard: differences are from its results, and ratios are over its times.
        absences: The programs that were left out.
        notes: The changes to the model that let every program compute it.
    """

    model: str
    n: int
    entries: tuple[Entry, ...]
    absences: tuple[Absence, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def standard(self) -> str:
        """The name of the participant with which the others are compared."""
        return self.entries[0].participant

    @property
    def quantities(self) -> tuple[str, ...]:
        """The quantities that were compared, in the order of the entries."""
        return tuple(dict.fromkeys(entry.task.quantity for entry in self.entries))

    @property
    def agrees(self) -> bool:
        """Whether all results agree with the standard."""
        return all(entry.agrees for entry in self.entries)

    def best(
        self, participant: str, quantity: str, setting: Setting | None = None, batch: bool = False
    ) -> Entry | None:
        """Find the fastest task of a participant that computes a quantity.

        Args:
            participant: Name of the participant.
            quantity: One of `quantities`.
            setting: Compiler setting; None allows every setting.
            batch: Whether the task computes many states in one call.

        Returns:
            The entry of the task; None if there is none that was timed.
        """
        timed = [
            entry
            for entry in self.entries
            if entry.times.rounds
            and (entry.participant, entry.task.quantity, entry.task.batch) == (participant, quantity, batch)
            and setting in (None, entry.setting)
        ]
        return min(timed, key=lambda entry: entry.median, default=None)

    def overhead(self, quantity: str) -> float | None:
        """Return the time (ns) by which a call from Python exceeds a call of the same C from C."""
        call, own = self.best(PYTHON, quantity), self.best(KANEGEN, quantity, EXACT)
        return None if call is None or own is None else call.median - own.median

    def as_dict(self) -> dict[str, Any]:
        """Return all fields as plain data for JSON."""
        return {
            "model": self.model,
            "freedoms": self.n,
            "standard": self.standard,
            "notes": list(self.notes),
            "left_out": [{"name": absence.name, "reason": absence.reason} for absence in self.absences],
            "entries": [_entry_as_dict(entry) for entry in self.entries],
        }


def json_record(comparisons: Sequence[Comparison], options: BenchOptions) -> str:
    """Return all numbers of some comparisons as JSON, with a description of the machine."""
    record = {
        "kanegen": __version__,
        "machine": Machine.here().lines(),
        "terms": asdict(options),
        "outcomes": [comparison.as_dict() for comparison in comparisons],
    }
    return json.dumps(record, indent=2) + "\n"


def _entry_as_dict(entry: Entry) -> dict[str, Any]:
    """Return an entry as plain data for JSON."""
    return {
        "contestant": entry.participant,
        "setting": entry.setting.name,
        "flags": list(entry.setting.flags),
        "task": entry.task.name,
        "quantity": entry.task.quantity,
        "batch": entry.task.batch,
        "difference": entry.error if np.isfinite(entry.error) else None,
        "nanoseconds": list(entry.times.rounds),
    }
