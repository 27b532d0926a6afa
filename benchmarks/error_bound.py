"""Print how far the proven bounds of accelerations lie above their errors, and what they cost.

python -m benchmarks.error_bound [--states COUNT] [MODEL ...]
"""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Sequence

import numpy as np

import kanegen as kg
from benchmarks import models
from kanegen.errors import KanegenWarning
from kanegen.studies.tradeoff.domain import default_domain
from kanegen.studies.tradeoff.exact_results import ExactResults

CLEARANCE = 0.05
"""Distance of the domains from gimbal lock."""

HEAD = """| model | bound / error: median | largest | least | operations | forward dynamics |
| --- | ---: | ---: | ---: | ---: | ---: |"""


def main() -> None:
    """Print a row for every model."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.error_bound", description=__doc__.splitlines()[0]
    )
    parser.add_argument("models", nargs="*", metavar="MODEL", default=("double_pendulum", "ur5", "panda"))
    parser.add_argument("--states", type=int, default=200, help="number of random states")
    options = parser.parse_args()
    print(HEAD)
    for name in options.models:
        print(f"| {name} | {' | '.join(_cells(_system(name), options.states))} |", flush=True)


def _system(name: str) -> kg.System:
    """Return a robot of `benchmarks.models`, or the model of this name in models/."""
    if name in models.NAMES:
        return models.system(name)
    return kg.load(models.EIGHT_BODY.with_name(f"{name}.toml"))


def _cells(system: kg.System, states: int) -> Sequence[str]:
    """Return the columns of one model after its name."""
    sample = default_domain(system, clearance=CLEARANCE).sample(states, 1)
    loads = [load for load in (sample.force, sample.torque) if load is not None]
    solving, bounding = (kg.build(system, (name,)) for name in ("forward_dynamics", "error_bound"))
    with warnings.catch_warnings(action="ignore", category=KanegenWarning):
        ydot = solving.forward_dynamics(sample.x, sample.y, sample.tau, *loads)
        bounds = bounding.error_bound(sample.x, sample.y, ydot, sample.tau, *loads)
    exact = ExactResults(system).states(sample)
    errors = [one.outputs["forward_dynamics"].distance(row) for one, row in zip(exact, ydot, strict=True)]
    ratios = np.linalg.norm(bounds, axis=1) / np.linalg.norm(errors, axis=1)
    figures = (f"{value:.2g}" for value in (np.median(ratios), ratios.max(), (bounds / errors).min()))
    costs = (library.source.operations for library in (bounding, solving))
    return (*figures, *(f"{sum(cost.values()) - cost['prepare']}" for cost in costs))


if __name__ == "__main__":
    main()
