"""Prints figures of quality: errors, operation counts and times.

    python -m benchmarks.figures

Needs the extra `test` (Pinocchio and its robots). A time is that of one run on this machine; errors and
counts are reproducible.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np

import kanegen as kg
from kanegen.model.coordinates import FREEDOMS
from tests.support import systems
from tests.support.robots import dynamics, fixed_model, floating_model, places, robot_file

ROOT = Path(__file__).parent.parent
EIGHT_BODY = ROOT / "models" / "eight_body.toml"
FIXED = ("panda", "ur5_robot", "kinova", "allegro_right_hand", "double_pendulum")
FLOATING = ("hyq_no_sensors", "solo12")
STATES = 1000
TREES = 100


def main() -> None:
    warnings.simplefilter("ignore", kg.KanegenWarning)
    print(f"C against the NumPy reference, {STATES} random states")
    print(f"  eight_body: {errors(kg.compare(kg.load(EIGHT_BODY), states=STATES))}")
    print(f"  {TREES} random trees, N 1-12, worst: {random_trees():.1e}")
    print("C against Pinocchio crba and nonLinearEffects, 1000 random states, relative to the largest entry")
    for name, floating in [(name, False) for name in FIXED] + [(name, True) for name in FLOATING]:
        matrix, vector = robot(name, floating)
        print(f"  {name}{', floating base' * floating}: A {matrix:.1e}, f {vector:.1e}")
    print("whole processes")
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "kanegen", "generate", str(EIGHT_BODY), "-o", folder]
        elapsed = seconds(lambda: subprocess.run(command, check=True, stdout=subprocess.DEVNULL))
        print(f"  kanegen generate models/eight_body.toml: {elapsed:.2f} s")
    print("operations of A and f, additions + multiplications")
    print(f"  eight_body: {flops(kg.load(EIGHT_BODY))}")
    chain = bushes(10)
    elapsed = seconds(lambda: kg.generate(chain))
    print(f"  chain of ten six-freedom bodies: {flops(chain)}, generated in {elapsed:.2f} s")


def errors(report: kg.Report) -> str:
    return ", ".join(f"{a.output} {a.normwise:.1e}" for a in report.accuracies) + f", passed {report.passed}"


def random_trees() -> float:
    worst = 0.0
    for seed in range(TREES):
        rng = np.random.default_rng(seed)
        system = systems.random_system(rng, bodies=int(rng.integers(1, 13)))
        worst = max(worst, kg.compare(system, states=20).max_error)
    return worst


def robot(name: str, floating: bool) -> tuple[float, float]:
    path = robot_file(name)
    system = kg.load(path, floating_base=floating)
    model, several = floating_model(path, system) if floating else (fixed_model(path), {})
    order = places(system, model, several)
    states = np.random.default_rng(7).uniform(-2, 2, (2, STATES, len(order)))
    library = kg.build(system)
    worst = [0.0, 0.0]
    ours = zip(*states, library.mass_matrix(states[0]), library.forcing(*states), strict=True)
    for x, y, matrix, vector in ours:
        a, f = dynamics(model, order, x, y)
        worst[0] = max(worst[0], np.abs(matrix - a).max() / np.abs(a).max())
        worst[1] = max(worst[1], np.abs(vector - f).max() / np.abs(f).max())
    return worst[0], worst[1]


def bushes(bodies: int) -> kg.System:
    free = systems.flags(bodies, FREEDOMS)
    rng = np.random.default_rng(1)
    return systems.random_system(
        rng, bodies, connection=range(bodies), free=free, loads=False, orientations=False
    )


def flops(system: kg.System) -> int:
    operations = kg.generate(system).operations
    return operations["add"] + operations["multiply"]


def seconds(action: Callable[[], object]) -> float:
    start = time.perf_counter()
    action()
    return time.perf_counter() - start


if __name__ == "__main__":
    main()
