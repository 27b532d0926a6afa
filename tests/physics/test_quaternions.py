"""Quaternions in place of three angles, compared with truth, the reference and the equations in angles."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import kanegen as kg
from kanegen.library.results import Diagnosis
from kanegen.measure import truth as certified
from kanegen.reference import equations as reference
from kanegen.reference.kinematics import kinematics
from kanegen.reference.states import random_states
from kanegen.simulation import simulate
from kanegen.studies.tradeoff.domain import default_domain
from kanegen.studies.tradeoff.evaluator import convert_sample
from kanegen.symbolic import derive
from kanegen.symbolic.printing import render
from tests.support import systems
from tests.support.cases import slow_except
from tests.support.orientation_trees import (
    ANGULAR_VELOCITY,
    ARRAYS,
    close,
    mixed,
    quaternion_state,
    remade,
    values,
    with_quaternions,
)
from tests.support.paths import MODELS

OUTPUTS = (*ARRAYS, "kinetic_energy", "potential_energy", "momentum", "mass_center", "body_poses")


@pytest.mark.parametrize("seed", slow_except(range(6), 0, 1))
def test_truth_and_reference(seed: int) -> None:
    """The recursion agrees with two algorithms in ball arithmetic and the notes' equations in NumPy."""
    system = with_quaternions(seed)
    assert len(system.coordinates) > len(system.freedoms)
    given = quaternion_state(system, seed)
    exact = certified.truth(system, **given, outputs=tuple(ARRAYS))
    found = values(system, given, *ARRAYS)
    for output, array in ARRAYS.items():
        close(found[array], exact[output].value)
    loads = {"force": given["force"], "torque": given["torque"]}
    close(reference.mass_matrix(system, given["x"]), exact["mass_matrix"].value)
    close(reference.forcing(system, given["x"], given["y"], **loads), exact["forcing"].value)


@pytest.mark.parametrize("seed", slow_except(range(6), 0, 1))
def test_angles_of_the_same_orientation(seed: int) -> None:
    """Every output equals that with angles, for the same orientations and angular velocities."""
    turned = with_quaternions(seed)
    angles = mixed(seed).with_speeds(ANGULAR_VELOCITY).with_coordinates("angles")
    rates = [b.joint.speeds for b in turned.bodies]
    angles = kg.System.from_arrays(**(angles.values().rows() | {"speeds": rates}))
    given = quaternion_state(angles, seed)
    x = np.empty(len(turned.coordinates))
    for coordinate, place in turned.coordinate_places.items():
        if coordinate.index < 6:
            x[place] = given["x"][angles.coordinate_places[coordinate]]
        elif coordinate.name == "e0":
            own = [angles.coordinate_place(coordinate.body, index) for index in range(3)]
            # Body-fixed angles 1-2-3 are SciPy's intrinsic XYZ.
            quaternion = Rotation.from_euler("XYZ", given["x"][own]).as_quat()
            x[place : place + 4] = 1.7 * np.roll(quaternion, 1)
    theirs, ours = values(angles, given, *OUTPUTS), values(turned, given | {"x": x}, *OUTPUTS)
    for output, value in theirs.items():
        close(ours[output], value)


@pytest.mark.parametrize("seed", slow_except(range(3), 0, 1))
def test_the_literal_equations(seed: int) -> None:
    system = with_quaternions(seed)
    given = quaternion_state(system, seed)
    equations = derive(system).lambdify()
    close(equations.mass_matrix(given["x"]), reference.mass_matrix(system, given["x"]))
    found = equations.forcing(given["x"], given["y"], given["force"], given["torque"])
    loads = {"force": given["force"], "torque": given["torque"]}
    close(found, reference.forcing(system, given["x"], given["y"], **loads))


@pytest.mark.parametrize("seed", range(4))
def test_rates_turn_the_bodies_and_keep_the_length(seed: int) -> None:
    """d[^J R_K]/dt = -[omega_hat~][^J R_K], Eq. (7), by a complex step along {xdot}."""
    system = with_quaternions(seed)
    given = quaternion_state(system, seed)
    xdot = values(system, given, "coordinate_rates")["xdot"]
    arrays, still = system.values(), np.zeros(len(system.freedoms))
    moved = kinematics(arrays, given["x"] + 1e-30j * xdot, still.astype(complex))
    bodies = kinematics(arrays, given["x"], given["y"])
    for body, along in zip(bodies, moved, strict=True):
        w = body.relative_omega
        skew = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
        close(along.relative_rotation.imag / 1e-30, -skew @ body.relative_rotation)
    for coordinate, place in system.coordinate_places.items():
        if coordinate.name == "e0":
            assert abs(given["x"][place : place + 4] @ xdot[place : place + 4]) < 1e-14


