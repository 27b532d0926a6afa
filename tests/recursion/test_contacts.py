"""Accelerations and loads under contacts, against the dense equations of the reference and against robots."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import replace

import mpmath
import numpy as np
import pinocchio as pin
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.errors import KanegenWarning, OptionError, SingularError
from kanegen.lowering.losses import array_inputs
from kanegen.lowering.lower import lower
from kanegen.model.arrays import Floats
from kanegen.model.numbers import value_of
from kanegen.options import Variant
from kanegen.program.constants import MULTIPRECISION
from kanegen.program.evaluate import evaluate
from kanegen.program.precision import FLOAT
from kanegen.recursion import derive, methods
from kanegen.recursion.refinement import UNREFINED, Refinement
from kanegen.reference import equations as reference
from kanegen.reference.contacts import contact_motion
from kanegen.reference.states import States, random_states
from tests.support import random_trees, systems
from tests.support.cases import slow_among, slow_except
from tests.support.chains import hinges
from tests.support.paths import MODELS
from tests.support.programs import values
from tests.support.random_contacts import with_contacts
from tests.support.refinement import rods
from tests.support.robots import Several, fixed_model, floating_model, places, robot_file

OUTPUTS = ("contact_dynamics", "contact_forces")

ROUNDOFFS = 1e-14
"""Errors of solutions over the condition number of the equations without units: some tens of roundoffs."""


def forces_of(states: States) -> Floats:
    """Return (B, n) generalized forces of the size of speeds."""
    return np.random.default_rng(1).normal(size=states.y.shape) * np.abs(states.y).max()


def computed(
    system: kg.System, way: Mapping[str, str], states: States, refinement: Refinement = UNREFINED
) -> tuple[Floats, Floats]:
    """Return (B, n) accelerations and (B, r) loads of the program that becomes C."""
    program = lower(derive(system, way, refinement=refinement), OUTPUTS)
    inputs = array_inputs(system, program, states) | {"tau": list(forces_of(states).T)}
    found = evaluate(program, inputs, np, np.float64)
    first, second = (
        np.stack([np.broadcast_to(row, len(states)) for row in found[name]], axis=-1)
        for name in ("contact_acceleration", "contact_force")
    )
    return first, second


def check(
    system: kg.System,
    states: States,
    found: tuple[Floats, Floats],
    roundoffs: float = ROUNDOFFS,
    tau: Floats | None = None,
) -> None:
    """Require the solution of the dense equations, as accurate as their condition number admits.

    Units are taken away by the inertia of each freedom, then by the size of each row.
    """
    loads = {"force": states.force, "torque": states.torque, **states.inputs}
    tau = forces_of(states) if tau is None else tau
    exact = contact_motion(system, states.x, states.y, tau, **loads)
    a = np.asarray(reference.mass_matrix(system, states.x, states.prescribed))
    root = np.sqrt(np.diagonal(a, axis1=1, axis2=2))
    jacobian = exact.jacobian / root[:, None, :]
    damping = np.array([value_of(row.contact.damping) for row in system.contact_rows])
    size = np.sqrt((jacobian**2).sum(axis=2) + damping)
    damping, jacobian = damping / size**2, jacobian / size[:, :, None]
    upper = np.concatenate([a / root[:, :, None] / root[:, None, :], -jacobian.transpose(0, 2, 1)], axis=2)
    lower_rows = np.concatenate([jacobian, damping[:, :, None] * np.eye(size.shape[1])], axis=2)
    bound = roundoffs * np.linalg.cond(np.concatenate([upper, lower_rows], axis=1))
    unitless = np.concatenate([exact.ydot * root, exact.forces * size], axis=1)
    error = np.concatenate([(found[0] - exact.ydot) * root, (found[1] - exact.forces) * size], axis=1)
    assert (np.abs(error).max(axis=1) <= bound * np.abs(unitless).max(axis=1)).all()


@pytest.mark.parametrize("seed", slow_except(range(24), *range(3)))
def test_trees_with_everything(seed: int) -> None:
    """Both solvers, where they take the rotors of the tree."""
    system = random_trees.everything(seed, 3)
    states = random_states(system, 4, seed)
    for way in {
        tuple(one.items()) for solver in ("cheapest", "factorisation") for one in ways(system, solver)
    }:
        check(system, states, computed(system, dict(way), states))


def ways(system: kg.System, solver: str = "cheapest") -> tuple[Mapping[str, str], ...]:
    return methods(system, OUTPUTS, solver)


@pytest.mark.parametrize("seed", slow_except(range(6), *range(3)))
@pytest.mark.parametrize("solver", ["articulated bodies", "factorisation"])
def test_trees_without_rotors(solver: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    system = with_contacts(systems.random_system(rng, bodies=int(rng.integers(2, 6))), rng)
    states = random_states(system, 4, seed)
    (way,) = ways(system, solver)
    check(system, states, computed(system, way, states))


@pytest.mark.parametrize("seed", slow_except(range(4), 0, 1))
@pytest.mark.parametrize("solver", ["articulated bodies", "factorisation"])
def test_prescribed_motion(solver: str, seed: int) -> None:
    """What is held does not accelerate, whatever prescribed freedoms do."""
    rng = np.random.default_rng(seed)
    system = systems.random_system(rng, bodies=4, loads=True)
    system = with_contacts(system.with_prescribed(system.freedom_names[seed::5]), rng)
    states = random_states(system, 4, seed)
    assert np.abs(states.prescribed[:, 2]).min() > 0
    (way,) = ways(system, solver)
    check(system, states, computed(system, way, states))


def test_an_ill_conditioned_tree_is_refined() -> None:
    """Against the same program in 320 bits: one step repairs accelerations and loads."""
    system = rods(8.0).with_points({"tip": (8, (0.1, 0.2, -0.5))})
    system = system.with_contacts(kg.Contact(point="tip", directions=("force1", "force2")))
    compiled = compile_module(system, OUTPUTS)
    assert compiled.refinement.startswith("1 (auto")
    states = random_states(system, 3)
    states = replace(states, x=states.x / 128)  # chains lose most where they are nearly straight
    (way, *_) = ways(system)
    program = lower(derive(system, way), OUTPUTS)
    inputs = array_inputs(system, program, states) | {"tau": list(forces_of(states).T)}
    errors = []
    for refinement in (UNREFINED, Refinement(steps=1)):
        found = np.concatenate(computed(system, way, states, refinement), axis=1)
        worst = 0.0
        for b in range(3):
            exact = evaluate(
                program,
                {name: [MULTIPRECISION.mpf(float(row[b])) for row in rows] for name, rows in inputs.items()},
                MULTIPRECISION,
                MULTIPRECISION.mpf,
            )
            right = np.array([float(value) for values in exact.values() for value in values])
            worst = max(worst, np.abs(found[b] - right).max() / np.abs(right).max())
        errors.append(worst)
    assert errors[0] > 1e-12
    assert errors[1] < 1e-13


@pytest.mark.parametrize("solver", ["articulated bodies", "factorisation"])
def test_refined_solutions(solver: str) -> None:
    """Corrections keep the loads of the contacts and what they hold, also with damping."""
    rng = np.random.default_rng(5)
    system = with_contacts(systems.random_system(rng, bodies=4), rng)
    states = random_states(system, 4)
    (way,) = ways(system, solver)
    check(system, states, computed(system, way, states, Refinement(steps=1)))


FEET = {
    "talos_reduced": [kg.Contact(frame="left_sole_link"), kg.Contact(frame="right_sole_link")],
    "hyq_no_sensors": [kg.Contact(point=f"{leg}_foot") for leg in ("lf", "rf", "lh", "rh")],
    "solo12": [kg.Contact(point=f"{leg}_FOOT") for leg in ("FL", "FR", "HL", "HR")],
    "panda": [
        kg.Contact(point="panda_hand_tcp"),
        kg.Contact("turn", frame="panda_hand", directions="moment1"),
    ],
    "ur5_robot": [kg.Contact(frame="tool0", directions=("moment1", "moment2", "force3"))],
}
"""Contacts of five robots."""


def robot(name: str) -> tuple[kg.System, pin.Model, Several]:
    """Return a robot with its contacts, and Pinocchio's reading of it."""
    path = robot_file(name)
    is_fixed = name in ("panda", "ur5_robot")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", KanegenWarning)
        system = kg.load(path, floating_base=not is_fixed)
    model, several = (fixed_model(path), {}) if is_fixed else floating_model(path, system)
    return system.with_contacts(FEET[name]), model, several


