"""The Coriolis matrix: by the reference, by what it must satisfy, and by Pinocchio."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.program.ir import Op
from kanegen.reference import coriolis as reference
from kanegen.reference import equations
from kanegen.reference.states import random_states
from tests.support import prescribed_trees, random_trees, systems
from tests.support.cases import slow_among, slow_except
from tests.support.couplings import random_couplings, released
from tests.support.orientation_trees import KINDS, tree_of_kind
from tests.support.pinocchio_tree import PinocchioTree
from tests.support.programs import values
from tests.support.random_trees import Drawing, with_motors, with_rotors
from tests.support.robots import FIXED_ROBOTS, fixed_model, places, robot_file

STEP = 1e-30


def given(system: kg.System, seed: int) -> dict[str, Any]:
    """Return a random state, without loads."""
    states = random_states(system, 1, seed)
    return {"x": states.x[0], "y": states.y[0]}


def found(system: kg.System, state: dict[str, Any]) -> np.ndarray:
    """Return [C] by the program that becomes C."""
    n = len(system.freedoms)
    return np.array(values(system, ("coriolis_matrix",), state)["C"], float).reshape(n, n)


def rate_of_mass_matrix(system: kg.System, state: dict[str, Any]) -> np.ndarray:
    """Return [dA/dt] by a complex step of the reference along the motion."""
    xdot = np.array(values(system, ("coordinate_rates",), state)["xdot"], float)
    moved = {"x": state["x"] + 1j * STEP * xdot}
    if "prescribed" in state:
        motion = state["prescribed"]
        moved["prescribed"] = motion + 1j * STEP * np.array([motion[1], motion[2], 0 * motion[2]])
    return equations.mass_matrix(system, **moved).imag / STEP


def close(one: np.ndarray, other: np.ndarray, factor: float) -> None:
    """Check that two matrices differ by no more than `factor` times their largest entry, or a usual one."""
    assert np.abs(one - other).max() <= factor * max(np.abs(other).max(), 0.01)


@pytest.mark.parametrize("seed", slow_except(range(40), 0, 1, 3))
def test_random_trees_of_all_kinds(seed: int) -> None:
    """Against the reference; [C]{y} is what motion causes, and [dA/dt] = [C] + [C]^T, which is skewness."""
    system = random_trees.everything(seed)
    state = given(system, seed)
    matrix = found(system, state)
    close(matrix, reference.coriolis_matrix(system, state["x"], state["y"]), 1e-13)
    close(matrix @ state["y"], -reference.velocity_forces(system, state["x"], state["y"]), 1e-12)
    close(matrix + matrix.T, rate_of_mass_matrix(system, state), 1e-12)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", slow_except(range(6), 0))
def test_angles_angular_velocities_and_quaternions(kind: str, seed: int) -> None:
    system = tree_of_kind(kind, seed)
    state = given(system, seed)
    matrix = found(system, state)
    close(matrix, reference.coriolis_matrix(system, state["x"], state["y"]), 1e-13)
    close(matrix + matrix.T, rate_of_mass_matrix(system, state), 1e-12)


@pytest.mark.parametrize("seed", slow_except(range(8), 0, 1))
def test_rates_as_speeds_give_christoffel_symbols(seed: int) -> None:
    """[C] is half the derivative of [C]{y} by {y}, exact by complex steps; with rotors and couplings, too."""
    rng = np.random.default_rng(seed)
    bare = systems.random_system(rng, 4, loads=False)
    bodies = with_motors(list(bare.bodies), Drawing(rng, 0.0))
    system = with_rotors(kg.System("rated", tuple(bodies), bare.gravity), Drawing(rng, 0.0))
    system = random_couplings(system, rng, 0.3, 0.0) if seed % 2 else system
    state = given(system, seed)
    directions = np.eye(len(state["y"]))
    slopes = [
        -reference.velocity_forces(system, state["x"], state["y"] + 1j * STEP * one).imag / STEP
        for one in directions
    ]
    close(found(system, state), np.array(slopes).T / 2, 1e-12)


@pytest.mark.parametrize("kind", slow_among(prescribed_trees.KINDS, "sequences"))
def test_prescribed_motion_counts_in_the_rates_of_partial_velocities(kind: str) -> None:
    """[C] is a block of that of the same tree with its prescribed freedoms free; skewness holds."""
    system = prescribed_trees.tree(kind, 1)
    state = {name: prescribed_trees.state(system, 3)[name] for name in ("x", "y", "prescribed")}
    matrix = found(system, state)
    close(matrix, reference.coriolis_matrix(system, state["x"], state["y"], state["prescribed"]), 1e-13)
    close(matrix + matrix.T, rate_of_mass_matrix(system, state), 1e-12)
    other = prescribed_trees.freed(system)
    names = (*system.freedom_names, *system.prescribed_names)
    order = [names.index(name) for name in other.freedom_names]
    whole = {"y": np.concatenate([state["y"], state["prescribed"][1]])[order]}
    every = (*system.coordinate_names, *system.prescribed_names)
    order_x = [every.index(name) for name in other.coordinate_names]
    whole["x"] = np.concatenate([state["x"], state["prescribed"][0]])[order_x]
    rows = [other.freedom_names.index(name) for name in system.freedom_names]
    close(found(other, whole)[np.ix_(rows, rows)], matrix, 1e-12)


def test_a_free_body() -> None:
    """With its angular velocity as speeds: the skew matrix of tr[I]/2 {w} - [I]{w}, about the mass centre."""
    sizes, w = np.array([3.0, 4.0, 5.0]), np.array([0.5, -1.0, 2.0])
    body = kg.Body("body", 0, 2.0, np.diag(sizes), joint=kg.Joint(coordinates="quaternion"))
    system = kg.System("body", (body,))
    state = {"x": [0.5, 0.1, -0.7, 0.2, 1.0, 2.0, 3.0], "y": [*w, 4.0, 5.0, 6.0]}
    u = 6.0 * w - sizes * w
    expected = np.zeros((6, 6))
    expected[:3, :3] = [[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]]
    assert found(system, state) == pytest.approx(expected, abs=1e-14)


@pytest.mark.filterwarnings("ignore::kanegen.KanegenWarning")
@pytest.mark.parametrize("name", slow_except(FIXED_ROBOTS, "double_pendulum", "ur5_robot"))
def test_robots_against_pinocchio(name: str) -> None:
    """With one freedom a joint Pinocchio computes the same matrix; batches, and single precision."""
    path = robot_file(name)
    system, model = kg.load(path), fixed_model(path)
    data, order = model.createData(), places(system, model, {})
    outputs = ("gravity_forces", "velocity_forces", "coriolis_matrix")
    library, single = kg.build(system, outputs), kg.build(system, outputs, precision="float")
    states = np.random.default_rng(5).uniform(-2, 2, (2, 20, len(order)))
    batch, rough = library.evaluate(*states), single.evaluate(*states)
    for k, (x, y) in enumerate(zip(*states, strict=True)):
        q, v = pin.integrate(model, pin.neutral(model), x[order]), y[order]
        gravity = -pin.computeGeneralizedGravity(model, data, q)
        motion = -pin.nonLinearEffects(model, data, q, v) - gravity
        every = [(gravity, "gravity_forces"), (motion, "velocity_forces")]
        if not system.couplings:
            every.append((pin.computeCoriolisMatrix(model, data, q, v), "coriolis_matrix"))
        for theirs, output in every:
            arguments = (x,) if output == "gravity_forces" else (x, y)
            size = np.abs(theirs).max()
            one, many, floats = (
                np.asarray(value)[(*[order] * theirs.ndim,)]
                if theirs.ndim < 2
                else value[np.ix_(order, order)]
                for value in (
                    getattr(library, output)(*arguments),
                    getattr(batch, output)[k],
                    getattr(rough, output)[k],
                )
            )
            assert np.abs(one - theirs).max() <= 1e-12 * size, output
            assert np.abs(many - theirs).max() <= 1e-12 * size, output
            assert np.abs(floats - theirs).max() <= 1e-5 * size, output


@pytest.mark.parametrize("seed", slow_except(range(12), 0, 1))
def test_random_trees_against_pinocchio(seed: int) -> None:
    """Slides, hinges and three angles in one joint, which are joints in a row there."""
    rng = np.random.default_rng(seed)
    system = systems.random_system(rng, 5, loads=False, armature=rng.uniform(0, 1, (5, 6)))
    _agrees_with_joints_in_a_row(system, seed)


@pytest.mark.filterwarnings("ignore::kanegen.KanegenWarning")
@pytest.mark.parametrize("name", slow_except(("solo12", "hyq_no_sensors", "talos_reduced"), "solo12"))
def test_floating_robots_against_pinocchio(name: str) -> None:
    _agrees_with_joints_in_a_row(kg.load(robot_file(name), floating_base=True), 4)


@pytest.mark.filterwarnings("ignore::kanegen.KanegenWarning")
def test_panda_with_both_fingers_free() -> None:
    """Without its coupling it has nine freedoms: values, and operations of [C], gravity and motion alone."""
    system = released(kg.load(robot_file("panda")))
    _agrees_with_joints_in_a_row(system, 6)
    for output, most in (("coriolis_matrix", 1637), ("gravity_forces", 101), ("velocity_forces", 668)):
        counts = compile_module(system, (output,)).operations
        assert counts["add"] + counts["multiply"] + counts["divide"] <= most, output


def _agrees_with_joints_in_a_row(system: kg.System, seed: int) -> None:
    """Check [C] and the forces of gravity by a model of Pinocchio whose joints have one freedom each."""
    theirs, (x, y) = PinocchioTree(system), np.random.default_rng(seed).normal(size=(2, len(system.freedoms)))
    close(found(system, {"x": x, "y": y}), theirs.coriolis_matrix(x, y), 1e-12)
    gravity = values(system, ("gravity_forces",), {"x": x})["gravity_forces"]
    expected = theirs.gravity_forces(x)
    assert np.abs(gravity - expected).max() <= 1e-12 * np.abs(expected).max()


COUNTS = {
    "ur5_robot": (False, 544),
    "panda": (False, 1336),
    "talos_reduced": (True, 11566),
}
"""Additions, multiplications and divisions of [C] alone."""


@pytest.mark.filterwarnings("ignore::kanegen.KanegenWarning")
@pytest.mark.parametrize("name", slow_except(COUNTS, "ur5_robot", "panda"))
def test_operations_do_not_rise(name: str) -> None:
    floating, most = COUNTS[name]
    system = kg.load(robot_file(name), floating_base=floating)
    counts = compile_module(system, ("coriolis_matrix",)).operations
    assert counts["add"] + counts["multiply"] + counts["divide"] <= most
    assert counts["divide"] == counts["sqrt"] == counts["prepare"] == 0


@pytest.mark.parametrize("seed", slow_except(range(6), 1))
def test_compiled_for_one_state_and_many(seed: int) -> None:
    """Trees of all kinds in C, in double and single precision, and the parts of {f} beside [C]."""
    system = random_trees.everything(seed, 3)
    outputs = ("gravity_forces", "velocity_forces", "coriolis_matrix")
    states = random_states(system, 16, seed)
    expected = (
        reference.gravity_forces(system, states.x),
        reference.velocity_forces(system, states.x, states.y),
        reference.coriolis_matrix(system, states.x, states.y),
    )
    for precision, room in (("double", 1e-12), ("float", 1e-5)):
        library = kg.build(system, outputs, precision=precision, on_status="ignore")
        batch, one = library.evaluate(states.x, states.y), library.evaluate(states.x[5], states.y[5])
        for name, right in zip(outputs, expected, strict=True):
            scale = np.abs(right).max(axis=tuple(range(1, right.ndim)), keepdims=True)
            assert (np.abs(getattr(batch, name) - right) <= room * scale).all(), name
            assert (np.abs(getattr(one, name) - right[5]) <= room * scale[5]).all(), name


def test_hinges_with_turned_frames() -> None:
    """A constant turn about the axis of a hinge, by a number or a parameter, and the hinge are one turn."""
    plain = systems.chain(3, ["theta2"])
    angles = (0.7, kg.Parameter("tilt", -0.4), 0.0)
    bodies = [
        replace(body, joint=replace(body.joint, orientation=(0.0, angle, 0.0)))
        for body, angle in zip(plain.bodies, angles, strict=True)
    ]
    system = kg.System("turned", tuple(bodies), plain.gravity)
    state = given(system, 2)
    close(found(system, state), reference.coriolis_matrix(system, state["x"], state["y"]), 1e-13)
    costs = [sum(compile_module(one, ("coriolis_matrix",)).operations.values()) for one in (system, plain)]
    assert costs[0] <= costs[1] + 8 + 2  # four operations for each of two turns, sines in `prepare`


def test_a_double_pendulum_costs_what_it_costs_by_hand() -> None:
    """With h = m2 l1 l2 sin(q2): rows (-h q2', -h (q1' + q2')) and (h q1', 0)."""
    system = kg.load("models/double_pendulum.toml")
    m2, l1, l2 = (next(p.value for p in system.parameters if p.name == name) for name in ("m2", "l1", "l2"))
    (u, v), h = (1.1, 0.6), m2 * l1 * l2 * np.sin(-0.8)
    expected = np.array([[-h * v, -h * (u + v)], [h * u, 0.0]])
    assert found(system, {"x": [0.3, -0.8], "y": [u, v]}) == pytest.approx(expected, rel=1e-14)
    counts = compile_module(system, ("coriolis_matrix",)).operations
    assert counts["add"] + counts["multiply"] <= 8
    assert counts["sincos"] == 1


def test_structure_costs_nothing() -> None:
    """Freedoms of different branches and of bodies that carry none have zeros; [A] as well adds little."""
    arms = systems.random_system(
        np.random.default_rng(2), 3, connection=(0, 1, 1), free=systems.flags(3, ["theta1"]), loads=False
    )
    (function,) = compile_module(arms, ("coriolis_matrix",)).module.functions.values()
    (output,) = function.outputs
    zero = [function.instructions[value].op is Op.CONSTANT for value in output.values]
    assert [divmod(i, 3) for i, flag in enumerate(zero) if flag] == [(1, 1), (1, 2), (2, 1), (2, 2)]
    chain = systems.chain(6)
    alone, matrix, both = (
        sum(compile_module(chain, outputs).operations.values())
        for outputs in (
            ("coriolis_matrix",),
            ("mass_matrix",),
            ("mass_matrix", "coriolis_matrix"),
        )
    )
    assert both <= alone + matrix / 2
