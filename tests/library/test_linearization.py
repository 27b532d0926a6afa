"""Linear models by the derivatives in C: textbooks, differences in 40 digits, names, and what is refused."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import control
import mpmath
import numpy as np
import pytest
import sympy

import kanegen as kg
from kanegen.reference import equations as reference
from kanegen.symbolic import derive
from kanegen.symbolic.symbols import parameter
from tests.support.cases import slow_except
from tests.support.high_precision import Exact, exact_system
from tests.support.orientation_trees import KINDS, tree_of_kind
from tests.support.paths import MODELS

HINGE = kg.Joint(free=(False, False, True, False, False, False))

STEP = mpmath.mpf(10) ** -20
"""Step of central differences: in 60 digits truncation and rounding are both below 1e-38 of the values."""


def along(system: kg.System, state: Sequence[Any], way: Sequence[Any]) -> np.ndarray:
    """Return the derivative of {ydot} along a change of {x}, {y} and {tau}, by the reference in 60 digits."""
    with mpmath.workdps(60):
        arrays, ends = exact_system(system.values()), []
        for sign in (1, -1):
            x, y, tau = (
                np.array([Exact(a + sign * STEP * b) for a, b in zip(*pair, strict=True)], object)
                for pair in zip(state, way, strict=True)
            )
            matrix = mpmath.matrix(reference.mass_matrix(arrays, x).tolist())
            right = mpmath.matrix((reference.forcing(arrays, x, y) + tau).tolist())
            ends.append(mpmath.lu_solve(matrix, right))
        return np.array([float((a - b) / (2 * STEP)) for a, b in zip(*ends, strict=True)])


def differences(system: kg.System, state: Sequence[Any], prescribed: Any = ()) -> np.ndarray:
    """Return the derivatives of {ydot} by {x}, {y}, {tau}: differences of the literal equations."""
    equations = derive(system, intermediates=False)
    given = [*equations.x, *equations.y, *equations.prescribed, *map(parameter, system.parameters)]
    functions = [sympy.lambdify(given, matrix, "mpmath") for matrix in (equations.A, equations.f)]
    numbers = [*np.ravel(prescribed), *(one.value for one in system.parameters)]
    flat = [*(one for part in state for one in part)]
    n = len(equations.y)

    def accelerations(values: list[Any]) -> Any:
        A, f = (function(*map(mpmath.mpf, [*values[:-n], *numbers])) for function in functions)
        return mpmath.lu_solve(A, f + mpmath.matrix(values[-n:]))

    with mpmath.workdps(60):
        columns = []
        for place in range(len(flat)):
            up, down = ([*flat], [*flat])
            up[place], down[place] = flat[place] + STEP, flat[place] - STEP
            columns.append((accelerations(up) - accelerations(down)) / (2 * STEP))
        return np.array([[float(one) for one in column] for column in columns]).T


def test_a_pendulum_swings_at_the_root_of_g_over_l() -> None:
    body = kg.Body("bob", 0, 2.0, np.zeros((3, 3)), (0.7, 0, 0), HINGE)
    (mode,) = kg.linearize(kg.System("pendulum", (body,), (9.81, 0, 0))).modes
    assert mode.frequency == pytest.approx(np.sqrt(9.81 / 0.7) / (2 * np.pi), rel=1e-14)
    assert mode.shape == {"bob.theta3": 1}


def test_a_cart_with_a_pole() -> None:
    """Textbook matrices about the upright position, with total inertia J = I + m l^2."""
    M, m, half, g = 1.0, 0.1, 0.5, 9.81
    J = 0.008333333333333333 + m * half**2
    det = (M + m) * J - (m * half) ** 2
    model = kg.linearize(kg.load(MODELS / "cart_pole.toml"), inputs=["cart_position"])
    assert model.state_names == ("x.pole", "x.cart_position", "y.pole", "y.cart_position")
    assert model.input_names == ("tau.cart_position",)
    expected = np.zeros((4, 4))
    expected[:2, 2:] = np.eye(2)
    expected[2, 0], expected[3, 0] = (M + m) * m * g * half / det, -((m * half) ** 2) * g / det
    assert pytest.approx(expected, rel=1e-13) == model.A
    assert model.B.ravel() == pytest.approx([0, 0, -m * half / det, J / det], rel=1e-13)
    assert model.stability.verdict == "unstable"
    assert model.controllability.is_complete
    assert not kg.linearize(kg.load(MODELS / "cart_pole.toml"), inputs=[]).controllability.dimension


def test_a_quarter_car() -> None:
    """The textbook's matrices, with the states wheel, chassis and their rates."""
    m_u, m_s, k_t, c_t, k, c = 40.0, 300.0, 160000.0, 50.0, 16000.0, 1000.0
    model = kg.linearize(
        kg.load(MODELS / "quarter_car.toml"), prescribed=np.zeros((3, 1)), outputs=["point_accelerations"]
    )
    K = [[-(k + k_t) / m_u, k / m_u], [k / m_s, -k / m_s]]
    D = [[-(c + c_t) / m_u, c / m_u], [c / m_s, -c / m_s]]
    assert pytest.approx(np.block([[np.zeros((2, 2)), np.eye(2)], [np.array(K), np.array(D)]])) == model.A
    assert model.stability.verdict == "asymptotically stable"
    hop, bounce = (
        max(model.modes, key=key) for key in (lambda one: one.frequency, lambda one: -one.frequency)
    )
    assert 10 < hop.natural_frequency < 11
    assert 1.0 < bounce.natural_frequency < 1.2
    seat = model.output_names.index("point_accelerations.seat.z")
    assert model.C[seat] == pytest.approx([*K[1], *D[1]])
    assert model.D[seat] == pytest.approx([0, 1 / m_s])