@pytest.mark.parametrize("name", slow_among(FEET, "talos_reduced"))
def test_robots_by_pinocchio(name: str) -> None:
    """[A], {f}, Jacobians and their rates are Pinocchio's, and the equations are solved as a whole."""
    system, model, several = robot(name)
    order = places(system, model, several)
    states = random_states(system, 2, 3)
    (way, *_) = ways(system)
    ydot, forces = computed(system, way, states)
    data = model.createData()
    for found, load, x, y, tau in zip(ydot, forces, states.x, states.y, forces_of(states), strict=True):
        q, v = x[order], y[order]
        a = np.array(pin.crba(model, data, q))
        a = np.triu(a) + np.triu(a, 1).T
        bias = np.array(pin.nonLinearEffects(model, data, q, v))
        pin.forwardKinematics(model, data, q, v, 0 * v)
        rows, rates = [], []
        for contact in system.contacts:
            frame = model.getFrameId(contact.place)
            jacobian = pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL_WORLD_ALIGNED)
            held = pin.getFrameClassicalAcceleration(model, data, frame, pin.LOCAL_WORLD_ALIGNED).vector
            for row in contact.rows():
                place = (row.index + 3) % 6  # linear rows come first there
                rows.append(jacobian[place])
                rates.append(held[place])
        j = np.array(rows)
        whole = np.block([[a, -j.T], [j, np.zeros((len(j), len(j)))]])
        exact = np.linalg.solve(whole, np.concatenate([tau[order] - bias, -np.array(rates)]))
        room = ROUNDOFFS * np.linalg.cond(a) * np.linalg.cond(j @ np.linalg.solve(a, j.T))
        room = max(room, 1e-12)
        n = len(order)
        assert found[order] == pytest.approx(exact[:n], abs=room * np.abs(exact[:n]).max())
        assert load == pytest.approx(exact[n:], abs=room * np.abs(exact[n:]).max())


