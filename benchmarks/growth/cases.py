"""The cases of the growth study: two families of trees, three outputs, and numbers of bodies that double."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

import kanegen as kg
from benchmarks.models import revolute_chain
from kanegen.model.coordinates import FREEDOMS

LARGEST = {"forcing": 256, "forward_dynamics": 256, "mass_matrix": 64}
"""Largest number of bodies for each output; [A] has the square of the freedoms as entries."""


def free_tree(bodies: int) -> kg.System:
    """Return a binary tree of asymmetrical bodies with six freedoms each."""
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
"""Functions from the number of bodies to a chain of hinges or a binary tree of free bodies."""


@dataclass(frozen=True)
class Curve:
    """A curve of the study: a family of trees and one output."""

    family: str
    output: str

    def __str__(self) -> str:
        return f"{self.output}, {self.family}"


CURVES = tuple(Curve(family, output) for output in LARGEST for family in FAMILIES)


@dataclass(frozen=True)
class Case:
    """A point of a curve: its number of bodies."""

    curve: Curve
    bodies: int

    def __str__(self) -> str:
        return f"{self.curve} of {self.bodies}"

    def system(self) -> kg.System:
        """Return the tree of this case."""
        return FAMILIES[self.curve.family](self.bodies)


def cases(most: int) -> Iterator[Case]:
    """Yield all curves at 1, 2, 4, ... bodies up to `most`, small trees first."""
    bodies = 1
    while bodies <= most:
        yield from (Case(curve, bodies) for curve in CURVES if bodies <= LARGEST[curve.output])
        bodies *= 2
