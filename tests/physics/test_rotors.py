"""Rotors of geared motors: against trees in which they are bodies, and by what physics conserves."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.measure.truth import truth
from kanegen.options import Variant
from kanegen.recursion import derive_losses
from kanegen.recursion.rotors import articulated_bodies_take
from kanegen.reference import equations as reference
from kanegen.reference.regularity import require_regular
from kanegen.symbolic import derive
from tests.support import motors, random_trees, systems
from tests.support.cases import slow_except
from tests.support.programs import values

DYNAMICS = ("mass_matrix", "forcing", "inverse_dynamics", "forward_dynamics", "kinetic_energy", "momentum")
SOLVERS = ("factorisation", "articulated bodies")
QUICK = [(name, "factorisation", 0) for name in list(motors.CASES)[::2]]
"""Cases that run on every change."""
Floats = Any


@pytest.mark.parametrize("name", motors.CASES)
def test_the_reference_against_a_tree_in_which_rotors_are_bodies(name: str) -> None:
    """[A] = [G]^T [A] [G] and {f} = [G]^T {f} of the larger tree, whatever the angles of its rotors."""
    small, large, _, g = motors.case(name)
    rng = np.random.default_rng(1)
    x, y = rng.uniform(-1, 1, (2, len(small.freedoms)))
    angles = g @ x + rng.uniform(-3, 3, len(g)) * ~g[:, :].astype(bool).any(axis=1)
    a, f = reference.mass_matrix(large, angles), reference.forcing(large, angles, g @ y)
    ours = reference.mass_matrix(small, x), reference.forcing(small, x, y)
    assert np.abs(ours[0] - g.T @ a @ g).max() <= 1e-12 * np.abs(a).max()
    assert np.abs(ours[1] - g.T @ f).max() <= 1e-12 * np.abs(f).max()


@pytest.mark.parametrize(
    ("name", "solver", "refinement"),
    [
        pytest.param(*one, marks=[] if one in QUICK else pytest.mark.slow)
        for one in product(motors.CASES, SOLVERS, (0, 1))
    ],
)
def test_every_output_against_that_tree(name: str, solver: str, refinement: int) -> None:
    small, large, _, g = motors.case(name)
    if solver == "articulated bodies" and not articulated_bodies_take(small):
        with pytest.raises(kg.OptionError, match="takes no rotor whose carrier is apart from the freedom"):
            compile_module(small, ("forward_dynamics",), variant=Variant(solver=solver))
        return
    x, y, ydot, tau = np.random.default_rng(2).uniform(-1, 1, (4, len(small.freedoms)))
    variant = Variant(solver=solver, refinement=refinement)
    found = values(small, DYNAMICS, {"x": x, "y": y, "ydot": ydot, "tau": tau}, variant=variant)
    a, f = reference.mass_matrix(large, g @ x), reference.forcing(large, g @ x, g @ y)
    a, f = g.T @ a @ g, g.T @ f
    assert np.abs(found["A"].reshape(a.shape) - a).max() <= 1e-12 * np.abs(a).max()
    assert np.abs(found["f"] - f).max() <= 1e-12 * np.abs(f).max()
    needed = a @ ydot - f
    assert np.abs(found["generalized_force"] - needed).max() <= 1e-12 * np.abs(needed).max()
    expected = np.linalg.solve(a, f + tau)
    room = 1e-12 + 1e-14 * np.linalg.cond(a)
    assert np.abs(found["acceleration"] - expected).max() <= room * np.abs(expected).max()
    theirs = values(large, ("kinetic_energy", "momentum"), {"x": g @ x, "y": g @ y})
    assert found["kinetic_energy"] == pytest.approx(theirs["kinetic_energy"], rel=1e-12)
    assert found["momentum"] == pytest.approx(theirs["momentum"], rel=1e-11, abs=1e-12)


@pytest.mark.parametrize("name", ["in the lower bodies", "in the bodies of the joints"])
def test_what_joints_carry_along_locked_directions(name: str) -> None:
    """The spin of a rotor loads its bearings, and every joint between them and the ground."""
    small, large, _, g = motors.case(name)
    directions = list(small.reaction_names)
    x, y, ydot = np.random.default_rng(3).uniform(-1, 1, (3, len(small.freedoms)))
    ours = values(small, ("reaction_loads",), {"x": x, "y": y, "ydot": ydot})["reaction_loads"]
    both = large.with_reactions(directions)
    theirs = values(both, ("reaction_loads",), {"x": g @ x, "y": g @ y, "ydot": g @ ydot})["reaction_loads"]
    assert np.abs(ours - theirs).max() <= 1e-12 * np.abs(theirs).max()


@pytest.mark.parametrize("seed", slow_except(range(20), 0, 1, 2))
def test_energy_is_conserved(seed: int) -> None:
    """Without forces y . {f} is minus half of y . [Adot] y, with the derivative by a complex step."""
    system = replace(random_trees.everything(seed), gravity=(0.0, 0.0, 0.0), force_elements=())
    if not system.speeds_are_rates:
        system = systems.from_values(system.values())
        system = kg.System("rates", tuple(_with_rates(body) for body in system.bodies), (0, 0, 0))
        system = random_trees.with_rotors(system, random_trees.Drawing(np.random.default_rng(seed)))
    assert system.rotors
    x, y = np.random.default_rng(seed).normal(size=(2, len(system.freedoms)))
    slope = reference.mass_matrix(system, x + 1e-30j * y).imag / 1e-30
    power = y @ reference.forcing(system, x, y)
    assert power == pytest.approx(-y @ slope @ y / 2, rel=1e-11, abs=1e-12 * np.abs(slope).max())


def _with_rates(body: kg.Body) -> kg.Body:
    joint = replace(body.joint, coordinates="angles", speeds="angle_rates")
    return replace(body, joint=joint)


@pytest.mark.parametrize("seed", slow_except(range(12), 0))
def test_certified_truth(seed: int) -> None:
    """Newton-Euler equations and partial velocities in ball arithmetic share nothing with the reference."""
    system = random_trees.without_actions(random_trees.everything(seed, 3)).map_numbers(float_of)
    x, y, ydot = np.random.default_rng(seed).normal(size=(3, max(len(system.coordinates), 1)))
    y, ydot = y[: len(system.freedoms)], ydot[: len(system.freedoms)]
    exact = truth(system, x, y, ydot=ydot, outputs=("mass_matrix", "forcing", "inverse_dynamics"))
    a, f = reference.mass_matrix(system, x), reference.forcing(system, x, y)
    assert np.abs(exact["mass_matrix"].value - a).max() <= 1e-14 * np.abs(a).max()
    assert np.abs(exact["forcing"].value - f).max() <= 1e-12 * np.abs(f).max()
    needed = a @ ydot - f
    assert np.abs(exact["inverse_dynamics"].value - needed).max() <= 1e-12 * np.abs(needed).max()


def float_of(value: Any) -> float:
    return float(getattr(value, "value", value))


@pytest.mark.parametrize("intermediates", [False, True])
def test_literal_equations_with_prescribed_freedoms(intermediates: bool) -> None:
    """A rotor that a prescribed freedom drives moves as prescribed, and loads its carrier."""
    bare = systems.chain(3, ["theta3"])
    rng = np.random.default_rng(4)
    mounted = motors.random_motors(bare, rng, {"body2.theta3": 1, "body3.theta3": 3, "body1.theta3": 2})
    system = motors.with_rotors(bare, mounted).with_prescribed("body2.theta3")
    x, y, ydot = rng.normal(size=(3, 2))
    motion = rng.normal(size=(3, 1))
    a, f = reference.mass_matrix(system, x, motion), reference.forcing(system, x, y, prescribed=motion)
    literal = derive(system, intermediates=intermediates).lambdify()
    assert np.abs(literal.mass_matrix(x, prescribed=motion) - a).max() <= 1e-13 * np.abs(a).max()
    assert np.abs(literal.forcing(x, y, prescribed=motion) - f).max() <= 1e-12 * np.abs(f).max()
    inputs = {"x": x, "y": y, "ydot": ydot, "tau": 0 * y, "prescribed": motion}
    found = values(system, ("forcing", "forward_dynamics", "prescribed_efforts"), inputs)
    assert np.abs(found["f"] - f).max() <= 1e-12 * np.abs(f).max()
    assert found["acceleration"] == pytest.approx(np.linalg.solve(a, f), rel=1e-11)
    efforts = reference.prescribed_efforts(system, x, y, ydot, motion)
    assert found["prescribed_efforts"] == pytest.approx(efforts, rel=1e-11)
    large = motors.with_bodies(bare, mounted).with_prescribed("body2.theta3")
    large = large.with_prescribed("rotor0.theta3")
    theirs = reference.prescribed_efforts(
        large,
        np.array([x[0], x[1], mounted[1].ratio * x[1], mounted[2].ratio * x[0]]),
        np.array([y[0], y[1], mounted[1].ratio * y[1], mounted[2].ratio * y[0]]),
        np.array([ydot[0], ydot[1], mounted[1].ratio * ydot[1], mounted[2].ratio * ydot[0]]),
        np.hstack([motion, mounted[0].ratio * motion]),
    )
    assert efforts[0] == pytest.approx(theirs[0] + mounted[0].ratio * theirs[1], rel=1e-11)


@pytest.mark.parametrize(
    ("coupled", "terms"),
    [
        ("body3.theta3", {"body2.theta3": -0.7, "body1.theta3": 0.4}),
        pytest.param("body2.theta3", {"body1.theta3": 0.8}, marks=pytest.mark.slow),
    ],
)
def test_rotors_with_couplings(coupled: str, terms: dict[str, float]) -> None:
    """The same tree twice: with rotors, and with bodies whose angles are coupled to the freedoms.

    Coupled freedoms drive rotors, and a rotor is in another branch than its freedom.
    """
    rng = np.random.default_rng(6)
    bare = systems.random_system(
        rng, 4, connection=(0, 1, 2, 2), free=systems.flags(4, ["theta3"]), loads=False
    )
    couplings = [kg.Coupling(coupled, terms, 0.2)]
    mounted = motors.random_motors(bare, rng, {"body3.theta3": 2, "body4.theta3": 3, "body2.theta3": 1})
    small = motors.with_rotors(bare, mounted).with_couplings(*couplings)
    gears = [kg.Coupling(f"rotor{i}.theta3", {m.freedom: m.ratio}) for i, m in enumerate(mounted)]
    large = motors.with_bodies(bare, mounted).with_couplings(*couplings, *gears)
    x, y, ydot, tau = rng.uniform(-1, 1, (4, 3))
    outputs = ("mass_matrix", "forcing", "inverse_dynamics", "forward_dynamics", "kinetic_energy", "momentum")
    inputs = {"x": x, "y": y, "ydot": ydot, "tau": tau}
    ours, theirs = values(small, outputs, inputs), values(large, outputs, inputs)
    for name, value in theirs.items():
        assert ours[name] == pytest.approx(value, rel=1e-11, abs=1e-12 * np.abs(value).max()), name
    for system, found in ((small, ours), (large, ours)):
        assert reference.mass_matrix(system, x).ravel() == pytest.approx(found["A"], rel=1e-12, abs=1e-13)
        assert reference.forcing(system, x, y) == pytest.approx(found["f"], rel=1e-11)
    exact = truth(small, x, y, tau, outputs=("mass_matrix", "forcing", "forward_dynamics"))
    assert exact["forward_dynamics"].value == pytest.approx(ours["acceleration"], rel=1e-11)
    literal = derive(small).lambdify()
    assert literal.forcing(x, y) == pytest.approx(ours["f"], rel=1e-11)
    assert literal.mass_matrix(x).ravel() == pytest.approx(ours["A"], rel=1e-11)


@pytest.mark.parametrize(("name", "solver"), list(product(motors.CASES, SOLVERS)))
def test_losses_of_pivots_stay_below_their_bounds(name: str, solver: str) -> None:
    """Bounds of pivots hold with rotors, which couple a freedom to bodies that it does not carry."""
    small, *_ = motors.case(name)
    if solver == "articulated bodies" and not articulated_bodies_take(small):
        return
    form = derive_losses(small, solver)
    x = np.random.default_rng(5).uniform(-2, 2, (40, len(small.freedoms)))
    found = _evaluated(form, x)
    losses, bounds = np.array(found["losses"]), np.array(found["bounds"])
    assert (losses > 0).all()
    assert ((losses <= bounds * (1 + 1e-9)) | (bounds == 0)).all()


def _evaluated(form: Any, x: Floats) -> dict[str, Floats]:
    """Return losses and bounds, (n, B), by name."""
    known: dict[Any, Floats] = {}
    places = {
        f"theta_{f.body}_{f.index + 1}" if f.is_angle else f"s_{f.body}_{f.index - 2}": i
        for i, f in enumerate(form.system.freedoms)
    }

    def number(value: Any) -> Floats:
        if value.is_Number:
            return np.full(len(x), float(value))
        if value.is_Symbol:
            return known[value] if value in known else x[:, places[value.name]]
        if value.is_Add:
            return sum(number(arg) for arg in value.args)
        if value.is_Mul:
            return np.prod([number(arg) for arg in value.args], axis=0)
        if value.is_Pow:
            return number(value.base) ** float(value.exp)
        return getattr(np, value.func.__name__.lower())(number(value.args[0]))

    for definition in form.definitions:
        known[definition.symbol] = number(definition.value)
    return {name: [number(value) for value in derived.entries] for name, derived in form.outputs.items()}


def test_a_rotor_that_turns_with_its_carrier_costs_no_inertia() -> None:
    """A rotor with the ratio -1 in the body of its hinge stands still in space."""
    inertia = [[0.3, 0, 0], [0, 0.3, 0], [0, 0, 0.5]]
    joint = kg.Joint(free=(False, False, True, False, False, False))
    body = kg.Body("wheel", 0, 1.0, inertia, joint=joint)
    system = kg.System("wheel", (body,)).with_rotors(
        kg.Rotor("r", "wheel.theta3", (0, 0, 1), 0.5, -1.0, "wheel")
    )
    assert reference.mass_matrix(system, [0.3])[0, 0] == 0
    with pytest.raises(kg.SingularError):
        require_regular(system)
    require_regular(system.with_rotors(kg.Rotor("other", "wheel.theta3", (0, 0, 1), 0.1)))


def test_what_it_costs() -> None:
    """A rotor on the axis of the joint adds its inertia to one component of its column, and turns with it."""
    arm = kg.load("models/six_revolute_arm.toml")
    rotors = [
        kg.Rotor(f"m{k}", f"{body.name}.theta3", (0, 0, 1), 1e-5, 100.0)
        for k, body in enumerate(arm.bodies, start=1)
    ]
    geared = arm.with_rotors(*rotors)
    for name, most in (("mass_matrix", 30), ("forcing", 60)):
        ours, without = (sum(compile_module(s, (name,)).operations.values()) for s in (geared, arm))
        assert without < ours <= without + most