def leg(damping: float | kg.Parameter = 0.0) -> kg.System:
    """Return a double pendulum whose tip is held in its plane."""
    system = kg.load(MODELS / "double_pendulum.toml").with_points({"tip": ("lower", (0.7, 0, 0))})
    held = kg.Contact(point="tip", directions=("force1", "force2"), damping=damping)
    return system.with_contacts(held)


@pytest.fixture(scope="module")
def pendulum() -> kg.Library:
    return kg.build(leg(), (*OUTPUTS, "forward_dynamics", "point_accelerations", "point_jacobians"))


def test_what_is_held_does_not_accelerate(pendulum: kg.Library) -> None:
    rng = np.random.default_rng(0)
    x, y, tau = rng.uniform(-1, 1, (3, 20, 2))
    ydot, forces = pendulum.contact_dynamics(x, y, tau), pendulum.contact_forces(x, y, tau)
    held = pendulum.point_accelerations(x, y, ydot)[:, 0, :2]
    jacobian = pendulum.point_jacobians(x)[:, 0, :2]
    assert np.abs(held).max() <= 1e-12 * np.abs(jacobian).max() * np.abs(ydot).max()
    # The loads, as generalized forces, give the same accelerations without contacts.
    as_tau = np.einsum("bri,br->bi", jacobian, forces)
    free = pendulum.forward_dynamics(x, y, tau + as_tau)
    assert free == pytest.approx(ydot, abs=1e-11 * np.abs(as_tau).max())


