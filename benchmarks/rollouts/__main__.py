"""Time rollouts of kanegen's C beside loops of others on a robot, and write docs/rollout-times.md.

    python -m benchmarks.rollouts [--model NAME] [--states N] [--peer-states N] [--steps N] [--step S]
                                  [--rounds N] [--file FILE]

Run it on a quiet machine. It takes about ten minutes, and Pinocchio some to compile the first time.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks import models
from benchmarks.rollouts.document import Row, document
from benchmarks.rollouts.participants import COMPARED, ROLLOUT, Entrant, Length, builders, built
from kanegen.files import write_whole
from kanegen.measure.machine import INSTRUCTION_SETS, Machine
from kanegen.measure.timing import Rounds
from kanegen.model.system import System
from kanegen.reference.states import ActuatedStates, states_away_from_gimbal_lock
from kanegen.studies.bench.compare import take_turns
from kanegen.studies.bench.peers.problem import Problem
from kanegen.studies.bench.results import difference
from kanegen.studies.bench.states import without_couplings, without_loads_and_parameters, write_states

PAGE = Path(__file__).parents[2] / "docs" / "rollout-times.md"


def main() -> None:
    """Compare and time all programs, print the page, and write it."""
    options = _options()
    system, left_out = without_couplings(models.system(options.model))
    system, notes = without_loads_and_parameters(system)
    length = Length(options.step, options.steps)
    with tempfile.TemporaryDirectory() as folder:
        many = states_away_from_gimbal_lock(system, options.states)
        few = _first(many, min(options.peer_states, options.states))
        problem = Problem(system, few, write_states(few, Path(folder) / "states"), Path(folder))
        machine = Machine.here()
        sets = [name for name in INSTRUCTION_SETS if name in machine.processor]
        _say("building the programs; Pinocchio takes minutes the first time")
        entrants, missing = built(builders(problem, many, sets))
        rows = _rows(entrants, system, length, Rounds(options.rounds, 0.0))
    page = document(
        options.model, system, length, options.states, len(few.x), rows, [*left_out, *notes], missing, machine
    )
    print(page)
    write_whole(options.file, page)


def _rows(entrants: list[Entrant], system: System, length: Length, rounds: Rounds) -> list[Row]:
    """Return a row for each task, with its times and its difference from the first participant."""
    n = len(system.freedoms)
    short = replace(length, steps=min(COMPARED, length.steps))
    _say(f"comparing the motions after {short.steps} steps")
    results = [entrant.over(short).results(n) for entrant in entrants]
    standard = next(iter(results[0].values()))
    timed = {entrant.over(length): entrant for entrant in entrants}
    times = take_turns(timed, rounds, _say)
    rows = []
    for (participant, entrant), found in zip(timed.items(), results, strict=True):
        for task in participant.tasks:
            rows.append(
                Row(
                    participant.name,
                    entrant.methods[task.name],
                    participant.setting.name,
                    tuple(value / length.steps for value in times[participant, task.name].rounds),
                    difference(found[task.name], standard, ROLLOUT),
                )
            )
    return rows


def _first(states: ActuatedStates, count: int) -> ActuatedStates:
    """Return the first states of a sample."""
    return ActuatedStates(states.x[:count], states.y[:count], tau=np.asarray(states.tau)[:count])


def _options() -> argparse.Namespace:
    """Return the options of the command line."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.rollouts", description=(__doc__ or "").splitlines()[0]
    )
    parser.add_argument("--model", default="panda", choices=models.NAMES)
    parser.add_argument("--states", type=int, default=4096, help="states of a batch of kanegen")
    parser.add_argument("--peer-states", type=int, default=64, help="states on which the others are timed")
    parser.add_argument("--steps", type=int, default=Length.steps)
    parser.add_argument("--step", type=float, default=Length.step, help="length of a step (s)")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--file", type=Path, default=PAGE)
    return parser.parse_args()


def _say(stage: str) -> None:
    """Print a stage to the standard error."""
    print(stage, file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
