"""No large error of {ydot} is without a status: a search over trees and states, and bounds of pivots."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.lowering.definitions import lower_definitions
from kanegen.lowering.losses import array_inputs, largest_losses
from kanegen.model.rotations import rotation_123
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import Array
from kanegen.recursion.outputs import input_arrays
from kanegen.recursion.pivot_bounds import PivotBounds
from kanegen.recursion.principal_inertia import largest_inertia, least_inertia
from kanegen.recursion.tree import Derived, tree
from kanegen.reference import equations as reference
from kanegen.reference.states import States, random_states
from tests.support import robots, systems
from tests.support.cases import slow_among, slow_except
from tests.support.paths import MODELS
from tests.support.refinement import rods
from tests.support.status_search import (
    FORWARD,
    LARGEST_ERROR,
    TREES,
    Evaluator,
    climbed,
    largest_unreported,
    states,
)

SOLVERS = ("cheapest", "cheapest", "articulated bodies", "factorisation")
SPREAD = {"float": 4.0, "double": 8.0}
"""Masses are from 10^-spread to 10^spread kg."""


def search(precision: str, trees: int, count: int, rounds: int, seed: int) -> tuple[float, int]:
    """Return the largest unreported error, and the number of evaluated states."""
    worst, evaluated = 0.0, 0
    for number in range(trees):
        rng = np.random.default_rng([seed, number])
        system = TREES[number % len(TREES)](rng, SPREAD[precision])
        evaluator = Evaluator(system, precision, solver=SOLVERS[rng.integers(len(SOLVERS))])
        found = states(rng, evaluator, count)
        for more in (found, climbed(rng, evaluator, found, rounds)):
            worst = max(worst, largest_unreported(evaluator, more))
        evaluated += count + rounds * len(found.x)
    return worst, evaluated


@pytest.mark.parametrize("precision", slow_except(("float", "double"), "double"))
def test_no_large_error_is_without_a_status(precision: str) -> None:
    worst, _ = search(precision, trees=8, count=100, rounds=3, seed=1)
    assert worst <= LARGEST_ERROR


@pytest.mark.slow
@pytest.mark.parametrize("precision", ["float", "double"])
def test_a_long_search_finds_no_large_error_without_a_status(precision: str) -> None:
    worst, evaluated = search(precision, trees=200, count=100, rounds=5, seed=2)
    assert worst <= LARGEST_ERROR
    assert evaluated >= 50_000


def test_the_search_would_find_errors() -> None:
    """Without refinement the same trees have large errors, and every one of them has a status."""
    largest = []
    for seed in range(4):
        rng = np.random.default_rng(seed)
        evaluator = Evaluator(TREES[3](rng, 6.0), "float", refinement=0, solver="factorisation")
        found = states(rng, evaluator, 60)
        largest.append(np.nan_to_num(found.error, nan=np.inf).max())
        assert largest_unreported(evaluator, found) <= LARGEST_ERROR
    assert max(largest) > 100 * LARGEST_ERROR


@pytest.mark.parametrize("light", [1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("turn", [0.0, 2.0])
def test_an_elbow_whose_first_link_is_light(light: float, turn: float) -> None:
    rng = np.random.default_rng(5)
    locked = np.zeros((2, 6))
    locked[1, 0] = turn
    plain = rods(1.0 / light, 2)
    arrays = plain.values()
    arrays.locked[:] = locked
    evaluator = Evaluator(systems.from_values(arrays), "double")
    found = states(rng, evaluator, 60)
    assert largest_unreported(evaluator, found) <= LARGEST_ERROR


@pytest.mark.parametrize("mass", [1e-6, 1.0, 1e3, 1e6])
def test_parameters_far_from_their_defaults(mass: float) -> None:
    """The generator decides for a tip of 1 kg; a tip of a thousand tonnes is reported where it matters."""
    plain = rods(1.0, 2)
    tip = replace(plain.bodies[1], mass=kg.Parameter("tip", 1.0))
    system = replace(plain, bodies=(plain.bodies[0], tip))
    evaluator = Evaluator(system, "double", {"tip": mass})
    found = states(np.random.default_rng(6), evaluator, 200)
    assert largest_unreported(evaluator, found) <= LARGEST_ERROR
    assert (found.silent > 0).all() == (mass <= 1.0)


@pytest.mark.parametrize("precision", ["float", "double"])
@pytest.mark.parametrize("scale", [1.0, 1e-3, 1e-6])
def test_vertical_rods_that_move_slowly(scale: float, precision: str) -> None:
    """Gravity has no effect here, so it is no yardstick for the error of {ydot}."""
    rng = np.random.default_rng(7)
    system = replace(rods(10 ** (6 / 5), 6), gravity=(9.81, 0.0, 0.0))
    evaluator = Evaluator(system, precision)
    y = scale * rng.uniform(-1, 1, (20, 6))
    found = evaluator.tried(1e-9 * y, y, np.zeros((20, 6)))
    assert largest_unreported(evaluator, found) <= LARGEST_ERROR
    assert (found.silent > 0).all()


@pytest.mark.parametrize("seed", slow_except(range(20), *range(8)))
def test_bounds_of_pivots_hold(seed: int) -> None:
    """A pivot is no larger than its diagonal entry of [A], which is no larger than the bound: a loss is >= 1.

    With bounds of losses from below, no loss that any state has is larger.
    """
    rng = np.random.default_rng(seed)
    system = TREES[0](rng, 3.0) if seed < 6 else systems.random_system(rng, 4)
    for solver in ("articulated bodies", "factorisation"):
        found = largest_losses(system, solver)
        assert (found.largest >= 1 - 1e-9).all()
        assert (found.largest <= found.bounds * (1 + 1e-9)).all()
        assert np.isfinite(found.bounds).any() or seed >= 6


def sliding(turn: float, names: list[str]) -> kg.System:
    """A post on a hinge about axis 3, and a load on rails that are turned about it by an angle (rad)."""
    free = np.zeros((2, 6), dtype=bool)
    free[0, 2] = True
    free[1, [("s1", "s2", "s3").index(name) + 3 for name in names]] = True
    return kg.System.from_arrays(
        [0, 1],
        [2.0, 5.0],
        [np.diag([0.1, 0.2, 0.3]), np.diag([1e-3, 2e-3, 3e-3])],
        [[0.0, 0.0, 0.1], [0.02, 0.0, 0.0]],
        [[0.0, 0.0, 0.0], [0.0, 0.1, 0.0]],
        [np.eye(3), rotation_123((0.0, 0.0, turn))],
        free,
    )


@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_what_slides_on_a_carried_body(turn: float) -> None:
    """One slide across the axis of a hinge leaves its loss bounded by constants, a second one does not."""
    for names, is_bounded in ((["s1"], True), (["s1", "s3"], True), (["s1", "s2"], False)):
        found = largest_losses(sliding(turn, names), "articulated bodies")
        across = 5.0 * (0.1 * np.cos(turn)) ** 2  # what the slide can follow: its pull on the load is free
        expected = (0.303 + across) / 0.303 if is_bounded else np.inf
        assert found.bounds[0] == pytest.approx(expected, rel=1e-12)
        assert (found.largest <= found.bounds * (1 + 1e-9)).all()


@pytest.mark.filterwarnings("ignore:.*triangle")
def test_principal_inertias_are_bounded_closely() -> None:
    rng = np.random.default_rng(0)
    for _ in range(200):
        basis = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        inertia = basis @ np.diag(10.0 ** rng.uniform(-4, 4, 3)) @ basis.T
        body = kg.Body("one", 0, 1.0, (inertia + inertia.T) / 2)
        values = np.linalg.eigvalsh((inertia + inertia.T) / 2)
        slack = 1e-14 * values[-1]
        assert values[-1] - slack <= float(largest_inertia(body)) <= 1.05 * values[-1]
        assert 0.95 * values[0] - slack <= float(least_inertia(body)) <= values[0] + slack


def carried(system: kg.System, states: States) -> np.ndarray:
    """Return the (B, n) bounds of the inertias that the freedoms of a tree carry."""
    prepared = tree(system)
    bounds = PivotBounds(prepared, together=False)
    n = len(system.freedoms)
    derived = Derived([bounds.carried(i) for i in range(n)])
    program = lower_definitions(
        input_arrays(system), prepared.definitions.listed(), {Array("bounds", (n,), "", ""): derived}
    )
    rows = evaluate(program, array_inputs(system, program, states), np)["bounds"]
    return np.stack([np.broadcast_to(row, len(states)) for row in rows], axis=-1)


@pytest.mark.parametrize("seed", range(8))
def test_the_bound_of_carried_inertias_holds(seed: int) -> None:
    """No diagonal entry of [A] is larger in any state, and some come near the bound."""
    system = TREES[0](np.random.default_rng(seed), 3.0)
    if seed >= 5:
        system = systems.random_system(np.random.default_rng(seed), 4)
    states = random_states(system, 4000, seed)
    matrix = reference.mass_matrix(system, states.x)
    share = np.diagonal(matrix, axis1=1, axis2=2) / carried(system, states)
    assert share.max() <= 1 + 1e-12
    assert share.max(axis=0).min() >= 0.02


TESTED = {
    "eight_body": 0,
    "front_of_eight": 0,
    "double_pendulum": 0,
    "panda_arm": 3,
    "six_revolute_arm": 1,
    "gantry_crane": 1,
}
"""Number of pivots that are tested in every state."""


@pytest.mark.parametrize("name", slow_among(TESTED, "panda_arm", "eight_body"))
def test_constants_exclude_most_tests(name: str) -> None:
    program = compile_module(kg.load(MODELS / f"{name}.toml"), FORWARD).module.functions["forward_dynamics"]
    (output,) = program.outputs
    numbers = [program.instructions[value] for value in output.accurate_if_positive]
    assert sum(not one.number > 0 and one.array == "" for one in numbers) == TESTED[name]


@pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")
@pytest.mark.parametrize("name", slow_except(("ur5_robot", "double_pendulum"), "double_pendulum"))
def test_ordinary_robots_have_no_status(name: str) -> None:
    system = kg.load(robots.robot_file(name))
    evaluator = Evaluator(system, "double")
    found = states(np.random.default_rng(8), evaluator, 2000)
    assert (found.silent > 0).all()