def test_loads_take_no_power_where_what_is_held_rests() -> None:
    """Then the rate of the energy is the power of {tau} alone, in speeds that the contact admits."""
    system = hinges(4).with_points({"tip": (4, (0.3, 0.1, 0.2))}).with_contacts("tip")
    library = kg.build(system, (*OUTPUTS, "mass_matrix", "forcing", "point_jacobians"))
    rng = np.random.default_rng(4)
    for _ in range(5):
        x, tau = rng.uniform(-1, 1, (2, 4))
        _, _, rows = np.linalg.svd(library.point_jacobians(x)[0])
        y = rows[-1]
        ydot = library.contact_dynamics(x, y, tau)
        needed = library.mass_matrix(x) @ ydot - library.forcing(x, y)
        assert y @ needed == pytest.approx(y @ tau, abs=1e-12 * np.abs(needed).max())
        assert np.abs(needed - tau).max() > 0.1  # the loads act


def test_one_state_a_batch_and_all_outputs_together(pendulum: kg.Library) -> None:
    rng = np.random.default_rng(1)
    x, y, tau = rng.uniform(-1, 1, (3, 9, 2))
    ydot, forces = pendulum.contact_dynamics(x, y, tau), pendulum.contact_forces(x, y, tau)
    for i in range(9):
        assert (pendulum.contact_dynamics(x[i], y[i], tau[i]) == ydot[i]).all()
        assert (pendulum.contact_forces(x[i], y[i], tau[i]) == forces[i]).all()
    both = pendulum.evaluate(x=x, y=y, tau=tau, ydot=ydot)
    assert both.contact_dynamics == pytest.approx(ydot, abs=1e-13 * np.abs(ydot).max())
    assert both.contact_forces == pytest.approx(forces, abs=1e-13 * np.abs(forces).max())
    assert pendulum.contact_names == ("tip.force1", "tip.force2")


def test_dependent_rows_are_missing_and_named(pendulum: kg.Library) -> None:
    """Where the pendulum is straight, no load along it can be told from one across it."""
    with pytest.raises(
        SingularError, match="pivot of the contacts at row 'force2' of contact 'tip', along inertial axis 2"
    ):
        pendulum.contact_dynamics([0.3, 0.0], [0.0, 0.0])
    with pytest.warns(KanegenWarning, match="in 1 of 2 states .* in state 1 the pivot of the contacts at"):
        found = pendulum.contact_forces([[0.3, 0.4], [0.3, 0.0]], np.zeros((2, 2)))
    assert np.isfinite(found[0]).all()
    assert np.isnan(found[1]).all()
    # Every program of two equal rows leaves rounding for a pivot: never a number instead of a status.
    rng = np.random.default_rng(2)
    x = np.column_stack([rng.uniform(-3, 3, 500), np.pi * rng.integers(-1, 2, 500)])
    quiet = pendulum.with_on_status("ignore")
    assert np.isnan(quiet.contact_dynamics(x, rng.normal(size=(500, 2)))).all()


def test_nearly_dependent_rows_have_a_status(pendulum: kg.Library) -> None:
    with pytest.warns(
        KanegenWarning, match="Most digits are lost at row 'force2' of contact 'tip', .*nearly hold this"
    ):
        pendulum.contact_forces([0.3, 1e-3], [0.0, 0.0])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        pendulum.contact_forces([0.3, 0.1], [0.0, 0.0])


def test_damping_that_rounding_exceeds_has_a_status() -> None:
    """Near the stretched leg the rounding errors of a row are as large as a damping of 1e-12."""
    library = kg.build(leg(kg.Parameter("mu", 1e-8)), OUTPUTS, on_status="warn")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        library.contact_dynamics([0.3, 1e-7], [0.1, 0.2])
    small = library.with_parameters({"mu": 1e-12})
    for function in (small.contact_dynamics, small.contact_forces):
        with pytest.warns(kg.KanegenWarning, match="not accurate in this state.* at row 'force"):
            function([0.3, 1e-7], [0.1, 0.2])


