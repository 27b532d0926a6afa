"""The literal derivation: every matrix of the notes against the NumPy reference."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
import sympy
from numpy.typing import NDArray

from kanegen import Body, Joint, Parameter, System
from kanegen.errors import ArrayError, ModelError, OptionError
from kanegen.model.coordinates import FREEDOMS
from kanegen.reference import equations as reference
from kanegen.reference import kinematics
from kanegen.reference.freedoms import free_columns
from kanegen.symbolic import Equations, derive, symbols
from kanegen.symbolic.literal.numeric import needed_definitions
from tests.support.cases import slow_except
from tests.support.systems import chain, eight_body, flags, random_system

Floats = NDArray[np.float64]
BOX = ((2.0, 0.1, -0.2), (0.1, 3.0, 0.3), (-0.2, 0.3, 2.5))

MATRICES = {
    "relative_rotation": "relative_rotation",
    "rotation": "rotation",
    "angle_rate_matrix": "rate_matrix",
    "angle_rate_matrix_rate": "rate_matrix_dot",
    "relative_angular_velocity": "relative_omega",
    "angular_velocity": "omega",
    "offset": "offset",
    "offset_rate": "offset_dot",
    "position_of_origin": "position",
    "position_of_center": "center_position",
    "velocity_of_center": "center_velocity",
}
"""Names of matrices here and in the reference."""

PARTIALS = {
    "partial_angular_velocity": "omega_y",
    "partial_angular_velocity_rate": "omega_y_dot",
    "partial_velocity_of_origin": "origin_y",
    "partial_velocity_of_origin_rate": "origin_y_dot",
    "partial_velocity_of_center": "center_y",
    "partial_velocity_of_center_rate": "center_y_dot",
}
"""Names of (3, n) matrices here and of (3, 6N) matrices in the reference."""


def values(equations: Equations, matrices: Sequence[Any], **state: Floats) -> list[Floats]:
    """Return matrices as numbers at a state, with parameters at their defaults."""
    arguments = [list(getattr(equations, name)) for name in state]
    entries = [entry for matrix in matrices for entry in matrix]
    needed = needed_definitions(equations.definitions, entries)
    replacements = [(definition.symbol, definition.value) for definition in needed]
    defaults = {symbols.parameter(p): p.value for p in equations.system.parameters}
    function = sympy.lambdify(
        [*arguments, list(defaults)], matrices, "numpy", cse=lambda expressions: (replacements, expressions)
    )
    return [np.array(value, dtype=float) for value in function(*state.values(), list(defaults.values()))]


def closeness(actual: Floats, expected: Floats) -> float:
    return float(np.abs(actual - expected).max() / max(1.0, np.abs(expected).max()))


SYSTEMS = [random_system(np.random.default_rng(seed), bodies) for seed, bodies in enumerate((1, 2, 3, 3, 4))]


@pytest.mark.parametrize("intermediates", [False, True])
@pytest.mark.parametrize(
    "system", slow_except(SYSTEMS, *SYSTEMS[:3]), ids=lambda s: f"{s.number_of_bodies}-{len(s.freedoms)}"
)
def test_matrices_of_bodies_equal_the_reference(system: System, intermediates: bool) -> None:
    rng = np.random.default_rng(1)
    x, y = rng.uniform(-1, 1, (2, len(system.freedoms)))
    equations = derive(system, intermediates)
    arrays = system.values()
    free = free_columns(arrays)
    for body, expected in zip(equations.bodies, kinematics.kinematics(arrays, x, y), strict=True):
        names = [*MATRICES, *PARTIALS]
        found = values(equations, [getattr(body, name) for name in names], x=x, y=y)
        for name, actual in zip(names, found, strict=True):
            if name in PARTIALS:
                wanted = getattr(expected, PARTIALS[name])[:, free]
            else:
                wanted = getattr(expected, MATRICES[name])
                wanted = wanted if wanted.ndim == 2 else wanted[:, None]
            assert actual.shape == wanted.shape
            assert closeness(actual, wanted) < 1e-14, (body, name)


@pytest.mark.parametrize("intermediates", [False, True])
@pytest.mark.parametrize(
    "system", slow_except(SYSTEMS, *SYSTEMS[:3]), ids=lambda s: f"{s.number_of_bodies}-{len(s.freedoms)}"
)
def test_mass_matrix_and_forcing_equal_the_reference(system: System, intermediates: bool) -> None:
    rng = np.random.default_rng(2)
    x, y = rng.uniform(-1, 1, (2, len(system.freedoms)))
    loaded = np.array([body.loads for body in system.bodies])[:, None]
    force, torque = rng.uniform(-1, 1, (2, system.number_of_bodies, 3)) * loaded
    functions = derive(system, intermediates).lambdify()
    assert closeness(functions.mass_matrix(x), reference.mass_matrix(system, x)) < 1e-13
    expected = reference.forcing(system, x, y, force, torque)
    assert closeness(functions.forcing(x, y, force, torque), expected) < 1e-13
    terms = reference.forcing_terms(system, x, y)
    without_loads = functions.forcing(x, y)
    assert closeness(without_loads, terms.total) < 1e-13
    assert not terms.loads.any()


@pytest.mark.parametrize(
    "system",
    slow_except(SYSTEMS[1:4], *SYSTEMS[1:3]),
    ids=lambda s: f"{s.number_of_bodies}-{len(s.freedoms)}",
)
def test_matrices_that_the_reference_lacks(system: System) -> None:
    """Eqs. (6), (9), (25), (33) against differences in time and the matrices that other tests check."""
    rng = np.random.default_rng(3)
    state = dict(zip(("x", "y", "ydot"), rng.uniform(-1, 1, (3, len(system.freedoms))), strict=True))
    equations = derive(system, intermediates=False)
    step = 1e-6
    later = state | {"x": state["x"] + step * state["y"], "y": state["y"] + step * state["ydot"]}
    sooner = state | {"x": state["x"] - step * state["y"], "y": state["y"] - step * state["ydot"]}
    for body in equations.bodies:
        rates = (body.rotation_rate, body.relative_rotation_rate, body.angular_acceleration)
        moving = (body.rotation, body.relative_rotation, body.angular_velocity)
        differences = [
            (after - before) / (2 * step)
            for after, before in zip(
                values(equations, moving, **later), values(equations, moving, **sooner), strict=True
            )
        ]
        for rate, difference in zip(values(equations, rates, **state), differences, strict=True):
            assert closeness(rate, difference) < 1e-8
        inverse, matrix = values(equations, (body.angle_rate_inverse, body.angle_rate_matrix), **state)
        assert closeness(inverse @ matrix, np.eye(3)) < 1e-13
        v, v_y = values(equations, (body.velocity_of_origin, body.partial_velocity_of_origin), **state)
        assert closeness(v, v_y @ state["y"][:, None]) < 1e-13
        inertial = (body.rotation, body.velocity_of_center, body.acceleration_of_center)
        (r1, v1, _), (r0, v0, _) = (values(equations, inertial, **at) for at in (later, sooner))
        rotation, _, acceleration = values(equations, inertial, **state)
        assert closeness(rotation.T @ acceleration, (r1.T @ v1 - r0.T @ v0) / (2 * step)) < 1e-7


def test_generalized_forces_are_loads_and_weight() -> None:
    system = SYSTEMS[3]
    rng = np.random.default_rng(4)
    x, y = rng.uniform(-1, 1, (2, len(system.freedoms)))
    force, torque = rng.uniform(-1, 1, (2, system.number_of_bodies, 3))
    equations = derive(system, intermediates=False)
    loads = {
        symbol(body.number, axis): array[body.number - 1, axis]
        for body in equations.bodies
        for symbol, array in ((symbols.force, force), (symbols.torque, torque))
        for axis in range(3)
    }
    loaded = np.array([body.loads for body in system.bodies])[:, None]
    terms = reference.forcing_terms(system, x, y, force * loaded, torque * loaded)
    (found,) = values(equations, [equations.generalized_forces.xreplace(loads)], x=x)
    assert closeness(found.ravel(), terms.loads + terms.gravity) < 1e-13


def test_zeros_and_ones_vanish() -> None:
    only_theta3 = Joint(free=(False, False, True, False, False, False))
    hinge = derive(System("hinge", (Body("rod", 0, 2.0, BOX, joint=only_theta3),)))
    body = hinge.bodies[0]
    angle = symbols.coordinate(1, 2)
    sine, cosine = sympy.sin(angle), sympy.cos(angle)
    assert body.rotation == sympy.ImmutableMatrix([[cosine, sine, 0], [-sine, cosine, 0], [0, 0, 1]])
    assert body.partial_angular_velocity == sympy.ImmutableMatrix([0, 0, 1])
    assert list(hinge.A) == [2.5]
    only_s = Joint(free=(False, False, False, True, True, True))
    slider = derive(System("slider", (Body("cart", 0, 2.0, BOX, joint=only_s),)))
    assert slider.bodies[0].rotation == sympy.eye(3)
    assert list(slider.A) == [2, 0, 0, 0, 2, 0, 0, 0, 2]


def test_locked_right_angle_is_exact() -> None:
    joint = Joint(free=(True,) + (False,) * 5, locked=(0.0, np.pi / 2, 0.0, 0.0, 0.0, 0.0))
    body = derive(System("turned", (Body("rod", 0, 2.0, BOX, joint=joint),))).bodies[0]
    assert body.angle_rate_matrix == sympy.ImmutableMatrix([[0, 0, 0], [0, 1, 0], [1, 0, 1]])


def test_numbers_are_exact() -> None:
    for value in (0.1, -2.5, 1e300, 5e-324, 2.0**40, -7.0, 0.0, 1.0):
        assert float(symbols.expression(value)) == value
    assert symbols.expression(0.0) is sympy.S.Zero
    assert symbols.expression(1.0) is sympy.S.One
    assert symbols.expression(Parameter("m", 2.0)) == sympy.Symbol("m", real=True)


def test_parameters_in_every_place() -> None:
    """Parameters, also those named like functions or intermediates, give the values of plain numbers."""
    defaults = {
        "sin": 1.2,
        "lambda": 0.4,
        "R_1_11": 0.7,
        "g": -9.7,
        "angle": 0.3,
        "I": 2.6,
    }
    p = {name: Parameter(name, value) for name, value in defaults.items()}
    joint = Joint(
        position=(0.0, p["lambda"], 0.0),
        orientation=(p["angle"], 0.2, 0.0),
        free=(True, False, True, False, True, False),
        locked=(0.0, p["R_1_11"], 0.0, p["lambda"], 0.0, 0.0),
    )
    inertia = ((p["I"], 0.1, 0.0), (0.1, 3.0, 0.3), (0.0, 0.3, 2.5))
    first = Body("first", 0, p["sin"], inertia, (0.1, p["lambda"], 0.0), joint, loads=True)
    second = dataclasses.replace(first, name="second", lower=1)
    system = System("open", (first, second), (0.0, p["R_1_11"], p["g"]))
    changed = {"sin": 0.5, "g": 3.0, "angle": -1.0}
    x, y = np.random.default_rng(5).uniform(-1, 1, (2, 6))
    for intermediates in (True, False):
        functions = derive(system, intermediates).lambdify()
        for values_, expected in ((None, system), (changed, system.with_parameters(changed))):
            A = functions.mass_matrix(x, values_)
            assert closeness(A, reference.mass_matrix(expected, x)) < 1e-13
            f = functions.forcing(x, y, parameters=values_)
            assert closeness(f, reference.forcing(expected, x, y)) < 1e-13


def test_definitions_are_in_order_and_defined_once() -> None:
    equations = derive(eight_body())
    known = {*equations.x, *equations.y, *equations.loads}
    for definition in equations.definitions:
        assert definition.value.free_symbols <= known, definition
        assert definition.symbol not in known
        known.add(definition.symbol)
    for matrix in (equations.A, equations.f):
        assert matrix.free_symbols <= known
    backwards = derive(eight_body())
    assert backwards.bodies[7].net_force
    assert backwards.definitions == equations.definitions


def test_small_trees_have_no_intermediates() -> None:
    equations = derive(chain(3))
    assert equations.definitions == ()
    assert equations.A.free_symbols <= set(equations.x)
    assert derive(chain(3), intermediates=True).definitions


@pytest.mark.slow
def test_big_trees_are_derived_at_once() -> None:
    start = time.perf_counter()
    long = derive(chain(64, FREEDOMS))
    assert long.bodies[63].rotation.free_symbols
    equations = derive(eight_body())
    assert equations.A.shape == (48, 48)
    assert equations.f.shape == (48, 1)
    assert time.perf_counter() - start < 20


@pytest.mark.slow
def test_no_chain_is_too_long_for_the_stack() -> None:
    deep = derive(chain(400))
    assert deep.bodies[-1].rotation.shape == (3, 3)
    assert deep.bodies[-1].angular_velocity.shape == (3, 1)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda e: e.closed_form(), r"12 freedoms; closed forms are written for at most 8"),
        (lambda e: e.lambdify().mass_matrix(np.zeros(3)), r"x has shape \(3,\); expected \(12,\)"),
        (lambda e: e.lambdify().mass_matrix("a" * 12), r"x: expected real numbers of shape \(12,\), got 'aa"),
        (lambda e: e.lambdify().forcing(np.zeros(12), np.zeros((12, 1))), r"y has shape \(12, 1\)"),
        (
            lambda e: e.lambdify().forcing(np.zeros(12), np.zeros(12), force=np.zeros(3)),
            r"force has shape \(3,\); expected \(2, 3\)",
        ),
        (lambda e: e.lambdify().mass_matrix(np.zeros(12), {"m": 1.0}), "unknown parameter 'm'"),
    ],
)
def test_errors(call: Any, message: str) -> None:
    system = random_system(np.random.default_rng(6), 2, free=flags(2, FREEDOMS))
    with pytest.raises((ArrayError, ModelError, OptionError), match=message):
        call(derive(system))
