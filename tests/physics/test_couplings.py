"""Couplings: every output compared with G^T [A] G and the like of the tree without couplings; textbooks."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.program.evaluate import evaluate
from kanegen.reference import equations as reference
from kanegen.symbolic import derive
from kanegen.symbolic.printing.formats import render
from tests.support import prescribed_trees as trees
from tests.support import systems
from tests.support.cases import slow_except
from tests.support.couplings import random_couplings, rate_matrices, released, released_state
from tests.support.orientation_trees import close
from tests.support.prescribed_trees import KINDS, POINTS, SAME, Arrays, state, values
from tests.support.robots import robot_file

FRAMES = ("frame_jacobians", "frame_velocities", "frame_accelerations")
EQUATIONS = ("mass_matrix", "forcing", "inverse_dynamics", "forward_dynamics")


@cache
def tree(kind: str, seed: int, driven: bool) -> kg.System:
    """A random tree with points, motors and random couplings, with some prescribed freedoms or without."""
    system, rng = trees.tree(kind, seed), np.random.default_rng([seed, 77])
    system = system if driven else trees.freed(system)
    bodies = []
    for body in system.bodies:
        armature = tuple(float(rng.uniform(0, 0.5)) if moves else 0.0 for moves in body.joint.moving)
        rated = body.joint.speeds_are_rates
        bodies.append(replace(body, joint=replace(body.joint, armature=armature)) if rated else body)
    return random_couplings(replace(system, bodies=tuple(bodies)), rng, 0.6, parameters=0.0)


def expected(system: kg.System, given: Arrays) -> Arrays:
    """Return [A], {f} and what follows from them, from the reference of the tree without couplings."""
    other, whole = released(system), released_state(system, given)
    free, driven, _ = rate_matrices(system)
    loads = {"force": given["force"], "torque": given["torque"]}
    a = reference.mass_matrix(other, whole["x"])
    f = reference.forcing(other, whole["x"], whole["y"], **loads)
    own = free.T @ a @ free
    forcing = free.T @ (f - a @ driven @ given["prescribed"][2])
    found = {
        "mass_matrix": own,
        "forcing": forcing,
        "inverse_dynamics": own @ given["ydot"] - forcing,
        "forward_dynamics": np.linalg.solve(own, forcing + given["tau"]),
    }
    if system.prescribed:
        found["prescribed_efforts"] = driven.T @ (a @ whole["ydot"] - f)
    found |= values(other, whole, *SAME, *POINTS, *FRAMES)
    for name in ("point_jacobians", "frame_jacobians"):
        found[name] = found[name] @ free
    return found


def require_equal(kind: str, seed: int, driven: bool) -> None:
    system = tree(kind, seed, driven)
    given = state(system, seed)
    right = expected(system, given)
    outputs = tuple(right)
    together = values(system, given, *outputs)
    for name in outputs:
        close(together[name], right[name], 1e-9 if name == "forward_dynamics" else 1e-12)
    alone = EQUATIONS[seed % len(EQUATIONS)]
    close(values(system, given, alone)[alone], right[alone], 1e-9)


@pytest.mark.parametrize("driven", slow_except((False, True), True))
@pytest.mark.parametrize("kind", slow_except(KINDS, *KINDS[::3]))
def test_outputs_equal_those_of_the_tree_without_couplings(kind: str, driven: bool) -> None:
    assert tree(kind, 0, driven).couplings
    require_equal(kind, 0, driven)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_many_trees(kind: str) -> None:
    cases = [(seed, driven) for seed in range(1, 20) for driven in (False, True)]
    coupled = [(seed, driven) for seed, driven in cases if tree(kind, seed, driven).couplings]
    assert len(coupled) > 20
    for seed, driven in coupled:
        require_equal(kind, seed, driven)


@pytest.mark.parametrize("driven", slow_except((False, True), True))
@pytest.mark.parametrize("kind", slow_except(KINDS, *KINDS[1::3]))
def test_the_reference_and_the_literal_equations(kind: str, driven: bool) -> None:
    system = tree(kind, 2, driven)
    given = state(system, 2)
    right = expected(system, given)
    x, y, ydot, prescribed = (given[name] for name in ("x", "y", "ydot", "prescribed"))
    loads = {"force": given["force"], "torque": given["torque"]}
    close(reference.mass_matrix(system, x, prescribed), right["mass_matrix"])
    close(reference.forcing(system, x, y, **loads, prescribed=prescribed), right["forcing"])
    if driven and system.prescribed:
        efforts = reference.prescribed_efforts(system, x, y, ydot, prescribed, **loads)
        close(efforts, right["prescribed_efforts"])
    literal = derive(system, intermediates=True).lambdify()
    close(literal.mass_matrix(x, prescribed=prescribed), right["mass_matrix"])
    close(literal.forcing(x, y, given["force"], given["torque"], prescribed=prescribed), right["forcing"])


@pytest.mark.parametrize("solver", ["articulated bodies", "factorisation"])
@pytest.mark.parametrize("kind", slow_except(KINDS, *KINDS[2::3]))
def test_both_solvers(kind: str, solver: str) -> None:
    system = tree(kind, 1, driven=True)
    given = state(system, 1)
    variant = kg.Variant(solver=solver, refinement=1)
    module = compile_module(system, ("forward_dynamics", "regularity"), variant=variant).module
    inputs = {name: np.ravel(value) for name, value in given.items()}
    found = evaluate(module.functions["evaluate"], inputs, np)
    close(np.array(found["acceleration"]), expected(system, given)["forward_dynamics"], 1e-11)
    assert all(0 < value <= 1 + 1e-12 for value in found["regularity"])


def wheel(name: str, lower: int, inertia: float, position: tuple[float, float, float]) -> kg.Body:
    """A wheel that turns about axis 3 through its mass centre."""
    joint = kg.Joint(position, free=(False, False, True, False, False, False), name=name)
    return kg.Body(f"{name}_wheel", lower, 1.0, np.diag([inertia, inertia, inertia]).tolist(), joint=joint)


def test_a_train_of_gears() -> None:
    """Textbook: the inertia at the first shaft is J1 + J2 n2^2 + J3 (n2 n3)^2, for ratios along the train."""
    j1, j2, j3, first, second = 0.3, 0.2, 0.7, -2.0, -1.5
    wheels = [
        wheel(name, 0, j, (k, 0, 0)) for k, (name, j) in enumerate(zip("abc", (j1, j2, j3), strict=True))
    ]
    system = kg.System("gears", tuple(wheels)).with_couplings(
        kg.Coupling("c", {"b": second}), kg.Coupling("b", {"a": first})
    )
    library = kg.build(system, ("mass_matrix", "forward_dynamics"))
    inertia = j1 + j2 * first**2 + j3 * (first * second) ** 2
    np.testing.assert_allclose(library.mass_matrix([0.4]), [[inertia]], rtol=1e-15)
    np.testing.assert_allclose(library.forward_dynamics([0.4], [3.0], [0.9]), [0.9 / inertia], rtol=1e-15)
    assert library.source.operations["sincos"] == 0


def test_printed_equations_say_what_follows() -> None:
    bodies = (wheel("first", 0, 0.3, (0, 0, 0)), wheel("second", 0, 0.2, (1, 0, 0)))
    system = kg.System("pair", bodies).with_couplings(kg.Coupling("second", {"first": -2.0}, 0.5))
    equations = kg.derive(system)
    assert "not in {x} and {y}: second = -2.0 first + 0.5." in render(equations)
    np.testing.assert_allclose(np.array(equations.closed_form().A, float), [[0.3 + 4 * 0.2]])
    module: dict[str, object] = {}
    exec(render(equations, "python"), module)
    np.testing.assert_allclose(module["mass_matrix"](np.array([0.3])), [[1.1]])


def test_a_differential_on_a_moving_carrier() -> None:
    """The carrier turns by the mean of two shafts: [A] = [[J + C/4, C/4], [C/4, J + C/4]]."""
    j, c = 0.05, 0.6
    bodies = (
        wheel("left", 0, j, (0, 0, 1)),
        wheel("right", 0, j, (0, 0, -1)),
        wheel("cage", 0, c, (0, 0, 0)),
    )
    system = kg.System("differential", bodies).with_couplings(
        kg.Coupling("cage", {"left": 0.5, "right": 0.5})
    )
    found = kg.build(system, "mass_matrix").mass_matrix([0.1, 0.2])
    np.testing.assert_allclose(found, j * np.eye(2) + c / 4, rtol=1e-15)


def test_a_rack_and_pinion_under_gravity() -> None:
    """Textbook: a rack of mass m hangs on a pinion of inertia J and radius r: (J + m r^2) alpha = m g r."""
    m, j, r, g = 1.7, 0.02, 0.11, 9.81
    slide = kg.Joint(free=(False, False, False, False, False, True), name="rack")
    rack = kg.Body("bar", 0, m, np.zeros((3, 3)).tolist(), joint=slide)
    system = kg.System("rack_and_pinion", (wheel("pinion", 0, j, (r, 0, 0)), rack))
    library = kg.build(system.with_couplings(kg.Coupling("rack", {"pinion": -r})), ("forward_dynamics",))
    np.testing.assert_allclose(
        library.forward_dynamics([0.3], [-2.0]), [m * g * r / (j + m * r**2)], rtol=1e-15
    )


def test_springs_and_drives_on_coupled_freedoms() -> None:
    """A spring on a freedom that follows with the factor a acts as one of stiffness a^2 k, about b / a."""
    a, b, k, d = -0.6, 0.25, 3.0, 0.4
    bodies = (wheel("first", 0, 0.3, (0, 0, 0)), wheel("second", 0, 0.2, (1, 0, 0)))
    system = kg.System("sprung", bodies).with_couplings(kg.Coupling("second", {"first": a}, b))
    system = system.with_force_elements(
        kg.JointSpring("second", k, 0.1, d), kg.Drive("second", "x.second*y.first - y.second**2")
    )
    outputs = ("forcing", "potential_energy", "forward_dynamics")
    library = kg.build(system, outputs)
    x, y = 0.7, -1.3
    follows, rate = a * x + b, a * y
    effort = -k * (follows - 0.1) - d * rate + follows * y - rate**2
    np.testing.assert_allclose(library.forcing([x], [y]), [a * effort], rtol=1e-14)
    np.testing.assert_allclose(library.potential_energy([x]), k * (follows - 0.1) ** 2 / 2, rtol=1e-14)


OPERATIONS = {"mass_matrix": 394, "forcing": 686, "inverse_dynamics": 717, "forward_dynamics": 1394}
"""Operations of the arm with a gripper whose second finger follows the first."""


@pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")
def test_a_gripper_costs_less_with_its_fingers_coupled() -> None:
    """No row and no column of the second finger is computed, and no product with the rates is formed."""
    coupled = kg.load(robot_file("panda"))
    for name, count in OPERATIONS.items():
        own, free = (sum(kg.generate(one, name).operations.values()) for one in (coupled, released(coupled)))
        assert own == count < free


def test_equal_angles_share_their_sine() -> None:
    """A hinge that follows with the factor 1 or -1 and no offset has the same sine and cosine."""
    chain = systems.chain(3, ["theta3"])
    for factor in (1.0, -1.0):
        system = chain.with_couplings(kg.Coupling("body3.theta3", {"body1.theta3": factor}))
        assert kg.generate(system, "forcing").operations["sincos"] == 4


@pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")
@pytest.mark.parametrize(
    ("name", "floating", "solver"),
    [
        ("pr2", False, "articulated bodies"),
        pytest.param("pr2", False, "factorisation", marks=pytest.mark.slow),
        pytest.param("talos_full_v2", True, "articulated bodies", marks=pytest.mark.slow),
    ],
)
def test_forward_dynamics_of_robots_with_mimic_joints(name: str, floating: bool, solver: str) -> None:
    system = kg.load(robot_file(name), floating_base=floating)
    module = compile_module(system, "forward_dynamics", variant=kg.Variant(solver=solver)).module
    x, y, tau = np.random.default_rng(0).uniform(-0.5, 0.5, (3, len(system.freedoms)))
    found = evaluate(module.functions["forward_dynamics"], {"x": x, "y": y, "tau": tau}, np)
    a, f = reference.mass_matrix(system, x), reference.forcing(system, x, y)
    assert np.abs(a @ np.array(found["acceleration"]) - f - tau).max() <= 1e-14 * np.abs(f).max()