def test_proven_bounds_hold() -> None:
    """Errors against the same program in many digits stay below bounds for the whole box."""
    system = leg().map_numbers(value_of)
    box = {"x": {"q1": [-0.02, 0.02], "q2": [1.29, 1.31]}, "y": {"angles": [-1.0, 1.0]}}
    bounds = kg.bound(kg.generate(system, OUTPUTS), box).outputs
    rng = np.random.default_rng(6)
    for _ in range(5):
        x = rng.uniform((-0.02, 1.29), (0.02, 1.31))
        inputs = {"x": x, "y": rng.uniform(-1, 1, 2), "tau": np.zeros(2)}
        rounded, exact = (values(system, OUTPUTS, inputs, number) for number in (float, mpmath.mpf))
        for output, array in zip(OUTPUTS, exact, strict=True):
            error = np.abs(rounded[array] - exact[array].astype(float))
            assert (error <= bounds[output]).all()
            assert (bounds[output] < 1e-13).all()


def test_damping_gives_way_and_finds_loads_of_dependent_rows() -> None:
    """Its limit for small damping are the smallest loads, by the pseudo-inverse."""
    system = leg(kg.Parameter("mu", 1e-3))
    library = kg.build(system, (*OUTPUTS, "point_accelerations", "mass_matrix", "forcing", "point_jacobians"))
    x, y = np.array([0.3, 0.0]), np.array([0.5, -0.2])
    ydot, forces = library.contact_dynamics(x, y), library.contact_forces(x, y)
    held = library.point_accelerations(x, y, ydot)[0, :2]
    assert held == pytest.approx(-1e-3 * forces, rel=1e-9)
    small = library.with_parameters({"mu": 1e-9})
    # At rest the equations for the loads have solutions, of which damping finds the smallest.
    still = np.zeros(2)
    a, f, j = library.mass_matrix(x), library.forcing(x, still), library.point_jacobians(x)[0, :2]
    smallest = -np.linalg.pinv(j @ np.linalg.solve(a, j.T), rcond=1e-10) @ (j @ np.linalg.solve(a, f))
    assert small.contact_forces(x, still) == pytest.approx(smallest, abs=1e-5 * np.abs(smallest).max())


def test_float() -> None:
    system = leg()
    library = kg.build(system, OUTPUTS, tier=Variant("float"))
    rng = np.random.default_rng(3)
    x = np.column_stack([rng.uniform(-1, 1, 20), rng.uniform(0.5, 2, 20)])
    states = States(x, rng.uniform(-1, 1, (20, 2))).rounded(FLOAT)
    tau = forces_of(states).astype(np.float32).astype(float)
    found = library.contact_dynamics(states.x, states.y, tau), library.contact_forces(states.x, states.y, tau)
    assert found[0].dtype == np.float32
    check(system, states, (found[0].astype(float), found[1].astype(float)), 1e-5, tau)


@pytest.mark.parametrize("precision", slow_except(("double", "float"), "double"))
def test_c_of_a_robot(precision: str) -> None:
    """A batch is what single states are, and as accurate as the arithmetic and the condition admit."""
    system, *_ = robot("solo12")
    library = kg.build(system, OUTPUTS, tier=Variant(precision), flags="-O1", on_status="ignore")
    states = random_states(system, 6).rounded(FLOAT)
    tau = forces_of(states).astype(np.float32).astype(float)
    found = library.contact_dynamics(states.x, states.y, tau), library.contact_forces(states.x, states.y, tau)
    for i in range(6):
        alone = library.evaluate(x=states.x[i], y=states.y[i], tau=tau[i])
        assert np.array_equal(alone.contact_dynamics, found[0][i], equal_nan=True)
        assert np.array_equal(alone.contact_forces, found[1][i], equal_nan=True)
    exist = np.isfinite(found[0]).all(axis=1)
    assert exist.sum() >= 5  # in single precision four feet may hold what three hold already
    kept = tuple(values[exist].astype(float) for values in found)
    roundoffs = ROUNDOFFS if precision == "double" else ROUNDOFFS * 2**29
    check(system, states.chosen(exist), (kept[0], kept[1]), roundoffs, tau[exist])


