"""All twelve sequences of axes, compared with certified truth, the reference, SciPy and one another."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import sympy
from scipy.spatial.transform import Rotation

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.errors import ModelError, ReadError
from kanegen.measure.truth import truth
from kanegen.model.body import Body
from kanegen.model.coordinates import FREEDOMS, SEQUENCES
from kanegen.model.joint import Joint
from kanegen.program.evaluate import evaluate
from kanegen.recursion.outputs import output_array
from kanegen.reference import equations as reference
from kanegen.reference.kinematics import kinematics
from kanegen.symbolic import derive
from kanegen.symbolic.literal.orientation import Angles
from tests.support import moving_bodies, systems
from tests.support.cases import slow_except

U = 2.0**-53
DYNAMICS = ("mass_matrix", "forcing", "inverse_dynamics", "forward_dynamics")
MOTION = ("kinetic_energy", "potential_energy", "momentum", "mass_center", "body_poses")
JOINTS = (FREEDOMS, ("theta1", "theta3", "s2"), ("theta2",))
ENDS_ALIKE = [name for name in SEQUENCES if name[0] == name[-1]]
Arrays = dict[str, Any]


def values(system: kg.System, outputs: tuple[str, ...], inputs: Arrays) -> Arrays:
    """Return outputs that one program computes together."""
    module = compile_module(system, outputs).module
    program = module.functions.get("evaluate") or module.functions[outputs[0]]
    results = evaluate(program, {name: np.ravel(value) for name, value in inputs.items()}, np)
    return {name: np.array(results[output_array(system, name, {name: ""}).name]) for name in outputs}


def tree(sequence: str, seed: int, joints: Any = JOINTS) -> kg.System:
    """Return a branched tree with loads on all bodies and joints that are free in the named freedoms."""
    free = np.array([[name in joint for name in FREEDOMS] for joint in joints])
    rng, bodies = np.random.default_rng(seed), len(free)
    tree = systems.random_system(rng, bodies, connection=(0, 1, 1, 2)[:bodies], free=free, loads=True)
    return systems.from_values(replace(tree.values(), sequence=(sequence,) * bodies))


def inputs(system: kg.System, seed: int) -> Arrays:
    rng = np.random.default_rng(seed)
    vectors = rng.uniform(-1, 1, (4, len(system.freedoms)))
    for i, freedom in enumerate(system.freedoms):  # a middle angle of about 1 rad: regular in every sequence
        if freedom.index == 1:
            vectors[0, i] = 1 + 0.2 * vectors[0, i]
    found = dict(zip(("x", "y", "tau", "ydot"), vectors, strict=True))
    return found | {name: rng.normal(size=(system.number_of_bodies, 3)) for name in ("force", "torque")}


@pytest.mark.parametrize("sequence", slow_except(SEQUENCES, *list(SEQUENCES)[::6]))
def test_against_truth_and_the_reference(sequence: str) -> None:
    system = tree(sequence, 3)
    given, arrays = inputs(system, 4), system.values()
    exact = truth(system, **given, outputs=DYNAMICS)
    found = values(system, (*DYNAMICS, *MOTION), given)
    condition = np.linalg.cond(exact["mass_matrix"].value)
    for name in DYNAMICS:
        expected = np.ravel(exact[name].value)
        bound = 40 * U * (condition if name == "forward_dynamics" else 40)
        assert np.abs(found[name] - expected).max() <= bound * np.abs(expected).max(), name
    state = [given[name] for name in ("x", "y", "force", "torque")]
    theirs = {
        "mass_matrix": reference.mass_matrix(arrays, state[0]),
        "forcing": reference.forcing(arrays, *state),
    }
    for name, expected in (theirs | moving_bodies.expected(arrays, *state[:2])).items():
        assert found[name] == pytest.approx(np.ravel(expected), rel=1e-12, abs=1e-13 * np.abs(expected).max())


@pytest.mark.parametrize("sequence", slow_except(SEQUENCES, "2-1-3", "3-1-3"))
def test_literal_equations(sequence: str) -> None:
    """The notes' equations in SymPy equal the reference, with locked angles too."""
    system = tree(sequence, 5, JOINTS[:2])
    given = inputs(system, 6)
    equations = derive(system).lambdify()
    a = reference.mass_matrix(system.values(), given["x"])
    assert equations.mass_matrix(given["x"]) == pytest.approx(a, abs=1e-13 * np.abs(a).max())
    state = [given[name] for name in ("x", "y", "force", "torque")]
    f = reference.forcing(system.values(), *state)
    assert equations.forcing(*state) == pytest.approx(f, abs=1e-13 * np.abs(f).max())


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_rotations_of_scipy(sequence: str) -> None:
    """Intrinsic turns about X, Y, Z; SciPy's matrix takes body components to those before the turns."""
    joint = Joint(free=(True, True, True, False, False, False), sequence=sequence)
    system = kg.System("one", (Body("one", 0, 1.0, np.eye(3), joint=joint),))
    angles = np.random.default_rng(8).uniform(-3, 3, 3)
    letters = "".join("XYZ"[axis] for axis in SEQUENCES[sequence])
    expected = Rotation.from_euler(letters, angles).as_matrix().T
    poses = values(system, ("body_poses",), {"x": angles})["body_poses"].reshape(4, 3)
    assert poses[:3] == pytest.approx(expected, abs=4 * U * 2)
    (frame,) = kinematics(system.values(), angles, angles)
    assert frame.rotation == pytest.approx(expected, abs=8 * U)


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_rate_matrices(sequence: str) -> None:
    """Eqs. (8), (9), (17), (20) in SymPy equal derivatives of Eq. (4), in numbers of 50 digits."""
    theta, rates = sympy.symbols("theta_1:4", real=True), sympy.symbols("u_1:4", real=True)
    angles = Angles(SEQUENCES[sequence], [sympy.sin(t) for t in theta], [sympy.cos(t) for t in theta])
    at = dict(zip((*theta, *rates), sympy.sympify("(1/3, 4/5, -7/6, 2/3, -5/4, 8/7)"), strict=True))

    def rate(matrix: Any) -> Any:
        return sum(
            (matrix.diff(t) * u for t, u in zip(theta, rates, strict=True)), sympy.zeros(*matrix.shape)
        )

    def is_zero(matrix: Any) -> bool:
        return max(abs(entry) for entry in matrix.subs(at).evalf(50)) < 1e-45

    turning = -rate(angles.rotation) * angles.rotation.T
    omega = sympy.Matrix([turning[2, 1], turning[0, 2], turning[1, 0]])
    assert is_zero(angles.rate_matrix * sympy.Matrix(rates) - omega)
    assert is_zero(angles.rate_matrix_rate(rates) - rate(angles.rate_matrix))
    assert is_zero(angles.rate_matrix * angles.rate_inverse - sympy.eye(3))