@pytest.mark.parametrize("precision", ["double", "float"])
def test_the_length_means_nothing(precision: str) -> None:
    """A quaternion scaled by a power of two changes no bit of [A] and {f}; length 0 gives NaN and warns."""
    system = kg.load(MODELS / "free_body.toml").with_coordinates("quaternion")
    library = kg.build(system, ("mass_matrix", "forcing", "forward_dynamics"), precision=precision)
    states = random_states(system, 20)
    scaled = states.x.copy()
    scaled[:, :4] *= 2.0**9
    assert (library.mass_matrix(states.x) == library.mass_matrix(scaled)).all()
    assert (library.forcing(states.x, states.y) == library.forcing(scaled, states.y)).all()
    with pytest.warns(kg.KanegenWarning, match=r"^forcing: f\[\d\] is nan, at freedom"):
        assert np.isnan(library.forcing(np.zeros(7), states.y[0])).any()


@pytest.mark.parametrize("precision", ["double", "float", "long double", "double-double"])
def test_compiled_code(precision: str) -> None:
    """C for one state and for a batch agrees with the reference."""
    system = with_quaternions(1)
    report = kg.compare(system, states=200, precision=precision)
    assert report.passed, str(report)
    if precision in {"double", "float"}:
        library = kg.build(system, ("mass_matrix", "coordinate_rates"), precision=precision)
        states = random_states(system, 9)
        x, y = (array.astype(library.mass_matrix(states.x).dtype) for array in (states.x, states.y))
        for k in range(9):
            assert (library.mass_matrix(x)[k] == library.mass_matrix(x[k])).all()
            assert (library.coordinate_rates(x, y)[k] == library.coordinate_rates(x[k], y[k])).all()


@pytest.mark.parametrize("precision", slow_except(("double", "float"), "float"))
@pytest.mark.filterwarnings("ignore::kanegen.KanegenWarning")
def test_every_length_is_accurate_or_nan(precision: str) -> None:
    """Lengths over the whole range of the numbers, closely where squares leave it."""
    system = systems.chain(2, ["theta1", "theta2", "theta3", "s1"]).with_coordinates("quaternion")
    library = kg.build(
        system, ("mass_matrix", "forcing"), precision=precision, flags=("-O0", "-ffp-contract=off")
    )
    limits = np.finfo({"double": np.float64, "float": np.float32}[precision])
    ends = [0.5 * limits.minexp, -0.5 * limits.minexp]
    powers = np.concatenate(
        [np.arange(limits.minexp, limits.maxexp - 1, 7.0), *(np.arange(e - 16, e + 4, 0.23) for e in ends)]
    )
    state = random_states(system, 1, 3)
    places = [
        i
        for i, one in enumerate(system.coordinates)
        if one.body == 1 and one.name in ("e0", "e1", "e2", "e3")
    ]
    assert len(places) == 4
    x = np.repeat(state.x, len(powers), axis=0)
    x[:, places] *= (np.exp2(powers) / np.linalg.norm(state.x[0, places]))[:, None]
    x = x.astype(limits.dtype).astype(float)
    y = np.repeat(state.y, len(powers), axis=0)
    for name, found, exact in (
        ("[A]", library.mass_matrix(x), [reference.mass_matrix(system, _unit(row, places)) for row in x]),
        ("{f}", library.forcing(x, y), [reference.forcing(system, _unit(row, places), y[0]) for row in x]),
    ):
        rows = found.reshape(len(x), -1).astype(float)
        known = np.isfinite(rows).all(axis=1)
        error = np.abs(rows - np.reshape(exact, rows.shape)).max(axis=1) / np.abs(exact).max()
        assert (error[known] <= 100 * limits.eps).all(), name
        assert np.isnan(rows[~known]).any(axis=1).all(), name
        middle = (powers > ends[0] + 8) & (powers < ends[1] - 8)
        assert known[middle].all(), name
        assert not known[powers > ends[1] + 2].any(), name