CASES = {
    "furuta_pendulum": ([0.4, 0.0], [0.0, 0.0], [0.0, 0.0]),
    "furuta_pendulum in motion": ([0.4, 0.7], [2.0, -1.0], [0.1, 0.0]),
    "cart_two_poles": ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
    "cart_two_poles in motion": ([0.3, -0.2, 0.5], [1.0, 2.0, -0.4], [1.0, 0.0, 0.3]),
    "quarter_car": ([0.0, 0.0], [0.0, 0.0], [0.0, 0.0]),
    "quarter_car in motion": ([0.01, -0.02], [0.3, 0.1], [10.0, 2.0]),
}


@pytest.mark.parametrize("case", CASES)
def test_against_differences_in_60_digits(case: str) -> None:
    system = kg.load(MODELS / f"{case.split(maxsplit=1)[0]}.toml")
    inputs = {"prescribed": np.array([[0.01], [0.1], [0.0]])} if system.prescribed else {}
    x, y, tau = CASES[case]
    model = kg.linearize(system, x, y, tau, **inputs)
    expected = differences(system, (x, y, tau), inputs.get("prescribed", ()))
    m, n = len(x), len(y)
    found = np.concatenate([model.A[m:], model.B[m:]], axis=1)
    assert found == pytest.approx(expected, rel=1e-12, abs=1e-12 * np.abs(expected).max())
    assert (model.A[:m] == np.eye(m, m + n, m)).all()


@pytest.mark.parametrize("kind", slow_except(KINDS, "quaternions"))
def test_every_kind_of_coordinates(kind: str) -> None:
    system = tree_of_kind(kind, 3)
    rng = np.random.default_rng(5)
    x = rng.uniform(-1, 1, len(system.coordinates))
    y, tau = rng.normal(size=(2, len(system.freedoms)))
    way = [rng.normal(size=len(part)) for part in (x, y, tau)]
    model = kg.linearize(system, x, y, tau)
    found = np.concatenate([model.A[len(x) :], model.B[len(x) :]], axis=1) @ np.concatenate(way)
    expected = along(system, (x, y, tau), way)
    assert found == pytest.approx(expected, abs=1e-11 * np.abs(expected).max())  # [A] has condition 100


def test_a_quaternion_and_angles_have_the_same_modes() -> None:
    """About rest the small rotations about the axes of a body are the deviations of the 1-2-3 angles."""
    body = kg.Body(
        "buoy", 0, 2.0, np.diag([0.2, 0.3, 0.4]), (0.01, 0.02, -0.5), kg.Joint(coordinates="quaternion")
    )
    moor = [kg.JointSpring(f"buoy.s{k}", stiffness=50.0 + k, damping=0.4) for k in (1, 2, 3)]
    system = kg.System("buoy", (body,), (0, 0, -9.81)).with_force_elements(*moor)
    x = {"buoy.s3": -2 * 9.81 / 53.0}
    turned = kg.linearize(system, x)
    angles = kg.linearize(system.with_coordinates("angles").with_speeds("angular_velocity"), x)
    assert turned.A.shape == (13, 13)
    assert pytest.approx(angles.A, abs=1e-12 * np.abs(angles.A).max()) == turned.minimal.A
    assert "phi.buoy.omega1" in turned.minimal.state_names
    assert not turned.is_minimal
    assert "length of a quaternion has no meaning" in str(turned)


@pytest.mark.parametrize("length", [1.0, 3.0])
def test_a_spinning_body_turns_its_small_rotations(length: float) -> None:
    """Euler's equations about a steady spin: growth about the middle axis, by the textbook's rate.

    The deviations {phi} between rotating axes obey d/dt {phi} = -{omega} x {phi} + {delta omega}.
    """
    inertia, spin = np.array([2.0, 3.0, 4.0]), 3.0
    body = kg.Body("stone", 0, 1.0, np.diag(inertia), joint=kg.Joint(coordinates="quaternion"))
    system = kg.System("stone", (body,), (0, 0, 0))
    x = length * np.array([0.5, 0.5, -0.5, 0.5])
    state = dict(zip(system.coordinate_names, [*x, 0, 0, 0], strict=True))
    model = kg.linearize(system, state, {"stone.omega2": spin})
    rate = spin * np.sqrt((inertia[2] - inertia[1]) * (inertia[1] - inertia[0]) / (inertia[0] * inertia[2]))
    assert max(mode.growth for mode in model.modes) == pytest.approx(rate, rel=1e-12)
    A = model.minimal.A
    assert A[:3, :3] == pytest.approx(np.array([[0, 0, -spin], [0, 0, 0], [spin, 0, 0]]), abs=1e-13)
    assert not model.is_equilibrium


