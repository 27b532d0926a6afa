"""Forward dynamics of models with parameters is as accurate as that of models with numbers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import kanegen as kg
from kanegen.program.precision import precision_named
from tests.support import systems
from tests.support.status_search import Evaluator

ROUNDOFFS = 128.0
"""Largest error beyond that of numbers, which are folded exactly. Moments across the hinge have errors of
a few roundoffs of m d^2 times squares of speeds; the inertia that they accelerate is at least m d^2."""


def slender(distance: float, precision: str, turn: float = 0.0, *, lifted: bool = False) -> kg.System:
    """Return a body with a small one far along its hinge, whose mass and distance are parameters.

    Both inertias about axes across the hinge have the term m d^2, which turns about the hinge do not feel.

    Args:
        distance: Distance of the small body (m).
        precision: Precision to which numbers are rounded.
        turn: Constant turn of the hinge (rad).
        lifted: Whether the mass centre instead of the joint is far away along the hinge.
    """
    dtype = precision_named(precision).dtype.type
    mass, far = float(dtype(1.1e-3)), float(dtype(distance))
    across = [1.43e-5, 2.2e-5, 1.9e-5]
    plain = kg.System.from_arrays(
        connection=[0, 1],
        mass=[1.0, mass],
        inertia=[np.diag([0.3, 0.4, 0.2]), np.diag([float(dtype(value)) for value in across])],
        mass_center=np.zeros((2, 3)),
        joint_position=[[0, 0, 0], [0.25, 0, 0]],
        free=np.eye(6, dtype=bool)[[0, 2]],
        locked=[[0] * 6, [turn, 0, 0, 0, 0, 0]],
        gravity=(0.0, 0.0, 0.0),
        name="slender",
    )
    length, first = kg.Parameter("d", far), plain.bodies[0]
    small = replace(plain.bodies[1], mass=kg.Parameter("m", mass))
    if lifted:
        small = replace(small, mass_center=(0.0, 0.0, length))
    else:
        small = replace(small, joint=replace(small.joint, position=(0.25, 0.0, length)))
    return replace(plain, bodies=(first, small))


def largest_error(system: kg.System, precision: str, tau: float = 0.0) -> float:
    """Return the largest error of {ydot} by certified truth in free motion or under equal efforts (u)."""
    evaluator = Evaluator(system, precision)
    x, y = np.random.default_rng(1).uniform(-1, 1, (2, 8, len(system.freedoms)))
    tried = evaluator.tried(x, y, np.full_like(x, tau))
    assert (tried.silent > 0).all()
    return max(evaluator.certified_error(tried, i) for i in range(8))


FAR = pytest.mark.parametrize(
    ("precision", "distance"), [("double", 51.3), ("double", 3.17e4), ("float", 1.13e6)]
)


@FAR
@pytest.mark.parametrize(("lifted", "turn"), [(False, 0.0), (True, 0.0), (True, 0.5)])
def test_a_term_that_both_inertias_have_is_not_in_their_difference(
    precision: str, distance: float, turn: float, lifted: bool
) -> None:
    system = slender(distance, precision, turn, lifted=lifted)
    numbers = largest_error(systems.from_values(system.values()), precision)
    assert largest_error(system, precision) <= numbers + ROUNDOFFS


@FAR
def test_a_welded_body_described_from_afar(precision: str, distance: float) -> None:
    """Its mass centre is close to the hinge, its point O_K is not: m (r^2 - 2 r d + d^2) is small."""
    plain = slender(distance, precision)
    far = plain.bodies[1].joint.position[2].value
    joint = replace(plain.bodies[1].joint, position=(0.25, 0.0, far), free=(False,) * 6)
    welded = replace(plain.bodies[1], mass_center=(0.0, 0.0, -far), joint=joint)
    assert largest_error(replace(plain, bodies=(plain.bodies[0], welded)), precision, 1.0) <= ROUNDOFFS