def test_the_matrices_of_the_notes() -> None:
    """The products of three turns are Eqs. (4), (9) and (17) as the notes write them."""
    (s1, s2, s3), (c1, c2, c3) = s, c = sympy.symbols("s1:4"), sympy.symbols("c1:4")
    angles = Angles(SEQUENCES["1-2-3"], s, c)
    assert angles.rotation.tolist() == [
        [c2 * c3, c1 * s3 + s1 * s2 * c3, s1 * s3 - c1 * s2 * c3],
        [-c2 * s3, c1 * c3 - s1 * s2 * s3, s1 * c3 + c1 * s2 * s3],
        [s2, -s1 * c2, c1 * c2],
    ]
    assert angles.rate_matrix.tolist() == [[c2 * c3, s3, 0], [-c2 * s3, c3, 0], [s2, 0, 1]]
    assert angles.rate_inverse.tolist() == [
        [c3 / c2, -s3 / c2, 0],
        [s3, c3, 0],
        [-s2 * c3 / c2, s2 * s3 / c2, 1],
    ]


@pytest.mark.parametrize(
    "other", slow_except([name for name in SEQUENCES if name != "1-2-3"], "3-2-1", "3-1-3", "2-3-2")
)
def test_other_angles_of_the_same_motion(other: str) -> None:
    """Two sequences, one orientation and one angular velocity: equal poses, energies and accelerations."""
    first, second = (tree(sequence, 9, [FREEDOMS[:3]] * 2) for sequence in ("1-2-3", other))
    given = inputs(first, 10) | {"tau": np.zeros(6)}
    renamed = given | dict(zip(("x", "y"), mapped(given["x"], given["y"], "1-2-3", other), strict=True))
    outputs = (*MOTION, "forward_dynamics")
    one, two = values(first, outputs, given), values(second, outputs, renamed)
    for name in MOTION:
        assert two[name] == pytest.approx(one[name], rel=1e-12, abs=1e-12), name
    old = angular_accelerations(first, given, one["forward_dynamics"])
    new = angular_accelerations(second, renamed, two["forward_dynamics"])
    assert new == pytest.approx(old, abs=1e-11 * np.abs(old).max())