def _unit(x: np.ndarray, places: list[int]) -> np.ndarray:
    """Return coordinates with a unit quaternion, scaled without squares that leave the range."""
    result = x.copy()
    result[places] /= np.abs(result[places]).max()
    result[places] /= np.linalg.norm(result[places])
    return result


@pytest.mark.slow
def test_eight_bodies_in_every_orientation() -> None:
    """Nothing is lost where cos(theta2) = 0, since [A] and {xdot} hold no angles."""
    system = systems.eight_body().with_coordinates("quaternion")
    outputs = ("forward_dynamics", "coordinate_rates", "error_estimate", "regularity")
    library = kg.build(system, outputs)
    given = quaternion_state(system, 3)
    locked = np.roll(Rotation.from_euler("XYZ", [0.3, np.pi / 2, -0.8]).as_quat(), 1)
    for place in (place for c, place in system.coordinate_places.items() if c.name == "e0"):
        given["x"][place : place + 4] = locked
    exact = certified.truth(system, **given, outputs=("forward_dynamics",))["forward_dynamics"].value
    loads = (given["tau"], given["force"], given["torque"])
    found = library.forward_dynamics(given["x"], given["y"], *loads)
    assert np.linalg.norm(found - exact) <= 1e-13 * np.linalg.norm(exact)
    assert np.isfinite(library.coordinate_rates(given["x"], given["y"])).all()
    diagnosis = library.diagnose(given["x"], given["y"], *loads)
    assert isinstance(diagnosis, Diagnosis)
    assert diagnosis.singularity is None
    assert diagnosis.singular == 0


def test_a_long_flight() -> None:
    """A free body tumbles through all orientations with constant energy, momentum and quaternion length."""
    body = kg.load(MODELS / "free_body.toml").with_coordinates("quaternion")
    outputs = ("forward_dynamics", "coordinate_rates", "kinetic_energy", "potential_energy", "momentum")
    library = kg.build(body, outputs)
    x, y = np.array([1.0, 0, 0, 0, 0, 0, 0]), np.array([0.3, 5.0, 0.1, 0.2, -0.1, 0.4])
    path = simulate(library, x, y, np.linspace(0.0, 20.0, 41), "DOP853", tolerance=1e-12)
    assert path.x.shape == (41, 7)
    assert path.energy_drift.largest < 1e-9
    assert path.momentum_drift()[1].largest < 1e-9
    assert np.abs(np.linalg.norm(path.x[:, :4], axis=1) - 1).max() < 1e-9
    steps = simulate(library, np.tile(x, (3, 1)), np.tile(y, (3, 1)), [0.0, 0.1], "RK4", step=1e-3)
    assert steps.x.shape == (2, 3, 7)


def test_names_and_places() -> None:
    system = kg.load(MODELS / "free_body.toml").with_coordinates("quaternion")
    name = system.bodies[0].name
    assert system.coordinate_names[:4] == tuple(f"{name}.e{i}" for i in range(4))
    assert system.freedom_names[:3] == tuple(f"{name}.omega{i}" for i in (1, 2, 3))
    assert [c.unit for c in system.coordinates] == ["1"] * 4 + ["m"] * 3
    source = kg.generate(system, ("mass_matrix",))
    header = source.files["free_body.h"]
    assert "FREE_BODY_COORDINATES = 7" in header
    assert "FREE_BODY_FREEDOMS    = 6" in header
    assert f"{name}.e0  1" in header
    assert "sin" not in source.files["free_body.c"].split("*/")[-1]


def test_a_file_and_arrays_keep_them(tmp_path: Path) -> None:
    system = with_quaternions(2)
    system.save(tmp_path / "tree.toml")
    assert kg.load(tmp_path / "tree.toml") == system
    assert "quaternion" in system.values().coordinates


def test_there_and_back() -> None:
    system = mixed(1).with_speeds(ANGULAR_VELOCITY)
    turned = system.with_coordinates("quaternion")
    assert turned.with_coordinates("angles") == system
    assert turned.with_speeds("angle_rates") == turned
    other = kg.generate(mixed(1), ("mass_matrix",), coordinates="quaternion")
    assert other.files == kg.generate(turned, ("mass_matrix",)).files


