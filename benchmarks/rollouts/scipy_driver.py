"""The driver of rollouts by SciPy's DOP853, which calls kanegen's forward dynamics from Python.

    python -m benchmarks.rollouts.scipy_driver results|times STATES OUT|SECONDS LIBRARY STEP STEPS

LIBRARY is a file with the pickled library; kanegen/studies/bench/drivers/driver.h describes the rest.
"""

from __future__ import annotations

import pickle
import sys
import time
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from kanegen.library import Library
from kanegen.model.arguments import Floats
from kanegen.reference.states import ActuatedStates
from kanegen.studies.bench.states import read_states

TOLERANCE = 1e-9
"""Relative and absolute tolerance of a step."""


def main() -> None:
    """Write results or print the time, as the command line asks."""
    mode, path, last, library_path, step, steps = sys.argv[1:]
    library = pickle.loads(Path(library_path).read_bytes())
    states, duration = read_states(Path(path)), float(step) * int(steps)
    if mode == "results":
        ends(library, states, duration).tofile(Path(last))
        return
    passes, start = 0, time.perf_counter()
    while (elapsed := time.perf_counter() - start) < float(last) or not passes:
        ends(library, states, duration)
        passes += 1
    print("DOP853", f"{1e9 * elapsed / passes / len(states.x):.6g}")


def ends(library: Library, states: ActuatedStates, duration: float) -> Floats:
    """Return (B, 2 n) coordinates and speeds after a motion of `duration` seconds."""
    n = library.n
    found = []
    for x, y, tau in zip(states.x, states.y, states.tau, strict=True):

        def rates(t: float, state: Floats, tau: Floats = tau) -> Floats:
            return np.concatenate([state[n:], library.forward_dynamics(state[:n], state[n:], tau)])

        start = np.concatenate([x, y])
        solved = solve_ivp(rates, (0, duration), start, "DOP853", rtol=TOLERANCE, atol=TOLERANCE)
        found.append(solved.y[:, -1])
    return np.array(found)


if __name__ == "__main__":
    main()
