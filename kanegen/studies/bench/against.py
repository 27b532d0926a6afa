"""A comparison beside a saved one of the same model: which tasks of kanegen became slower or faster.

Where both runs timed a program that is not kanegen, its times stand in the same rounds as those of kanegen,
so the ratios of the same rounds are compared: they hardly change with the load and the frequency of the
machine. Otherwise the times are compared, which needs the same machine and compiler.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from kanegen.errors import OptionError
from kanegen.measure.timing import Change, Times, change
from kanegen.studies.bench.comparison import KANEGEN, PYTHON, Comparison, Entry
from kanegen.studies.bench.record import Record
from kanegen.studies.bench.results import of_peers

LEAST_ROUNDS = 5
"""Number of rounds below which two runs cannot be compared."""

OWN = (KANEGEN, PYTHON)
"""The participants that are kanegen."""


@dataclass(frozen=True)
class Row:
    """One task of kanegen in two runs.

    Attributes:
        model: Name of the model.
        entry: The entry of the later run.
        peer: The program to which ratios are compared; "" where times are.
        before: Median of the rounds of the earlier run: of ratios to the peer, or of nanoseconds.
        now: The same of the later run.
        change: `now` over `before`, with its interval.
    """

    model: str
    entry: Entry
    peer: str
    before: float
    now: float
    change: Change


@dataclass(frozen=True)
class Verdict:
    """Two runs beside each other.

    Attributes:
        rows: The tasks of kanegen that stand in both.
        notes: What differs between the runs, and the tasks that only one of them has.
    """

    rows: tuple[Row, ...]
    notes: tuple[str, ...] = ()

    @property
    def slower(self) -> tuple[Row, ...]:
        """The tasks that became slower."""
        return tuple(row for row in self.rows if row.change.is_slower)

    @property
    def faster(self) -> tuple[Row, ...]:
        """The tasks that became faster."""
        return tuple(row for row in self.rows if row.change.is_faster)

    @property
    def undecided(self) -> tuple[Row, ...]:
        """The tasks whose rounds scatter too much to tell."""
        return tuple(row for row in self.rows if row.change.is_undecided)


def require_comparable(saved: Record, path: Path, model: str, rounds: int) -> None:
    """Make sure, before minutes of measurement, that a saved record can be compared with a new one.

    Args:
        saved: The record.
        path: Its file, for messages.
        model: Name of the model that will be timed.
        rounds: Number of rounds that it will have.

    Raises:
        OptionError: If it lacks the model, or either has too few rounds.
    """
    names = [one.model for one in saved.comparisons]
    if model not in names:
        raise OptionError(f"{path}: it has no times of {model!r}, only of {', '.join(names)}.")
    for place, number in ((str(path), saved.options.rounds), ("--rounds", rounds)):
        if number < LEAST_ROUNDS:
            raise OptionError(
                f"{place}: {number} rounds are too few to compare runs. Take at least {LEAST_ROUNDS}."
            )


def compare_records(new: Record, saved: Record, path: Path) -> Verdict:
    """Return the tasks of kanegen in a new record beside those of a saved one.

    Args:
        new: The later run.
        saved: The earlier run.
        path: File of the earlier run, for messages.

    Raises:
        OptionError: If the machines or compilers differ and no other program was timed in both runs.
    """
    notes = list(_differences(new, saved))
    is_same = _is_same_machine(new, saved)
    rows: list[Row] = []
    for later in new.comparisons:
        for earlier in (one for one in saved.comparisons if one.model == later.model):
            found = list(_rows(later, earlier, is_same))
            if not found and not is_same:
                raise OptionError(
                    f"{path}: taken on another machine or with another compiler, whose times do not compare, "
                    f"and no other program was timed in both runs: {saved.machine.processor}; "
                    f"{saved.machine.compiler}. Time the same peer in both, such as --peer casadi."
                )
            rows += found
            notes += _alone(later, earlier)
    return Verdict(tuple(rows), tuple(notes))


def _is_same_machine(new: Record, saved: Record) -> bool:
    """Return whether two runs have the same processor, operating system and compiler."""
    a, b = new.machine, saved.machine
    return (a.processor, a.system, a.compiler) == (b.processor, b.system, b.compiler)


def _differences(new: Record, saved: Record) -> Iterator[str]:
    """Yield one sentence for each difference between the machines and programs of two runs."""
    a, b = new.machine, saved.machine
    if not _is_same_machine(new, saved):
        yield (
            "The saved times come from another machine or compiler, so only ratios to a peer are compared, "
            f"which differ between machines, too: {b.processor}, {b.system}, {b.compiler}"
        )
    if a.versions != b.versions:
        yield f"The saved times have other versions: {b.versions}"
    if new.version != saved.version:
        yield f"The saved times are of kanegen {saved.version}"


def _rows(later: Comparison, earlier: Comparison, is_same: bool) -> Iterator[Row]:
    """Yield the tasks of kanegen that both comparisons timed, those of one quantity together."""
    before = {_key(entry): entry for entry in earlier.entries if entry.times.rounds}
    own = (one for one in later.entries if one.participant in OWN and one.times.rounds)
    for entry in sorted(own, key=lambda one: later.quantities.index(one.task.quantity)):
        if (old := before.get(_key(entry))) is None:
            continue
        peer = _peer(later, before, entry)
        if peer is not None:
            shares = [_shares(part, whole) for part, whole in ((entry, peer), (old, before[_key(peer)]))]
        elif is_same:
            shares = [entry.times.rounds, old.times.rounds]
        else:
            continue
        now, past = (Times(tuple(values)).median for values in shares)
        name = "" if peer is None else peer.participant
        yield Row(later.model, entry, name, past, now, change(shares[0], shares[1]))


Key = tuple[str, str, tuple[str, ...], str, int]
"""Participant, compiler setting with its flags, task, and number of cores."""


def _key(entry: Entry) -> Key:
    """Return what makes two entries those of one task."""
    setting = entry.setting
    return entry.participant, setting.name, setting.flags, entry.task.name, entry.cores


def _peer(later: Comparison, before: dict[Key, Entry], entry: Entry) -> Entry | None:
    """Return the first entry of another program, for the same quantity, that both comparisons timed."""
    for one in later.entries:
        is_other = one.participant not in OWN and one.times.rounds and _key(one) in before
        if is_other and (one.task.quantity, one.cores) == (of_peers(entry.task.quantity), entry.cores):
            return one
    return None


def _shares(part: Entry, whole: Entry) -> tuple[float, ...]:
    """Return the ratio of two entries in every round."""
    return tuple(a / b for a, b in zip(part.times.rounds, whole.times.rounds, strict=True))


def _alone(later: Comparison, earlier: Comparison) -> Iterator[str]:
    """Yield a sentence about the tasks of kanegen that only one of two comparisons timed."""
    for title, one, other in (("new", later, earlier), ("saved", earlier, later)):
        known = {_key(entry) for entry in other.entries if entry.times.rounds}
        names = [
            f"{entry.task.name} ({entry.setting.name})"
            for entry in one.entries
            if entry.participant in OWN and entry.times.rounds and _key(entry) not in known
        ]
        if names:
            yield f"{later.model}: only the {title} run timed {', '.join(names)}"
