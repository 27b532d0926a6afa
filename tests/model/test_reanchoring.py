"""Re-anchored joints: the same position, the same motion, other angles."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from flint import ctx

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.errors import ArrayError, OptionError
from kanegen.measure.truth.balls import column
from kanegen.measure.truth.tree import constant_orientation, rotations_by_angles
from kanegen.model.body import Body
from kanegen.model.coordinates import FREEDOMS, SEQUENCES
from kanegen.model.joint import Joint
from kanegen.program.evaluate import evaluate
from kanegen.reference import equations as reference
from kanegen.reference.kinematics import kinematics
from tests.support.reanchoring import near_gimbal_lock, with_orientation_parameters

U = 2.0**-53
ANGLES = FREEDOMS[:3]


def rotation(system: kg.System, x: Any, k: int) -> Any:
    """Return [^J R_K] in balls of 200 bits."""
    joint = system.bodies[k].joint
    angles = [x[system.places[freedom]] for freedom in system.freedoms if freedom.body == k + 1][:3]
    ctx.prec = 200
    return rotations_by_angles(column(angles), joint.axes)[-1] * constant_orientation(joint.orientation)


@pytest.mark.parametrize("distance", [0.3, 1e-6, 1e-12])
@pytest.mark.parametrize("sequence", SEQUENCES)
def test_bodies_keep_their_position(sequence: str, distance: float) -> None:
    """[^J R_K] stays the same to 4 u, with matrices and with parameters, and the new angles are regular."""
    for seed in range(3):
        system, x, y = near_gimbal_lock(sequence, seed, distance)
        for case in (system, with_orientation_parameters(system)):
            new, angles, _ = kg.reanchored(case, x, y, margin=0.5)
            for k in range(3):
                moved = rotation(case, x, k) - rotation(new, angles, k)
                assert max(abs(float(entry.mid())) for entry in moved.entries()) <= 4 * U
            middle = [angles[new.places[freedom]] for freedom in new.freedoms if freedom.index == 1]
            assert middle == [np.pi / 2 if sequence[0] == sequence[-1] else 0.0] * 3


@pytest.mark.parametrize("sequence", ["1-2-3", "3-1-3", "2-1-3", "2-3-2"])
@pytest.mark.parametrize("distance", [1e-1, 1e-12])
def test_motion_stays_as_it_is(sequence: str, distance: float) -> None:
    """Positions, velocities and energy of the reference stay the same to a few u of their terms."""
    for seed in range(5):
        system, x, y = near_gimbal_lock(sequence, seed, distance)
        new, angles, speeds = kg.reanchored(system, x, y, margin=0.5)
        before, after = kinematics(system.values(), x, y), kinematics(new.values(), angles, speeds)
        for name in ("position", "rotation", "omega", "center_velocity"):
            old, found = (np.array([getattr(body, name) for body in bodies]) for bodies in (before, after))
            assert np.abs(found - old).max() <= 40 * U * np.abs(old).max(), name
        energies = [
            speed @ reference.mass_matrix(case.values(), at) @ speed / 2
            for case, at, speed in ((system, x, y), (new, angles, speeds))
        ]
        assert abs(energies[1] - energies[0]) <= 24 * U * energies[0]  # 8 u, and 8 for each evaluation


def run(system: kg.System, output: str, **values: Any) -> Any:
    (program,) = compile_module(system, (output,)).module.functions.values()
    (found,) = evaluate(program, values, np).values()
    return np.array(found)


@pytest.mark.parametrize("distance", [1e-1, 1e-12])
def test_accelerations_stay_as_they_are(distance: float) -> None:
    """Accelerations from regular angle rates agree with those from angular velocities before re-anchoring."""
    system, x, y = near_gimbal_lock("1-2-3", 7, distance, 2)
    spinning = system.with_speeds("angular_velocity")
    new, angles, speeds = kg.reanchored(spinning, x, y, margin=0.5)
    still, zero = np.array_equal(speeds[:6], y[:6]), np.zeros(12)
    assert still  # components of the angular velocity are those of the body
    before = run(spinning, "forward_dynamics", x=x, y=y, tau=zero)
    after = run(new, "forward_dynamics", x=angles, y=speeds, tau=zero)
    assert np.abs(after - before)[:6].max() <= 80 * U * np.abs(before[:6]).max()
    rates = new.with_speeds("angle_rates")
    # At the angles 0 the rates of 1-2-3 are the components, and theirs differ by products of rates.
    one, two, three = speeds[:6].reshape(2, 3).T
    products = np.stack([two * three, -one * three, one * two], axis=1).ravel()
    found = run(rates, "forward_dynamics", x=angles, y=speeds, tau=zero)
    assert np.abs(found[:6] + products - before[:6]).max() <= 80 * U * np.abs(before).max()
    assert np.abs(found - after)[6:].max() <= 80 * U * np.abs(after).max()


def test_a_library_remains_usable() -> None:
    """A compiled library remains usable with the new parameters."""
    system, x, y = near_gimbal_lock("3-2-1", 3, 1e-9)
    system = with_orientation_parameters(system)
    library = kg.build(system, ("mass_matrix", "kinetic_energy"))
    anchored = kg.reanchored(system, x, y)
    moved = library.with_parameters(anchored.parameters)
    old, new = library.kinetic_energy(x, y), moved.kinetic_energy(anchored.x, anchored.y)
    assert abs(new - old) <= 24 * U * old
    expected = reference.mass_matrix(anchored.system.values(), anchored.x)
    assert moved.mass_matrix(anchored.x) == pytest.approx(expected, rel=1e-12, abs=1e-13 * expected.max())


def test_a_passage_through_the_singularity() -> None:
    """A ball that spins uniformly through gimbal lock is simulated by Runge-Kutta steps of fixed length."""
    joint = Joint(free=(True, True, True, False, False, False), orientation=np.eye(3))
    system = with_orientation_parameters(
        kg.System("ball", (Body("ball", 0, 1.0, np.eye(3), joint=joint),), (0, 0, 0))
    )
    system = system.with_parameters(dict.fromkeys(("c0_0", "c0_1", "c0_2"), 0.0))
    library, step = kg.build(system, ("forward_dynamics",)), 2.0**-11
    x, y, anchored = np.zeros(3), np.array([0.0, 1.5, 0.0]), 0
    spin = np.array([0.3, 1.4, -0.2])  # in the body and in space, as its inertia is the same about all axes
    y[:] = spin

    def rates(state: Any) -> Any:
        return np.concatenate([state[3:], library.forward_dynamics(state[:3], state[3:])])

    for _ in range(4096):
        state = np.concatenate([x, y])
        one = rates(state)
        two = rates(state + step / 2 * one)
        three = rates(state + step / 2 * two)
        x, y = np.split(state + step / 6 * (one + 2 * two + 2 * three + rates(state + step * three)), 2)
        if abs(np.cos(x[1])) < 0.5:
            system, x, y = kg.reanchored(system, x, y, margin=0.5)
            library, anchored = (
                library.with_parameters({p.name: p.value for p in system.parameters}),
                anchored + 1,
            )
    assert anchored >= 2
    angle = 2 * np.linalg.norm(spin)
    a, b, c = spin / np.linalg.norm(spin)
    cross = np.array([[0, -c, b], [c, 0, -a], [-b, a, 0]])
    expected = (np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross).T
    (body,) = kinematics(system.values(), x, y)
    assert np.abs(body.rotation - expected).max() <= 1e-12
    assert body.omega == pytest.approx(spin, abs=1e-12)


def test_only_what_is_near() -> None:
    system, x, y = near_gimbal_lock("1-2-3", 2, 0.05)
    x[system.freedom_names.index("body2.theta2")] = 0.4
    new, *_ = kg.reanchored(system, x, y)
    same = [a.joint == b.joint for a, b in zip(system.bodies, new.bodies, strict=True)]
    assert same == [False, True, False]
    for chosen in (["body2"], [2], "body2", 2, [2, "body2"]):
        new, angles, _ = kg.reanchored(system, x, y, chosen)
        assert [a.joint == b.joint for a, b in zip(system.bodies, new.bodies, strict=True)] == [
            True,
            False,
            True,
        ]
        assert not angles[3:6].any()
    assert kg.reanchored(system, x, y, margin=0.0).system == system


def test_locked_translations_keep_the_body_in_its_place() -> None:
    joint = Joint((1, 2, 3), free=(True, True, True, False, False, False), locked=(0, 0, 0, 0.1, -0.2, 0.3))
    system = kg.System("one", (Body("one", 0, 1.0, np.eye(3), joint=joint),))
    x, y = np.array([0.3, 1.5, -0.7]), np.ones(3)
    new, angles, speeds = kg.reanchored(system, x, y)
    (before,), (after,) = kinematics(system.values(), x, y), kinematics(new.values(), angles, speeds)
    assert after.position == pytest.approx(before.position, rel=1e-15)


def joint(only: tuple[str, ...] = ANGLES, **changes: Any) -> kg.System:
    free = tuple(name in only for name in FREEDOMS)
    return kg.System("one", (Body("one", 0, 1.0, np.eye(3), joint=Joint(free=free, **changes)),))


A, B = kg.Parameter("a", 0.1), kg.Parameter("b", 0.2)


@pytest.mark.parametrize(
    ("system", "message"),
    [
        (joint(only=("theta1", "theta2")), "three angles are not all free"),
        (joint(only=(*ANGLES, "s2")), "slides along some axes of its joint frame only"),
        (joint(locked=(0, 0, 0, A, 0, 0)), "parameters meet a locked translation"),
        (
            joint(orientation=[A, B, kg.Parameter("d", 1)], locked=(0, 0, 0, 1, 0, 0)),
            "parameters meet a locked",
        ),
        (joint(orientation=[A, 0.1, 0.2]), "shares parameters, or has fewer than three"),
        (joint(orientation=[A, B, A]), "shares parameters, or has fewer than three"),
        (joint(orientation=[A, B, kg.Parameter("d", 1)], position=[B, 0, 0]), "shares parameters"),
    ],
)
def test_frames_that_cannot_turn(system: kg.System, message: str) -> None:
    n = len(system.freedoms)
    with pytest.raises(OptionError, match=rf"body 'one' cannot be re-anchored: .*{message}"):
        kg.reanchored(system, np.zeros(n), np.zeros(n), ["one"])


def test_arguments() -> None:
    system, x, y = near_gimbal_lock("1-2-3", 1, 0.1)
    with pytest.raises(ArrayError, match=r"x: expected 18 finite numbers, got shape \(17,\)"):
        kg.reanchored(system, x[1:], y)
    with pytest.raises(ArrayError, match="y: expected 18 finite numbers"):
        kg.reanchored(system, x, y * np.nan)
    with pytest.raises(OptionError, match=r"there is no body 'bodi2'. Did you mean 'body2'\?"):
        kg.reanchored(system, x, y, ["bodi2"])
    with pytest.raises(OptionError, match="there is no body 4"):
        kg.reanchored(system, x, y, [4])
    with pytest.raises(OptionError, match=r"there is no body None"):
        kg.reanchored(system, x, y, [None])
    with pytest.raises(ArrayError, match=r"x: the rows have different lengths"):
        kg.reanchored(system, [[1.0], [1.0, 2.0]], y)
    with pytest.raises(OptionError, match="margin is 'wide'"):
        kg.reanchored(system, x, y, margin="wide")
    with pytest.raises(OptionError, match="margin is 2; it must lie between 0 and 1"):
        kg.reanchored(system, x, y, margin=2)
