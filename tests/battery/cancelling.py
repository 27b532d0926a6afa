"""Right-hand sides of which almost nothing is left, and numbers below the normal ones: X18 and X19."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator

import numpy as np

from kanegen.reference import equations as reference
from kanegen.reference.states import random_states
from tests.battery import scenes
from tests.battery.measuring import PRECISIONS, PROMISE, built, forward, points, worst
from tests.battery.rows import Point, Row, Size, count, subject
from tests.support.paths import ROOT


@subject("X18", "Efforts that almost hold the tree")
def near_equilibrium(size: Size) -> Iterator[Row]:
    """{tau} = -{f} (1 + 10^-k): the error may grow as chi does, and not beyond."""
    system = scenes.tree(np.random.default_rng(18), [0, 1, 1, 2])
    powers = size.pick([0, 4, 8, 16], range(17))
    for precision in PRECISIONS:
        found: list[Point] = []
        for power in powers:
            states = random_states(system, 4, 18).rounded(precision)
            tau = -reference.forcing(system, states.x, states.y) * (1 + 10.0**-power)
            found += points(10.0**-power, forward(system, precision, states, tau))
        over = f"k = 0 to {powers[-1]}, 4 states each; 4 hinges"
        yield worst(precision.name, found, PROMISE, over)


@subject("X19", "Subnormal numbers, and the state of the processor")
def subnormals(size: Size) -> Iterator[Row]:
    """One hinge of inertia 1 without gravity passes {tau} on, to the smallest number."""
    del size
    system = scenes.planar([0.0], inertia=[np.eye(3)], gravity=(0.0, 0.0, 0.0))
    for precision in PRECISIONS:
        library = built(system, precision)
        least = float(np.finfo(precision.dtype).smallest_subnormal)
        tau = np.array([[least * k] for k in (1, 2, 3, 1000, -1, -7, 2**20)])
        still = np.zeros_like(tau)
        found = library.forward_dynamics(still, still, tau).astype(np.float64)
        yield count(f"{precision.name}", found != tau, f"{len(tau)} efforts from {least:.0e}", "same bits")
    for name, options in FLAGS.items():
        yield count(
            f"the process after loading, {name}",
            [not _keeps_subnormals(options)],
            "a fresh process: half of 1e-310 before and after",
            "subnormals stay",
        )


FLAGS = {"default flags": "", "flags -O3 -ffast-math": "-O3 -ffast-math"}

_SCRIPT = """
import sys
import numpy as np
from tests.battery import scenes
import kanegen as kg
half = np.array([0.5])
assert (np.array([1e-310]) * half)[0] > 0
library = kg.build(scenes.straight(1), ("forward_dynamics",), flags=sys.argv[1] or None)
library.forward_dynamics([0.1], [0.2])
print((np.array([1e-310]) * half)[0] > 0)
"""


def _keeps_subnormals(options: str) -> bool:
    """Whether NumPy still computes with subnormals in a process that has loaded a library."""
    root = ROOT
    command = [sys.executable, "-W", "ignore", "-c", _SCRIPT, options]
    printed = subprocess.run(command, cwd=root, check=True, capture_output=True, text=True).stdout
    return printed.strip() == "True"