def mapped(x: Any, y: Any, old: str, new: str) -> tuple[Any, Any]:
    """Return angles and rates of bodies that only turn in another sequence of axes, by SciPy."""
    letters = ["".join("XYZ"[axis] for axis in SEQUENCES[name]) for name in (old, new)]
    angles, rates = [], []
    for theta, rate in zip(x.reshape(-1, 3), y.reshape(-1, 3), strict=True):
        angles.append(Rotation.from_euler(letters[0], theta).as_euler(letters[1]))
        rates.append(np.linalg.solve(axes(angles[-1], new), axes(theta, old) @ rate))
    return np.ravel(angles), np.ravel(rates)


def axes(theta: Any, sequence: str) -> Any:
    """Return (3, 3) axes of the three angles in body components, as columns, by SciPy."""
    columns, outward = [], np.eye(3)
    for axis, angle in reversed(list(zip(SEQUENCES[sequence], theta, strict=True))):
        columns.append(outward[:, axis])
        outward = outward @ Rotation.from_euler("XYZ"[axis], angle).as_matrix().T
    return np.transpose(columns[::-1])


def angular_accelerations(system: kg.System, given: Arrays, ydot: Any) -> Any:
    """Return the angular accelerations of all bodies in their own components, (N, 3) (rad/s^2)."""
    bodies = kinematics(system.values(), given["x"], given["y"])
    return np.array([body.omega_y @ full(ydot) + body.omega_y_dot @ full(given["y"]) for body in bodies])


def full(angles_only: Any) -> Any:
    return np.concatenate([angles_only, np.zeros_like(angles_only)])


@pytest.mark.parametrize("sequence", slow_except(SEQUENCES, *list(SEQUENCES)[1::6]))
def test_angular_velocities_as_speeds(sequence: str) -> None:
    """Rates of the angles follow Eq. (9), and angular accelerations equal those from angle rates."""
    rates = tree(sequence, 13, [FREEDOMS[:3]] * 2)
    spinning = rates.with_speeds("angular_velocity")
    given = inputs(rates, 14) | {"tau": np.zeros(6)}
    turning = [axes(theta, sequence) for theta in given["x"].reshape(2, 3)]
    omega = np.ravel([matrix @ rate for matrix, rate in zip(turning, given["y"].reshape(2, 3), strict=True)])
    found = values(spinning, ("forward_dynamics", "coordinate_rates", "kinetic_energy"), given | {"y": omega})
    plain = values(rates, ("forward_dynamics", "kinetic_energy"), given)
    assert found["coordinate_rates"] == pytest.approx(given["y"], abs=32 * U * np.abs(given["y"]).max())
    assert found["kinetic_energy"] == pytest.approx(plain["kinetic_energy"], rel=64 * U)
    exact = truth(spinning, **(given | {"y": omega}), outputs=("forward_dynamics",))["forward_dynamics"].value
    assert np.abs(found["forward_dynamics"] - exact).max() <= 200 * U * np.abs(exact).max()
    # The relative angular accelerations of both, as [Pdot]{rates} + [P]{accelerations}.
    bodies = kinematics(rates.values(), given["x"], given["y"])
    accelerations = plain["forward_dynamics"].reshape(2, 3)
    for k, body in enumerate(bodies):
        relative = body.rate_matrix @ accelerations[k] + body.rate_matrix_dot @ given["y"].reshape(2, 3)[k]
        assert relative == pytest.approx(
            found["forward_dynamics"].reshape(2, 3)[k], abs=1e-12 * np.abs(exact).max()
        )


@pytest.mark.parametrize("distance", [1e-1, 1e-6, 1e-12])
@pytest.mark.parametrize("sequence", ["3-1-3", "2-1-2", "2-1-3"])
def test_near_the_singularity(sequence: str, distance: float) -> None:
    """Nothing is lost where the axes almost lie in a plane, at theta2 = 0 or pi/2."""
    system = tree(sequence, 11, [FREEDOMS] * 3)
    given = inputs(system, 12)
    given["tau"] *= 0.0  # its torque would grow like one over the distance
    middle = np.array([freedom.index == 1 for freedom in system.freedoms])
    given["x"][middle] = distance if sequence in ENDS_ALIKE else np.pi / 2 - distance
    del given["ydot"]
    found = values(system, ("forward_dynamics",), given)["forward_dynamics"]
    exact = truth(system, **given, outputs=("forward_dynamics",))["forward_dynamics"].value
    index = np.array([freedom.index for freedom in system.freedoms])
    for part in (np.isin(index, (1, 3, 4, 5)), np.isin(index, (0, 2))):  # regular; growing like 1 / distance
        assert np.abs(found - exact)[part].max() <= 80 * 3 * U * np.abs(exact[part]).max()


