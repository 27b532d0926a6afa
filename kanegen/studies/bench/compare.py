"""The comparison of programs on one model: their results must agree, then they are timed in turns."""

from __future__ import annotations

import tempfile
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from kanegen.errors import MissingError, OptionError, counted
from kanegen.measure.timing import Rounds, Times
from kanegen.model.description import require_unprescribed
from kanegen.model.system import System
from kanegen.options import Progress, quiet
from kanegen.reference.states import states_away_from_gimbal_lock
from kanegen.studies.bench.comparison import UNTIMED, Absence, BenchOptions, Comparison, Entry
from kanegen.studies.bench.participant import Participant
from kanegen.studies.bench.peers.registry import PEERS, participants
from kanegen.studies.bench.results import Results, difference, of_peers
from kanegen.studies.bench.settings import AS_SHIPPED, CONTRACTED, DEFAULT
from kanegen.studies.bench.states import limits_note, without_couplings, without_loads_and_parameters

ON_ALL_CORES = (DEFAULT, CONTRACTED, AS_SHIPPED)
"""The compiler settings of programs that are also timed on all cores."""


def compare(
    system: System,
    options: BenchOptions,
    progress: Progress = quiet,
    peers: Iterable[str] = PEERS,
    cores: int = 1,
) -> Comparison:
    """Time kanegen and its peers on `system`, in turns, after comparing their results.

    Args:
        system: The model; loads are switched off, run-time parameters become constants, and coupled freedoms
            move by themselves.
        options: Numbers of states and rounds, and the duration of each timing.
        progress: Function that receives the name of each stage.
        peers: Programs to time beside kanegen, names among `PEERS`.
        cores: Number of cores on which programs also run at the same time; 1 for no such times.

    Raises:
        BuildError: If there is no C compiler.
        MissingError: If no program can compute the model.
        OptionError: If a peer is unknown, a freedom is prescribed, or the generalized speeds are not the
            rates of the coordinates, which are the only ones that the peers know.
        SingularError: If [A] is singular in every state.
    """
    require_unprescribed(system, "bench")
    if not system.speeds_are_rates:
        raise OptionError(
            f"system {system.name!r}: its generalized speeds are components of angular velocities, and the "
            'peers know only rates of coordinates. Take system.with_speeds("angle_rates").'
        )
    independent, left_out = without_couplings(system)
    model, notes = without_loads_and_parameters(independent)
    with tempfile.TemporaryDirectory() as folder:
        states = states_away_from_gimbal_lock(model, options.states)
        present, absences = participants(model, states, Path(folder), peers, progress)
        progress("comparing their results")
        entries, failed = evaluate(present, len(model.freedoms), options, progress)
        if cores > 1:
            entries += on_all_cores(present, entries, options, cores, progress)
    if not entries:
        raise MissingError("; ".join(f"{absence.name}: {absence.reason}" for absence in absences + failed))
    notes = (*left_out, *notes, *limits_note(model))
    return Comparison(system.name, len(model.freedoms), tuple(entries), tuple(absences + failed), notes)


def evaluate(
    participants: Sequence[Participant], n: int, options: BenchOptions, progress: Progress
) -> tuple[list[Entry], list[Absence]]:
    """Compare the results of all participants and time those that agree.

    The standard of a quantity is the result of the first participant that computes it. A participant none of
    whose results agrees with the standard is not timed.

    Args:
        participants: The programs, ready to run.
        n: Number of freedoms of the model.
        options: Number of rounds and duration of each timing.
        progress: Function that receives the name of each stage.

    Returns:
        One entry for each task of each participant, and the participants that failed.
    """
    computed, absences = _results(participants, n)
    standard: Results = {}
    for participant, results in computed.items():
        for task in participant.tasks:
            standard.setdefault(of_peers(task.quantity), results[task.name])
    entries = {
        (participant, task.name): Entry(
            participant.name,
            participant.setting,
            task,
            error=difference(results[task.name], standard[of_peers(task.quantity)], task.quantity),
        )
        for participant, results in computed.items()
        for task in participant.tasks
    }
    agreeing = dict.fromkeys(participant for (participant, _), entry in entries.items() if entry.agrees)
    times = take_turns(agreeing, Rounds(options.rounds, options.seconds), progress)
    timed = [
        replace(entry, times=times.get(key, UNTIMED)) if entry.agrees else entry
        for key, entry in entries.items()
    ]
    return timed, absences


def on_all_cores(
    participants: Sequence[Participant],
    entries: Sequence[Entry],
    options: BenchOptions,
    cores: int,
    progress: Progress,
) -> list[Entry]:
    """Time programs that run once on every core at the same time.

    Args:
        participants: The programs, ready to run.
        entries: Their entries on one core; a task whose results do not agree is left out.
        options: Number of rounds and duration of each timing.
        cores: Number of cores.
        progress: Function that receives the name of each stage.
    """
    chosen = [
        one
        for one in participants
        if one.setting in ON_ALL_CORES and any(_is_of(entry, one) and entry.times.rounds for entry in entries)
    ]
    times = take_turns(chosen, Rounds(options.rounds, options.seconds), progress, cores)
    return [
        replace(entry, times=times[one, entry.task.name], cores=cores)
        for one in chosen
        for entry in entries
        if _is_of(entry, one) and entry.agrees
    ]


def _is_of(entry: Entry, participant: Participant) -> bool:
    """Return whether an entry belongs to a participant."""
    same = (entry.participant, entry.setting) == (participant.name, participant.setting)
    return same and entry.task in participant.tasks


def take_turns(
    participants: Iterable[Participant], rounds: Rounds, progress: Progress, cores: int = 1
) -> dict[tuple[Participant, str], Times]:
    """Time all participants in rounds, in each of which every participant has one turn.

    Returns:
        Times by participant and name of the task.

    Raises:
        MissingError: If a driver fails.
    """
    times: defaultdict[tuple[Participant, str], list[float]] = defaultdict(list)
    for turn in range(rounds.number):
        progress(f"timing on {counted(cores, 'core')}, round {turn + 1} of {rounds.number}")
        for participant in participants:
            for name, value in participant.times_together(rounds.seconds, cores).items():
                times[participant, name].append(value)
    return {key: Times(tuple(values)) for key, values in times.items()}


def _results(participants: Sequence[Participant], n: int) -> tuple[dict[Participant, Results], list[Absence]]:
    """Run every participant once and separate the failures, with their reasons, from the results."""
    computed: dict[Participant, Results] = {}
    absences: list[Absence] = []
    for participant in participants:
        try:
            computed[participant] = participant.results(n)
        except MissingError as error:
            absences.append(Absence(participant.name, str(error)))
    return computed, absences
