"""Poses of the bodies: against Eqs. (3) and (22), computed by hand, and as rotations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.model.coordinates import FREEDOMS
from kanegen.program.evaluate import evaluate
from tests.support import moving_bodies, systems
from tests.support.moving_bodies import Values


def poses(system: kg.System, x: Values) -> Values:
    """Return the poses of all bodies, (N, 4, 3)."""
    (program,) = compile_module(system, ("body_poses",)).module.functions.values()
    found = evaluate(program, {"x": x}, np)["body_poses"]
    return np.array(found).reshape(system.number_of_bodies, 4, 3)


JOINTS = {
    "anything": None,
    "hinges": systems.flags(6, ["theta3"]),
    "slides": systems.flags(6, ["s2"]),
    "cylinders": systems.flags(6, ["theta2", "s1"]),
    "gimbals": systems.flags(6, FREEDOMS[:3]),
    "everything": systems.flags(6, FREEDOMS),
}


@pytest.mark.parametrize("orientations", [True, False])
@pytest.mark.parametrize("locked", [True, False])
@pytest.mark.parametrize("joints", JOINTS)
def test_against_the_notes(joints: str, locked: bool, orientations: bool) -> None:
    """The origin is O_K of the notes, wherever the derivation of [A] has its own."""
    rng = np.random.default_rng(len(joints))
    system = systems.random_system(rng, 6, free=JOINTS[joints], locked=locked, orientations=orientations)
    x = 2 * rng.normal(size=len(system.freedoms))
    found = poses(system, x)
    expected = moving_bodies.expected(system.values(), x, 0 * x)["body_poses"]
    assert found == pytest.approx(expected, abs=4e-15 * (1 + np.abs(x).sum()))
    rotations = found[:, :3]
    assert rotations @ rotations.swapaxes(1, 2) == pytest.approx(np.tile(np.eye(3), (6, 1, 1)), abs=4e-15)
    assert np.linalg.det(rotations) == pytest.approx(np.ones(6))


def test_welded_bodies_have_poses_too() -> None:
    rng = np.random.default_rng(5)
    free = systems.flags(4, [])
    free[1, 0] = True
    system = systems.random_system(rng, 4, connection=(0, 1, 2, 1), free=free)
    x = np.array([0.4])
    expected = moving_bodies.expected(system.values(), x, x)["body_poses"]
    assert poses(system, x) == pytest.approx(expected, abs=1e-14)


def test_an_arm_by_hand() -> None:
    """Two hinges about axis 3 a metre apart, turned by 30 and then by 60 degrees, and a slide at the end."""
    free = np.zeros((3, 6), bool)
    free[0, 2] = free[1, 2] = free[2, 3] = True
    system = kg.System.from_arrays(
        (0, 1, 2),
        [1.0] * 3,
        [np.eye(3)] * 3,
        mass_center=np.full((3, 3), 7.0),
        joint_position=[(0, 0, 2), (1, 0, 0), (1, 0, 0)],
        free=free,
    )
    c, s = np.cos(np.pi / 6), 0.5
    first = [(c, s, 0), (-s, c, 0), (0, 0, 1), (0, 0, 2)]
    turned = [(0, 1, 0), (-1, 0, 0), (0, 0, 1)]
    elbow = np.array([c, s, 2])
    expected = [first, [*turned, elbow], [*turned, np.add(elbow, (0, 1.25, 0))]]
    assert poses(system, [np.pi / 6, np.pi / 3, 0.25]) == pytest.approx(np.array(expected), abs=1e-15)


def test_compiled_code() -> None:
    """Results have the shapes of one state, of a batch and of an empty batch, and follow the parameters."""
    system = kg.load("models/gantry_crane.toml")
    library = kg.build(system, "body_poses")
    bodies = system.number_of_bodies
    x = np.random.default_rng(2).normal(size=(11, library.n))
    every = library.body_poses(x)
    assert every.shape == (11, bodies, 4, 3)
    assert library.body_poses(x[:0]).shape == (0, bodies, 4, 3)
    name = next(iter(library.parameters))
    for row in range(11):
        one = library.body_poses(x[row])
        assert one.shape == (bodies, 4, 3)
        assert one == pytest.approx(every[row], abs=1e-14)
        assert one == pytest.approx(
            moving_bodies.expected(system.values(), x[row], x[row])["body_poses"], abs=1e-13
        )
    assert library.with_parameters({name: 1.0}).evaluate(x).body_poses.shape == every.shape
    changed = {parameter.name: 1.5 * parameter.value for parameter in system.parameters}
    expected = moving_bodies.expected(system.with_parameters(changed).values(), x, x)["body_poses"]
    assert library.with_parameters(changed).body_poses(x) == pytest.approx(expected, abs=1e-13)


def operations(system: kg.System) -> tuple[int, int]:
    counts = compile_module(system, ("body_poses",)).operations
    return counts["multiply"], counts["add"]


def test_operations_by_hand() -> None:
    """A hinge turns three vectors, 4 + 2 each; three angles turn two, the third is their vector product."""
    plain = systems.random_system(
        np.random.default_rng(1),
        3,
        connection=(0, 1, 2),
        free=np.array([systems.FREEDOMS[i] in ("theta1", "theta2", "theta3") for i in range(6)])[None].repeat(
            3, axis=0
        ),
        orientations=False,
        locked=False,
    )
    arm, root = (9, 9), (14, 4)
    joint = (2 * 3 * 4 + 6, 2 * 3 * 2 + 3)
    assert operations(plain) == tuple(r + 2 * a + 2 * j for r, a, j in zip(root, arm, joint, strict=True))
    hinge = replace(
        plain.bodies[2], joint=replace(plain.bodies[2].joint, free=systems.flags(1, ["theta3"])[0])
    )
    last = (3 * 4, 3 * 2)
    fewer = replace(plain, bodies=(*plain.bodies[:2], hinge))
    assert operations(fewer) == tuple(
        r + 2 * a + j + t for r, a, j, t in zip(root, arm, joint, last, strict=True)
    )


def test_selected_bodies_are_rows_of_all_and_cost_less() -> None:
    rng = np.random.default_rng(9)
    system = systems.random_system(rng, 6, connection=(0, 1, 2, 1, 4, 4), free=JOINTS["gimbals"])
    some = system.with_poses([5, "body1"])
    assert some.pose_names == ("body5", "body1")
    assert [frame.body for frame in some.pose_frames] == [5, 1]
    library, every = kg.build(some, "body_poses"), kg.build(system, "body_poses")
    assert library.pose_names == ("body5", "body1")
    x = rng.normal(size=(5, len(system.freedoms)))
    found = library.body_poses(x)
    assert found.shape == (5, 2, 4, 3)
    assert found == pytest.approx(every.body_poses(x)[:, [4, 0]], abs=1e-15)
    assert library.body_poses(x[2]).tolist() == found[2].tolist()
    assert sum(operations(system.with_poses([1]))) < sum(operations(some)) < sum(operations(system))
    header = library.source.files["tree.h"]
    assert "0  body5\n *     1  body1\n" in header
    assert "for each chosen body" in header
    assert "double body_poses[2 * 4 * 3]" in header


def test_a_selection_changes_no_other_output() -> None:
    system = kg.load("models/gantry_crane.toml")
    some = system.with_poses([system.bodies[-1].name])
    assert kg.generate(some).files == kg.generate(system).files
    assert some.with_poses(None) == system


@pytest.mark.parametrize(
    ("bodies", "message"),
    [
        (["trolly"], r"frames: there is no body or frame 'trolly'\. Did you mean 'trolley'\?"),
        ([0], r"there is no body or frame 0\."),
        ([9], r"there is no body or frame 9\."),
        ([True], r"there is no body or frame True\."),
        ([["trolley"]], r"there is no body or frame \['trolley'\]"),
        (2.5, r"there is no body or frame 2\.5"),
        ([], r"frames: none is chosen\. Name one"),
        (["trolley", 1, "trolley"], r"frames: '\w+' is named twice\. Name it once"),
    ],
)
def test_invalid_selections_are_refused(bodies: object, message: str) -> None:
    system = kg.load("models/gantry_crane.toml")
    with pytest.raises(kg.ModelError, match=message):
        system.with_poses(bodies)  # type: ignore[arg-type]
