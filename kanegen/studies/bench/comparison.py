"""The result of a comparison on one model: times and differences of every program."""

from __future__ import annotations

from dataclasses import dataclass

from kanegen.measure.timing import Times
from kanegen.studies.bench.results import Task
from kanegen.studies.bench.settings import DEFAULT, Setting

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
        cores: Number of cores that worked at the same time, each with a process of its own or a thread.
    """

    participant: str
    setting: Setting
    task: Task
    error: float
    times: Times = UNTIMED
    cores: int = 1

    @property
    def median(self) -> float:
        """The median time of one evaluation (ns)."""
        return self.times.median

    @property
    def agrees(self) -> bool:
        """Whether the results agree with the standard to the tolerance of the task."""
        return self.error <= self.task.tolerance


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

    @property
    def participants(self) -> tuple[str, ...]:
        """The names of all participants, in the order of the entries."""
        return tuple(dict.fromkeys(entry.participant for entry in self.entries))

    def best(
        self,
        participant: str,
        quantity: str,
        setting: Setting | None = None,
        batch: bool = False,
        instructions: str | None = None,
        cores: int = 1,
    ) -> Entry | None:
        """Find the fastest task of a participant that computes a quantity.

        Args:
            participant: Name of the participant.
            quantity: One of `quantities`.
            setting: Compiler setting; None allows every setting.
            batch: Whether the task computes many states in one call.
            instructions: Vector instructions that the compiler setting allows; None allows all.
            cores: Number of cores that work at the same time.

        Returns:
            The entry of the task; None if there is none that was timed.
        """
        timed = [
            entry
            for entry in self.entries
            if entry.times.rounds
            and (entry.participant, entry.task.quantity) == (participant, quantity)
            and (entry.task.batch, entry.cores) == (batch, cores)
            and setting in (None, entry.setting)
            and instructions in (None, entry.setting.instructions)
        ]
        return min(timed, key=lambda entry: entry.median, default=None)

    def overhead(self, quantity: str) -> float | None:
        """Return the time (ns) by which a call from Python exceeds a call of the same C from C."""
        call, own = self.best(PYTHON, quantity), self.best(KANEGEN, quantity, DEFAULT)
        return None if call is None or own is None else call.median - own.median
