"""Derivatives of inverse dynamics by composite bodies: against tangents in many digits, and their cost."""

from __future__ import annotations

from dataclasses import replace

import pytest

from benchmarks import models
from kanegen.compiler import compile_module
from kanegen.program.count import count
from tests.support import prescribed_trees, random_trees
from tests.support.cases import slow_except
from tests.support.derived_ways import agree
from tests.support.systems import eight_body

NAMES = ("inverse_dynamics_derivatives", "forcing_derivatives")
WITHIN = 1e-13
"""Share of the largest derivative: rounding of constants, which both ways have as doubles."""


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("seed", slow_except(range(24), 3))
def test_random_trees_of_all_kinds(seed: int, name: str) -> None:
    """With force elements, loads on bodies and points, motors, rotors, couplings and parameters."""
    agree(random_trees.everything(seed, bodies=3), name, seed, WITHIN)


@pytest.mark.parametrize("kind", ["slides and hinges", "sequences", "welded", "rates"])
@pytest.mark.parametrize("seed", slow_except(range(4), 2))
def test_prescribed_motion(kind: str, seed: int) -> None:
    agree(prescribed_trees.tree(kind, seed), "inverse_dynamics_derivatives", seed, WITHIN)


def test_six_freedoms_a_body() -> None:
    system = eight_body()
    agree(replace(system, bodies=system.bodies[:2]), "inverse_dynamics_derivatives", 1, WITHIN)


@pytest.mark.parametrize("name", slow_except(NAMES, *NAMES[:1]))
@pytest.mark.parametrize("coordinates", slow_except(("angles", "quaternion"), "quaternion"))
def test_angular_velocities(coordinates: str, name: str) -> None:
    system = eight_body().with_speeds("angular_velocity").with_coordinates(coordinates)
    agree(replace(system, bodies=system.bodies[:3]), name, 1, WITHIN)


OPERATIONS = {
    "ur5": 1245,
    "panda": 3057,
    "go2": 6599,
    "hyq": 8491,
    "eight_body": 19296,
    "chain20": 21577,
    "talos_reduced": 24546,
}
"""Additions, multiplications and divisions of all derivatives by {x} and {y}, by robot."""


@pytest.mark.parametrize("name", slow_except(OPERATIONS, "ur5"))
def test_operations(name: str) -> None:
    module = compile_module(models.system(name), ("inverse_dynamics_derivatives",)).module
    counts = count(module.functions["inverse_dynamics_derivatives"])
    assert sum(counts[kind] for kind in ("add", "multiply", "divide")) == OPERATIONS[name]