def test_derivatives() -> None:
    """Against differences of fourth order, whose error is about 1e-10."""
    system = leg()
    library = kg.build(system, ("contact_dynamics", "contact_dynamics_derivatives"))
    x, y, tau = np.array([0.3, 0.8]), np.array([0.5, -0.4]), np.array([1.0, -2.0])
    found = library.contact_dynamics_derivatives(x, y, tau)
    columns = library.derivative_columns("contact_dynamics_derivatives")
    step, weights = 1e-3, ((-2, 1), (-1, -8), (1, 8), (2, -1))
    for i, array in enumerate((x, y, tau)):
        by = columns[("x", "y", "tau")[i]]
        for k in range(2):
            total = np.zeros(2)
            for shift, weight in weights:
                moved = [x.copy(), y.copy(), tau.copy()]
                moved[i][k] = array[k] + shift * step
                total += weight * library.contact_dynamics(*moved)
            assert found[:, by][:, k] == pytest.approx(total / (12 * step), abs=1e-8)


@pytest.mark.slow
def test_a_robot_on_two_feet_costs_no_more_than_it_did() -> None:
    """Operations of accelerations and loads together; the KKT of a trial took 14 701."""
    system, *_ = robot("talos_reduced")
    assert compile_module(system, OUTPUTS).cost <= 13_726


@pytest.mark.slow
def test_each_output_costs_itself() -> None:
    """Loads need no pass outward, and accelerations no turn to inertial components."""
    system, *_ = robot("solo12")
    together, dynamics, forces, free = (
        compile_module(system, names).cost
        for names in (OUTPUTS, OUTPUTS[:1], OUTPUTS[1:], ("forward_dynamics",))
    )
    assert free < forces < dynamics < together < dynamics + forces - free


@pytest.mark.parametrize(
    ("contacts", "message"),
    [
        (
            [],
            "output 'contact_forces': system 'double_pendulum' has no contacts. Give it some in the model",
        ),
        (
            [kg.Contact(point="tip")],
            "'tip.force3' cannot be held, because in every state, but for rounding errors, no freedom moves",
        ),
        (
            [
                kg.Contact(point="tip", directions=("force1", "force2")),
                kg.Contact(point="hip", directions="force1"),
            ],
            r"'hip.force1' cannot .* 'tip.force1', 'tip.force2' hold it .* \(leave out contact 'hip'\)",
        ),
        (
            [
                kg.Contact("a", point="hip", directions="force1"),
                kg.Contact("b", point="hip", directions="force1"),
            ],
            "'b.force1' cannot be held, because in every state, but for rounding errors, 'a.force1' holds it",
        ),
        (
            [kg.Contact(frame="lower")],
            r"'lower.moment1' cannot .* The same is true of .*\(directions = \['moment3', 'force1'\] of "
            r"contact 'lower', or lower:moment3\+force1 in --contacts\)",
        ),
    ],
)
def test_contacts_that_hold_nothing_are_refused(contacts: list[kg.Contact], message: str) -> None:
    system = kg.load(MODELS / "double_pendulum.toml")
    system = system.with_points({"tip": ("lower", (0.7, 0, 0)), "hip": ("upper", (0.5, 0, 0))})
    with pytest.raises(OptionError if not contacts else SingularError, match=message) as caught:
        kg.generate(system.with_contacts(contacts), "contact_forces")
    assert "\n" not in str(caught.value)


def test_the_header_speaks_of_one_result_and_of_two() -> None:
    system = kg.load(MODELS / "double_pendulum.toml").with_points({"tip": ("lower", (0.7, 0, 0))})
    source = kg.generate(system.with_contacts("tip:force1+force2"), OUTPUTS)
    header = source.files["double_pendulum.h"]
    assert "contact_acceleration is filled all the same" in header
    assert "contact_acceleration and contact_force are filled all the same" in header


def test_damped_contacts_may_depend_on_each_other() -> None:
    system = kg.load(MODELS / "double_pendulum.toml").with_points({"tip": ("lower", (0.7, 0, 0))})
    held = [kg.Contact(point="tip", directions=("force1", "force2")), kg.Contact(frame="lower", damping=1e-3)]
    system = system.with_contacts(held)
    states = random_states(system, 3)
    for solver in ("articulated bodies", "factorisation"):
        (way,) = ways(system, solver)
        check(system, states, computed(system, way, states))
