"""All experiments of the battery, in the order of their numbers."""

from __future__ import annotations

from collections.abc import Iterator

from tests.battery import (
    chains,
    compilers,
    conditioning,
    counterexamples,
    floating_point,
    gimbal_lock,
    gimbal_lock_passage,
    identities,
    invariances,
    motions,
    mutations,
    precisions,
    robustness,
    scaling,
    sine_cosine,
    targets,
)
from tests.battery.experiments import EXPERIMENTS, Experiment

MODULES = (
    chains,
    conditioning,
    gimbal_lock,
    gimbal_lock_passage,
    sine_cosine,
    scaling,
    floating_point,
    motions,
    identities,
    invariances,
    compilers,
    robustness,
    counterexamples,
    precisions,
    mutations,
    targets,
)
"""The modules of the experiments; importing them registers their experiments."""


def experiments() -> Iterator[Experiment]:
    """Yield all experiments by number."""
    for number in sorted(EXPERIMENTS, key=lambda name: int(name[1:])):
        yield EXPERIMENTS[number]