@pytest.mark.parametrize("sequence", ["3-1-3", "1-2-1"])
def test_singular_where_the_middle_angle_is_zero(sequence: str) -> None:
    system = systems.from_values(replace(systems.chain(1, FREEDOMS[:3]).values(), sequence=(sequence,)))
    library = kg.build(system, ("forward_dynamics",))
    x, y = np.array([0.3, 0.0, 0.4]), np.zeros(3)
    with pytest.raises(kg.KanegenError, match=r"\[A\] is singular"):
        library.forward_dynamics(x, y)
    assert np.isfinite(library.forward_dynamics(x + np.array([0, 1, 0]), y)).all()


def test_model_files(tmp_path: Any) -> None:
    names = ("3-1-3", "1-2-3", "1-3-2")
    system = systems.from_values(replace(tree("3-1-3", 1).values(), sequence=names))
    system.save(tmp_path / "tree.toml")
    text = (tmp_path / "tree.toml").read_text()
    assert text.count("sequence") == 2 and 'sequence = "3-1-3"' in text
    loaded = kg.load(tmp_path / "tree.toml")
    assert [body.joint.sequence for body in loaded.bodies] == list(names)
    assert [body.joint for body in loaded.bodies] == [body.joint for body in system.bodies]
    (tmp_path / "tree.toml").write_text(text.replace("3-1-3", "3-3-1"))
    message = r"body 'body1': joint sequence: '3-3-1' is none of the twelve. Known are '1-2-1', "
    with pytest.raises(ReadError, match=message):
        kg.load(tmp_path / "tree.toml")


@pytest.mark.parametrize("name", ["xyz", "1-1-2", 313, ["1-2-3"]])
def test_unknown_sequences(name: Any) -> None:
    with pytest.raises(ModelError, match=r"joint sequence: .* is none of the twelve"):
        Joint(sequence=name)


def test_closed_forms_of_parallel_hinges() -> None:
    """Angles of parallel hinges are added up for any sequence of axes."""
    free = (True, False, False, False, False, False)
    upper, lower = (
        Body(name, k, 1.0, np.eye(3), (1.0, 0, 0), Joint((k, 0, 0), free=free, sequence="3-1-2"))
        for k, name in enumerate(("upper", "lower"))
    )
    text = str(kg.derive(kg.System("pair", (upper, lower), (0, -9.81, 0))).closed_form().f)
    assert "cos(theta_1_1 + theta_2_1)" in text


def test_the_top_of_the_textbooks() -> None:
    """[A] and the moment of the weight of a symmetric top in the angles 3-1-3: precession, nutation, spin."""
    values_of = dict(zip("ijmhg", (0.2, 0.1, 2.0, 0.3, -9.8), strict=True))
    i, j, m, h, g = (kg.Parameter(name, value) for name, value in values_of.items())
    joint = Joint(free=(True, True, True, False, False, False), sequence="3-1-3")
    inertia = ((i, 0.0, 0.0), (0.0, i, 0.0), (0.0, 0.0, j))
    form = derive(kg.System("top", (Body("top", 0, m, inertia, (0, 0, h), joint),), (0, 0, g))).closed_form()
    across, along, mass, height, gravity, nutation = sympy.symbols("i j m h g theta_1_2", real=True)
    s, c = sympy.sin(nutation), sympy.cos(nutation)
    about_point = across + mass * height**2
    expected = [[about_point * s**2 + along * c**2, 0, along * c], [0, about_point, 0], [along * c, 0, along]]
    difference = (form.A - sympy.Matrix(expected)).applyfunc(sympy.trigsimp)
    assert difference.applyfunc(sympy.expand) == sympy.zeros(3, 3)
    still = form.f.subs(dict.fromkeys(sympy.symbols("thetadot_1_1:4", real=True), 0))
    assert still.T.tolist() == [[0, -gravity * height * mass * s, 0]]
