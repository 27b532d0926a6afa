"""A contest on one model: first everybody must agree, then they take turns."""

from __future__ import annotations

import tempfile
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from kanegen.errors import MissingError, OptionError
from kanegen.measure.timing import Rounds, Times
from kanegen.model.prescribed import require_unprescribed
from kanegen.model.system import System
from kanegen.studies.bench.contestant import Contestant
from kanegen.studies.bench.outcome import Absence, BenchOptions, Entry, Outcome
from kanegen.studies.bench.peers.field import PEERS, contestants
from kanegen.studies.bench.results import Results, difference
from kanegen.studies.bench.states import plain, random_states

Progress = Callable[[str], None]


def compete(
    system: System, terms: BenchOptions, progress: Progress = lambda stage: None, peers: Iterable[str] = PEERS
) -> Outcome:
    """Time kanegen and its peers on `system`, in turns, after comparing their results.

    Args:
        system: The model; loads are switched off and run-time parameters folded.
        terms: Of the contest.
        progress: Told the name of each stage.
        peers: Who takes part beside kanegen, names among `PEERS`.

    Raises:
        BuildError: If there is no C compiler.
        MissingError: If nobody can compute the model.
        OptionError: If a peer is unknown, a freedom is prescribed, or the generalized speeds are not the
            rates of the coordinates, which are all that the peers know.
        SingularError: If [A] is singular in every state.
    """
    require_unprescribed(system, "contest")
    if not system.speeds_are_rates:
        raise OptionError(
            f"system {system.name!r}: its generalized speeds are components of angular velocities, and a "
            'contest needs the rates of the coordinates. Take system.with_speeds("angle_rates").'
        )
    model, notes = plain(system)
    progress("building the contestants; Pinocchio takes minutes the first time")
    with tempfile.TemporaryDirectory() as folder:
        states = random_states(model, terms.states)
        present, absences = contestants(model, states, Path(folder), peers)
        progress("comparing their results")
        entries, failed = judge(present, len(model.freedoms), terms, progress)
    if not entries:
        raise MissingError("; ".join(f"{absence.name}: {absence.reason}" for absence in absences + failed))
    return Outcome(system.name, len(model.freedoms), tuple(entries), tuple(absences + failed), notes)


def judge(
    contestants: Sequence[Contestant], n: int, terms: BenchOptions, progress: Progress
) -> tuple[list[Entry], list[Absence]]:
    """Agreement with the first contestant that gives results, then rounds in which everybody has a turn.

    Who agrees in nothing is not timed.
    """
    computed, absences = _results(contestants, n)
    standard: Results = {}
    for contestant, results in computed.items():
        for task in contestant.tasks:
            standard.setdefault(task.quantity, results[task.name])
    entries = {
        (contestant, task.name): Entry(
            contestant.name,
            contestant.setting,
            task,
            error=difference(results[task.name], standard[task.quantity]),
        )
        for contestant, results in computed.items()
        for task in contestant.tasks
    }
    agreeing = dict.fromkeys(contestant for (contestant, _), entry in entries.items() if entry.agrees)
    times = take_turns(agreeing, Rounds(terms.rounds, terms.seconds), progress)
    timed = [replace(entry, times=times[key]) if entry.agrees else entry for key, entry in entries.items()]
    return timed, absences


def take_turns(
    contestants: Iterable[Contestant], rounds: Rounds, progress: Progress
) -> dict[tuple[Contestant, str], Times]:
    """Times by contestant and task, of rounds in each of which every contestant has one turn.

    Raises:
        MissingError: If a driver fails.
    """
    times: defaultdict[tuple[Contestant, str], list[float]] = defaultdict(list)
    for turn in range(rounds.number):
        progress(f"timing, round {turn + 1} of {rounds.number}")
        for contestant in contestants:
            for name, value in contestant.times(rounds.seconds).items():
                times[contestant, name].append(value)
    return {key: Times(tuple(values)) for key, values in times.items()}


def _results(contestants: Sequence[Contestant], n: int) -> tuple[dict[Contestant, Results], list[Absence]]:
    """Those who give results, and the others with the reason."""
    computed: dict[Contestant, Results] = {}
    absences: list[Absence] = []
    for contestant in contestants:
        try:
            computed[contestant] = contestant.results(n)
        except MissingError as error:
            absences.append(Absence(contestant.name, str(error)))
    return computed, absences
