"""Prints proven bounds over the largest errors of random states; docs/bounds.md has the table.

    python -m benchmarks.bounds [--states N] [--precision NAME] [MODEL ...]

Needs the extra `test` (example-robot-data). Ratios are reproducible; a time is that of one run.
"""

from __future__ import annotations

import argparse
import time
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

import kanegen as kg
from kanegen.measure.bounds import read_domain
from kanegen.options import Variant
from tests.support.bound_search import Search
from tests.support.robots import robot_file

MODELS = Path(__file__).parent.parent / "models"
OUTPUTS = ("mass_matrix", "forcing", "inverse_dynamics")
ROBOTS = {"ur5": "ur5_robot", "panda with fingers": "panda"}
NAMES = ("planar_pendulum", "double_pendulum", "ur5", "panda_arm", "panda with fingers", "eight_body")
PANDA = (2.8973, 1.7628, 2.8973, (-3.0718, -0.0698), 2.8973, (-0.0175, 3.7525), 2.8973)
"""Limits of the joints (rad), about 0 where there is one number."""

CHUNK = 5000
"""Number of states that are evaluated at once."""


def main() -> None:
    """Print a row for every model, box and output."""
    warnings.simplefilter("ignore", kg.KanegenWarning)
    parser = argparse.ArgumentParser()
    parser.add_argument("--states", type=int, default=100_000)
    parser.add_argument("--precision", default="double")
    parser.add_argument("models", nargs="*", default=NAMES)
    arguments = parser.parse_args()
    print(f"{arguments.precision}, {arguments.states} random states")
    print("| model | box | output | bound / largest error, median | largest | seconds |")
    print("| --- | --- | --- | ---: | ---: | ---: |")
    for name in arguments.models:
        for row in _rows(name, arguments.precision, arguments.states):
            print(f"| {' | '.join(row)} |", flush=True)


def _rows(name: str, precision: str, states: int) -> Iterator[tuple[str, ...]]:
    """Yield the rows of a model."""
    path = robot_file(ROBOTS[name]) if name in ROBOTS else MODELS / f"{name}.toml"
    system = kg.load(path)
    for box in ("full", "small"):
        table = _table(system, name, box)
        for output in OUTPUTS:
            library = kg.build(system, [output], tier=Variant(precision=precision))
            start = time.perf_counter()
            bounds = kg.bound(library, table)[output].ravel()
            seconds = time.perf_counter() - start
            found = Search(library, read_domain(table, system))
            errors = np.zeros(bounds.size)
            for k in range(0, states, CHUNK):
                errors = np.maximum(errors, found.errors(output, found.random(CHUNK, seed=k)).max(axis=0))
            ratios = bounds[errors > 0] / errors[errors > 0]
            ratio = f"{np.median(ratios):.3g}", f"{ratios.max():.3g}"
            yield name, box, output, *ratio, f"{seconds:.1f}"


def _table(system: kg.System, name: str, box: str) -> dict[str, Any]:
    """Return the ranges of a box: whole turns or limits of joints, or 0.1 rad or m about 0."""
    kinds = {coordinate.unit for coordinate in system.coordinates}
    sizes = {"rad": ("angles", np.pi), "m": ("translations", 1.0)}
    x = {
        key: [-size, size] if box == "full" else [-0.1, 0.1] for u, (key, size) in sizes.items() if u in kinds
    }
    if "panda" in name and box == "full":
        limits = [[-one, one] if isinstance(one, float) else list(one) for one in PANDA]
        x = {f"panda_joint{k}": limit for k, limit in enumerate(limits, start=1)}
        x |= {other: [0.0, 0.04] for other in system.coordinate_names if "finger" in other}
    rates = {sizes[unit][0]: 2.0 for unit in kinds if unit in sizes}
    table: dict[str, Any] = {"x": x}
    table["y"] = {key: [-size, size] for key, size in rates.items()}
    table["ydot"] = {key: [-2.5 * size, 2.5 * size] for key, size in rates.items()}
    if any(body.loads for body in system.bodies):
        table |= {kind: {"all": [-10.0, 10.0]} for kind in ("force", "torque")}
    return table


if __name__ == "__main__":
    main()
