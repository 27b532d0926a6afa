"""The driver in Python, which calls kanegen's functions as a user does: one state in each call.

    python -m kanegen.studies.bench.python_driver results|times STATES OUT|SECONDS LIBRARIES

LIBRARIES is a file with the two pickled libraries of a comparison; drivers/driver.h describes the rest.
"""

from __future__ import annotations

import pickle
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from kanegen.library import Library
from kanegen.reference.states import ActuatedStates
from kanegen.studies.bench.results import DYNAMICS, EQUATIONS, Results, write
from kanegen.studies.bench.states import read_states

Libraries = dict[str, Library]


def main() -> None:
    """Write results or print times, as the command line asks."""
    mode, states, last, path = sys.argv[1:]
    libraries: Libraries = pickle.loads(Path(path).read_bytes())
    if mode == "results":
        write(Path(last), results(libraries, read_states(Path(states))))
    else:
        for task, value in times(libraries, read_states(Path(states)), float(last)).items():
            print(task, f"{value:.6g}")


def results(libraries: Libraries, states: ActuatedStates) -> Results:
    """Compute all states, one in each call and all in one call."""
    rows = list(zip(states.x, states.y, states.tau, strict=True))
    equations = [libraries[EQUATIONS].evaluate(x, y) for x, y, _ in rows]
    dynamics = [libraries[DYNAMICS].forward_dynamics(x, y, tau) for x, y, tau in rows]
    together = libraries[EQUATIONS].evaluate(states.x, states.y)
    batch = libraries[DYNAMICS].forward_dynamics(states.x, states.y, states.tau)
    return {
        EQUATIONS: np.array([np.vstack([e.mass_matrix, e.forcing]) for e in equations]),
        DYNAMICS: np.array(dynamics)[:, None, :],
        f"{EQUATIONS} batch": np.concatenate([together.mass_matrix, together.forcing[:, None]], axis=1),
        f"{DYNAMICS} batch": batch[:, None, :],
    }


def times(libraries: Libraries, states: ActuatedStates, seconds: float) -> dict[str, float]:
    """Time all tasks; returns nanoseconds of one state by name of the task."""
    evaluate = libraries[EQUATIONS].evaluate
    forward_dynamics = libraries[DYNAMICS].forward_dynamics
    pairs = [(x, y) for x, y in zip(states.x, states.y, strict=True)]
    triples = [(x, y, tau) for x, y, tau in zip(states.x, states.y, states.tau, strict=True)]

    def equations() -> None:
        for x, y in pairs:
            evaluate(x, y)

    def dynamics() -> None:
        for x, y, tau in triples:
            forward_dynamics(x, y, tau)

    tasks: dict[str, Callable[[], object]] = {
        EQUATIONS: equations,
        DYNAMICS: dynamics,
        f"{EQUATIONS} batch": lambda: evaluate(states.x, states.y),
        f"{DYNAMICS} batch": lambda: forward_dynamics(states.x, states.y, states.tau),
    }
    return {task: mean(run, seconds) / len(pairs) for task, run in tasks.items()}


def mean(run: Callable[[], object], seconds: float) -> float:
    """Return the mean nanoseconds of a call over about `seconds`, after one call to warm up."""
    run()
    passes, start = 0, time.perf_counter()
    while (elapsed := time.perf_counter() - start) < seconds or not passes:
        run()
        passes += 1
    return 1e9 * elapsed / passes


if __name__ == "__main__":
    main()