def test_outputs_have_names_and_derivatives() -> None:
    system = kg.load(MODELS / "furuta_pendulum.toml")
    of_x = ["point_positions", "potential_energy", "mass_center"]
    of_both = ["point_velocities", "kinetic_energy", "momentum"]
    x, y = np.array([0.2, 0.5]), np.array([0.4, -1.0])
    model = kg.linearize(system, x, y, outputs=[*of_x, *of_both, "x.pendulum", "y.arm_angle"])
    assert model.output_names[:3] == tuple(f"point_positions.tip.{k}" for k in "xyz")
    assert model.output_names[3:5] == ("potential_energy", "mass_center.x")
    library = kg.build(system, [*of_x, *of_both])

    def values(at: np.ndarray) -> np.ndarray:
        parts = [getattr(library, name)(at[:2]) for name in of_x]
        parts += [getattr(library, name)(at[:2], at[2:]) for name in of_both]
        return np.concatenate([*(np.ravel(part) for part in parts), [at[1], at[2]]])

    at, step = np.concatenate([x, y]), 1e-5
    slopes = [(values(at + step * e) - values(at - step * e)) / (2 * step) for e in np.eye(4)]
    assert pytest.approx(np.array(slopes).T, abs=1e-9) == model.C  # truncation of 1e-10
    assert not model.D.any()


def test_python_control_takes_a_model() -> None:
    model = kg.linearize(kg.load(MODELS / "cart_two_poles.toml"), inputs=["position"])
    one = model.to_control()
    assert one.input_labels == ["tau_position"]
    assert one.state_labels[0] == "x_q1"
    assert (one.A == model.A).all()
    gains, _, poles = control.lqr(one, np.eye(6), np.eye(1))
    assert (np.asarray(poles).real < 0).all()
    assert np.linalg.eigvals(model.A - model.B @ gains).real.max() < 0


def test_equal_poles_cannot_be_balanced_together() -> None:
    system = kg.load(MODELS / "cart_two_poles.toml")
    assert kg.linearize(system, inputs=["position"]).controllability.is_complete
    twins = system.with_parameters({"m2": 0.2, "l2": 0.5, "I2": 0.0167})
    found = kg.linearize(twins, inputs=["position"]).controllability
    assert found.dimension == 4
    pole = np.sqrt(0.2 * 9.81 * 0.5 / (0.0167 + 0.2 * 0.25))
    assert sorted(value.real for value in found.remaining) == pytest.approx([-pole, pole])


def test_formats() -> None:
    model = kg.linearize(kg.load(MODELS / "furuta_pendulum.toml"), inputs="arm_angle", outputs="x.arm_angle")
    data = json.loads(model.render("json"))
    assert np.array(data["A"]) == pytest.approx(model.A)
    assert data["stability"]["verdict"] == "unstable"
    space: dict[str, Any] = {}
    exec(model.render("python"), space)
    assert all((space[name] == getattr(model, name)).all() for name in "ABCD")
    assert space["state_names"] == list(model.state_names)
    assert r"\begin{bmatrix}" in model.render("latex")
    text = str(model)
    assert "stability: unstable: pendulum" in text
    assert "inputs tau.arm_angle: controllable (rank 4 of 4)" in text


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"x": {"pol": 0.1}}, "x: there is no 'pol'. Did you mean 'pole'?"),
        ({"x": [1.0]}, "expected shape (2,), got (1,)"),
        ({"inputs": ["pole", "pole"]}, "a freedom is named twice"),
        ({"inputs": ["cart"]}, "inputs: there is no freedom 'cart'"),
        ({"outputs": ["kinetic_energi"]}, "Did you mean 'kinetic_energy'?"),
        ({"outputs": ["body_poses"]}, "a linear model has no output 'body_poses'"),
        ({"y": {"pole": "fast"}}, "y: the value of 'pole' is 'fast', which is no finite number"),
        ({"x": {"pole": np.nan}}, "x: the value of 'pole' is nan, which is no finite number"),
        ({"x": [0.0, np.inf]}, "x: the value of 'cart_position' is no finite number"),
        ({"outputs": "point_positions"}, "output 'point_positions': system 'cart_pole' has no points"),
    ],
)
def test_what_is_refused(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(kg.KanegenError) as found:
        kg.linearize(kg.load(MODELS / "cart_pole.toml"), **arguments)
    assert message in str(found.value)


def test_a_library_without_derivatives_says_so() -> None:
    library = kg.build(kg.load(MODELS / "cart_pole.toml"))
    with pytest.raises(kg.OptionError, match="without the output 'forward_dynamics'"):
        library.linearize()