@pytest.mark.parametrize("format_", ["text", "latex", "python"])
def test_equations_are_printed(format_: str, tmp_path: Path) -> None:
    system = with_quaternions(1)
    text = render(derive(system), format_)
    assert "epsilon" in text
    if format_ == "python":
        (tmp_path / "tree.py").write_text(text)
        given = quaternion_state(system, 5)
        numbers = f"x = np.array({given['x'].tolist()}); y = np.array({given['y'].tolist()})"
        show = "print(*tree.mass_matrix(x).ravel(), *tree.coordinate_rates(x, y))"
        call = [sys.executable, "-c", f"import numpy as np, tree; {numbers}; {show}"]
        done = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True, check=True)
        found = np.array([float(word) for word in done.stdout.split()])
        n = len(system.freedoms)
        close(found[: n * n], reference.mass_matrix(system, given["x"]))
        close(found[n * n :], values(system, given, "coordinate_rates")["xdot"])


def test_no_closed_form() -> None:
    system = kg.load(MODELS / "free_body.toml").with_coordinates("quaternion")
    with pytest.raises(kg.OptionError, match="quaternion; closed forms"):
        derive(system).closed_form()


def test_states_of_a_study_are_the_same_physically() -> None:
    system = mixed(3)
    turned = system.with_coordinates("quaternion")
    sample = default_domain(system).sample(20, 1)
    other = convert_sample(sample, system, turned)
    poses = kg.build(system, ("body_poses", "kinetic_energy")).evaluate(sample.x, sample.y)
    same = kg.build(turned, ("body_poses", "kinetic_energy")).evaluate(other.x, other.y)
    close(same.body_poses, poses.body_poses, 1e-5)
    close(same.kinetic_energy, poses.kinetic_energy, 1e-5)


def test_another_joint_is_reanchored() -> None:
    """Places in {x} and {y} differ behind a quaternion."""
    rng = np.random.default_rng(4)
    tree = systems.random_system(rng, 3, free=np.ones((3, 6), dtype=bool), loads=False)
    system = remade(tree, "coordinates", ["quaternion", "angles", "angles"])
    given = quaternion_state(system, 7)
    after = kg.reanchored(system, given["x"], given["y"], ["body2", "body3"])
    outputs = ("body_poses", "kinetic_energy", "momentum")
    before = values(system, given, *outputs)
    for name, value in values(after.system, {"x": after.x, "y": after.y}, *outputs).items():
        close(value, before[name])
    assert (after.x[:4] == given["x"][:4]).all()
    with pytest.raises(kg.OptionError, match="has a quaternion, which is regular everywhere"):
        kg.reanchored(system, given["x"], given["y"], "body1")


@pytest.mark.parametrize(
    ("joint", "message"),
    [
        ({"coordinates": "quaternoin"}, "Did you mean 'quaternion'"),
        (
            {"coordinates": "quaternion", "free": (True, True, False, True, True, True)},
            "needs three free angles",
        ),
        ({"coordinates": "quaternion", "sequence": "3-1-3"}, "turns about no sequence"),
    ],
)
def test_what_makes_no_sense_is_refused(joint: dict[str, object], message: str) -> None:
    with pytest.raises(kg.ModelError, match=message):
        kg.Joint(**joint)


def test_arguments_of_the_wrong_length() -> None:
    system = kg.load(MODELS / "free_body.toml")
    with pytest.raises(kg.OptionError, match="leave none"):
        kg.generate(system, speeds="angle_rates", coordinates="quaternion")
    with pytest.raises(kg.OptionError, match="unknown coordinates 'euler'"):
        kg.generate(system, coordinates="euler")
    library = kg.build(system, coordinates="quaternion")
    assert library.coordinate_names == system.with_coordinates("quaternion").coordinate_names
    with pytest.raises(kg.ArrayError, match=r"x: expected shape \(7,\)"):
        library.mass_matrix(np.zeros(6))
    with pytest.raises(kg.ArrayError, match=r"y: expected shape \(6,\)"):
        library.forcing(np.ones(7), np.ones(7))
