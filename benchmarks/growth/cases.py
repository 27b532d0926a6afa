"""What is measured: two families of trees, three outputs, doubled until the largest."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

import kanegen as kg
from benchmarks.models import revolute_chain
from kanegen.model.coordinates import FREEDOMS

LARGEST = {"forcing": 256, "forward_dynamics": 256, "mass_matrix": 64}
"""Bodies; [A] itself has as many entries as freedoms squared."""


def free_tree(bodies: int) -> kg.System:
    """A binary tree of bodies with six freedoms each; nothing about them is symmetrical."""
    rng = np.random.default_rng(bodies)
    points = rng.uniform(-0.1, 0.1, (bodies, 6, 3))
    points -= points.mean(axis=1, keepdims=True)
    second = np.einsum("kpi,kpj->kij", points, points) / 6
    return kg.System.from_arrays(
        connection=[k // 2 for k in range(1, bodies + 1)],
        mass=np.ones(bodies),
        inertia=np.trace(second, axis1=1, axis2=2)[:, None, None] * np.eye(3) - second,
        mass_center=rng.uniform(-0.1, 0.1, (bodies, 3)),
        joint_position=rng.uniform(-0.2, 0.2, (bodies, 3)),
        free=np.ones((bodies, len(FREEDOMS)), dtype=bool),
        name=f"tree{bodies}",
    )


FAMILIES: dict[str, Callable[[int], kg.System]] = {"chain": revolute_chain, "tree": free_tree}
"""Chains of hinges, and binary trees of bodies with six freedoms."""


@dataclass(frozen=True)
class Curve:
    """A family and one output."""

    family: str
    output: str

    def __str__(self) -> str:
        return f"{self.output}, {self.family}"


CURVES = tuple(Curve(family, output) for output in LARGEST for family in FAMILIES)


@dataclass(frozen=True)
class Case:
    """One point of a curve."""

    curve: Curve
    bodies: int

    def __str__(self) -> str:
        return f"{self.curve} of {self.bodies}"

    def system(self) -> kg.System:
        """The tree."""
        return FAMILIES[self.curve.family](self.bodies)


def cases(most: int) -> Iterator[Case]:
    """Every curve at 1, 2, 4, ... bodies, no more than `most`; the small ones first."""
    bodies = 1
    while bodies <= most:
        yield from (Case(curve, bodies) for curve in CURVES if bodies <= LARGEST[curve.output])
        bodies *= 2
