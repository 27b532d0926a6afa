"""Operational inertia, its inverse and its bias, against dense matrices; statuses of singular poses."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.errors import KanegenWarning, OptionError, SingularError
from kanegen.lowering.conditioning import LARGEST_ACCEPTED_ERROR
from kanegen.lowering.losses import array_inputs
from kanegen.lowering.lower import lower
from kanegen.model.arrays import Floats
from kanegen.program.constants import MULTIPRECISION
from kanegen.program.evaluate import evaluate
from kanegen.recursion import derive, methods
from kanegen.recursion.rotors import articulated_bodies_take
from kanegen.reference.equations import mass_matrix
from kanegen.reference.frames import frame_motions
from kanegen.reference.operational import OperationalInertia, frame_without_six, operational_inertia
from kanegen.reference.states import States, random_states
from tests.support import prescribed_trees, random_trees, systems
from tests.support.cases import slow_except
from tests.support.chains import bushes
from tests.support.robots import robot_file
from tests.support.rod_on_light_links import ROUNDOFF, X, rod_on_light_links

INVERSE, INERTIA, BIAS = "operational_inertia_inverse", "operational_inertia", "operational_bias"


def computed(system: kg.System, output: str, solver: str, states: States, tau: Floats) -> Floats:
    """Return the (B, k, ...) values of the program that becomes C."""
    (way,) = methods(system, (output,), solver)
    program = lower(derive(system, way), (output,))
    given = array_inputs(system, program, states)
    if "tau" in given:
        given["tau"] = list(tau.T)
    (rows,) = evaluate(program, given, np, np.float64).values()
    found = np.stack([np.broadcast_to(row, len(states)) for row in rows], axis=-1)
    shape = (len(system.pose_names), 6) if output == BIAS else (len(system.pose_names), 6, 6)
    return found.reshape(len(states), *shape)


def expected(system: kg.System, states: States, tau: Floats) -> OperationalInertia:
    loads: dict[str, Any] = {"force": states.force, "torque": states.torque, **states.inputs}
    loads = {name: value for name, value in loads.items() if value is not None and name != "prescribed"}
    return operational_inertia(system, system.pose_names, states.x, states.y, tau, states.prescribed, **loads)


def scaled(matrix: Floats, size: Floats) -> Floats:
    return matrix / size[..., :, None] / size[..., None, :]


def root(matrix: Floats) -> Floats:
    return np.sqrt(np.diagonal(matrix, axis1=-2, axis2=-1))


def condition(system: kg.System, states: States) -> Floats:
    """Return by state the condition number of [A] with a diagonal of ones."""
    a = np.asarray(mass_matrix(system, states.x, states.prescribed))
    return np.linalg.cond(scaled(a, root(a)))


def check(system: kg.System, solver: str, seed: int) -> None:
    """Compare all three outputs with the reference.

    The entries of a matrix are known to as many digits as the condition numbers leave: of [A], and for
    [Lambda] that of its inverse, both with a diagonal of ones.
    """
    states = random_states(system, 4, seed)
    tau = np.random.default_rng(seed).normal(size=states.y.shape)
    right, lost = expected(system, states, tau), 1e-14 * condition(system, states)[:, None]
    found = computed(system, INVERSE, solver, states, tau)
    size = root(right.inverse)
    assert (np.abs(scaled(found - right.inverse, size)).max(axis=(-1, -2)) <= lost).all()
    assert (found == found.swapaxes(-1, -2)).all()
    lost = lost * np.linalg.cond(scaled(right.inverse, size))
    found = computed(system, INERTIA, solver, states, tau)
    size = root(right.inertia)
    assert (np.abs(scaled(found - right.inertia, size)).max(axis=(-1, -2)) <= lost).all()
    assert (found == found.swapaxes(-1, -2)).all()
    found = computed(system, BIAS, solver, states, tau)
    largest = np.abs(right.bias / size).max(axis=-1)
    assert (np.abs((found - right.bias) / size).max(axis=-1) <= 10 * lost * largest).all()


def movable(system: kg.System) -> list[str]:
    """Return the frames that accelerate in six directions."""
    return [name for name in system.frame_names if frame_without_six(system.with_poses([name])) is None]


def solvers(system: kg.System) -> list[str]:
    return ["articulated bodies"] * articulated_bodies_take(system) + ["factorisation"]


@pytest.mark.parametrize("seed", slow_except(range(24), *range(2)))
def test_trees_with_everything(seed: int) -> None:
    system = random_trees.everything(seed, 3)
    if names := movable(system):
        for solver in solvers(system):
            check(system.with_poses(names), solver, seed)


def test_half_of_these_trees_have_frames_that_move_in_six_directions() -> None:
    assert sum(bool(movable(random_trees.everything(seed, 3))) for seed in range(8)) >= 4


@pytest.mark.parametrize("seed", slow_except(range(6), 1))
def test_trees_that_articulated_bodies_take(seed: int) -> None:
    """Three angles, angular velocities, and free translations, solved for in the components of the body."""
    rng = np.random.default_rng(seed)
    system = systems.random_system(rng, 4, loads=True).with_speeds(
        ("angle_rates", "angular_velocity")[seed % 2]
    )
    if names := movable(system):
        for solver in solvers(system):
            check(system.with_poses(names), solver, seed)


def test_floating_bodies() -> None:
    system = bushes(3)
    for solver in solvers(system):
        check(system, solver, 1)


def test_the_inverse_exists_for_every_frame() -> None:
    """Also on the ground, where it is zero, and where a frame moves in fewer than six directions."""
    system = random_trees.everything(4, 3)
    system = system.with_poses(system.frame_names)
    states = random_states(system, 4)
    found = computed(system, INVERSE, "factorisation", states, states.y)
    j = np.asarray(
        frame_motions(
            system, system.pose_names, states.x, states.y, 0 * states.y, states.prescribed
        ).jacobians
    )
    a = np.asarray(mass_matrix(system, states.x, states.prescribed))
    right = j @ np.linalg.solve(a[:, None], j.swapaxes(-1, -2))
    lost = 1e-14 * condition(system, states).max()
    assert np.abs(found - right).max() <= lost * np.abs(right).max()
    assert (found[:, system.frame_names.index("on_ground")] == 0).all()


@pytest.fixture(scope="module")
def arm() -> kg.System:
    return kg.load(robot_file("ur5_robot")).with_poses(["tool0"])


@pytest.fixture(scope="module")
def library(arm: kg.System) -> kg.Library:
    return kg.build(
        arm, (INVERSE, INERTIA, BIAS, "frame_accelerations", "frame_jacobians", "forward_dynamics")
    )


def test_a_wrench_accelerates_the_frame(library: kg.Library) -> None:
    """The definition: [Lambda] {a} + {bias} = {w} with the acceleration {a} under the wrench {w}."""
    rng = np.random.default_rng(3)
    x, y, tau, w = rng.uniform(0.3, 1.2, (8, 6)), *rng.normal(size=(3, 8, 6))
    jacobian = library.frame_jacobians(x)[:, 0]
    ydot = library.forward_dynamics(x, y, tau + np.einsum("bij,bi->bj", jacobian, w))
    a = library.frame_accelerations(x, y, ydot)[:, 0]
    inertia, bias = library.operational_inertia(x)[:, 0], library.operational_bias(x, y, tau)[:, 0]
    left = np.einsum("bij,bj->bi", inertia, a) + bias
    assert left == pytest.approx(w, abs=1e-9 * np.abs(bias).max())
    for state in (0, 7):
        assert library.operational_inertia(x[state])[0] == pytest.approx(inertia[state], rel=1e-12)
        assert library.operational_bias(x[state], y[state], tau[state])[0] == pytest.approx(
            bias[state], rel=1e-9
        )
    together = library.evaluate(x, y, tau=tau, ydot=ydot)
    assert together.operational_bias == pytest.approx(bias[:, None], rel=1e-9)


@pytest.mark.slow
def test_batches_of_trees_with_parameters() -> None:
    """Compiled code, with other values of the parameters, in a batch and in single precision."""
    system = next(tree for tree in map(random_trees.everything, range(9), [3] * 9) if movable(tree))
    system = system.with_poses(movable(system)[-2:])
    changed = random_trees.other_parameters(system, 1)
    model = system.with_parameters(changed)
    states = random_states(model, 9)
    tau = np.random.default_rng(1).normal(size=states.y.shape)
    right, k = expected(model, states, tau), len(system.pose_names)
    lost = condition(model, states)[:, None] * np.linalg.cond(scaled(right.inverse, root(right.inverse)))
    given = {"force": states.force, "torque": states.torque, **states.inputs}
    given = {name: value for name, value in given.items() if value is not None}
    state = {name: value for name, value in given.items() if name in ("prescribed", "t")}
    for tier, roundoff in (("strict", 1e-14), ("single", 1e-6)):
        library = kg.build(system, (INVERSE, INERTIA, BIAS), tier=tier, on_status="ignore")
        library = library.with_parameters(changed)
        found = library.operational_inertia(states.x, **state)
        assert found.shape == (9, k, 6, 6)
        good = roundoff * lost < 0.1  # others have a status in single precision
        error = np.abs(scaled(found - right.inertia, root(right.inertia))).max(axis=(-1, -2))
        assert (error[good] <= (roundoff * lost)[good]).all()
        bias = library.operational_bias(states.x, states.y, tau, **given)
        size = root(right.inertia)
        error, largest = (np.abs(v / size).max(axis=-1) for v in (bias - right.bias, right.bias))
        assert good.any()
        assert (error[good] <= (10 * roundoff * lost * largest)[good]).all()
        mobility = library.operational_inertia_inverse(states.x, **state)
        error = np.abs(scaled(mobility - right.inverse, root(right.inverse))).max(axis=(-1, -2))
        assert (error <= roundoff * condition(model, states)[:, None]).all()


@pytest.mark.parametrize("kind", slow_except(prescribed_trees.KINDS, *prescribed_trees.KINDS[::4]))
def test_prescribed_motion(kind: str) -> None:
    trees = (prescribed_trees.tree(kind, seed) for seed in range(8))
    system, names = next((tree, names) for tree in trees if (names := movable(tree)))
    for solver in solvers(system):
        check(system.with_poses(names[:2]), solver, 2)


@pytest.mark.parametrize("name", slow_except(("ur5", "rod on light links"), "rod on light links"))
def test_no_large_error_is_silent(name: str, arm: kg.System) -> None:
    """Near singular poses, and where [A] itself is ill-conditioned: reported, or accurate to 1e-12."""
    rng = np.random.default_rng(4)
    if name == "ur5":
        system, x = arm, rng.uniform(-2, 2, (60, 6))
        x[:, 4] = 10.0 ** rng.uniform(-6, 0, 60)
    else:
        system = rod_on_light_links()
        system, x = system.with_poses([system.bodies[-1].name]), np.array(X) + 0.3 * rng.normal(size=(60, 6))
    library = kg.build(system, (INERTIA,), on_status="ignore")
    found, reported = library.operational_inertia(x)[:, 0], np.zeros(len(x), dtype=bool)
    for i, one in enumerate(x):
        library.with_on_status(lambda report, i=i: reported.__setitem__(i, True)).operational_inertia(one)
    exact = in_wide_precision(system, INERTIA, x)
    errors = np.abs(scaled(found - exact, root(exact))).max(axis=(-1, -2)) / ROUNDOFF
    assert reported.sum() > 0
    assert (errors[~reported] <= LARGEST_ACCEPTED_ERROR).all()
    if name == "ur5":
        assert np.nanmax(errors[reported]) > LARGEST_ACCEPTED_ERROR
        assert not reported[x[:, 4] > 0.1].all()


def in_wide_precision(system: kg.System, output: str, x: Floats) -> Floats:
    """Return the (B, 6, 6) values for one frame by the articulated bodies in 320 bits."""
    (way,) = methods(system, (output,), "articulated bodies")
    program, number = lower(derive(system, way), (output,)), MULTIPRECISION.mpf
    rows = []
    for one in x:
        elements = {array.name: [number(0)] * array.size for array in program.inputs}
        elements["x"] = [number(float(value)) for value in one]
        (entries,) = evaluate(program, elements, MULTIPRECISION, number).values()
        rows.append([float(value) for value in entries])
    return np.array(rows).reshape(-1, 6, 6)


def test_a_stretched_arm_has_a_status(library: kg.Library) -> None:
    """With the wrist's axes in line the tool cannot turn about one direction; the message names the row."""
    pose = [0.3, -1.0, 1.2, 0.4, 0.0, 0.2]
    with pytest.raises(
        SingularError, match=r"operational_inertia: the pivot of J \[A\]\^-1 J\^T at row 'moment\d' on frame"
    ):
        library.operational_inertia(pose)
    assert np.isfinite(library.operational_inertia_inverse(pose)).all()
    near = [*pose[:4], 1e-5, 0.2]
    with pytest.warns(KanegenWarning, match=r"not accurate in this state. Most digits are lost at row '"):
        library.operational_inertia(near)
    with pytest.warns(KanegenWarning, match=r"operational_bias: .* row '\w+' on frame \"?'?tool0"):
        library.operational_bias([near, [0.3, -1.0, 1.2, 0.4, 1.0, 0.2]], np.ones((2, 6)))


def test_frames_that_move_in_few_directions_are_refused(arm: kg.System) -> None:
    short = arm.with_poses(["tool0", "wrist_1_link"])
    with pytest.raises(
        OptionError, match=r"operational inertia for frame 'wrist_1_link', which accelerates in 4 of six "
    ):
        kg.generate(short, (INERTIA,))
    with pytest.raises(OptionError, match="ask for operational_inertia_inverse"):
        kg.generate(short.with_poses(["world"]) if "world" in arm.frame_names else short, (BIAS,))
    assert kg.generate(short, (INVERSE,)).operations["add"] > 0


def test_six_parallel_hinges_are_refused() -> None:
    """They have six freedoms, and three directions."""
    bodies = 6
    system = kg.System.from_arrays(
        connection=range(bodies),
        mass=[1.0] * bodies,
        inertia=[np.eye(3)] * bodies,
        mass_center=[[0.5, 0.1, 0.2]] * bodies,
        joint_position=[[1.0, 0.3, 0.2]] * bodies,
        free=np.array([[0, 0, 1, 0, 0, 0]] * bodies, dtype=bool),
    )
    with pytest.raises(OptionError, match="accelerates in 3 of six directions"):
        kg.generate(system.with_poses([system.bodies[-1].name]), (INERTIA,))


@pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")
@pytest.mark.parametrize(
    ("robot", "frame", "limit"),
    [
        ("ur5_robot", "tool0", 1055),
        ("panda", "panda_hand", 1570),
        pytest.param("talos_reduced", "gripper_left_fingertip_3_link", 6425, marks=pytest.mark.slow),
    ],
)
def test_operations_with_those_of_the_mass_matrix(robot: str, frame: str, limit: int) -> None:
    system = kg.load(robot_file(robot), floating_base=robot.startswith("talos")).with_poses([frame])
    assert sum(compile_module(system, (INERTIA,)).operations.values()) <= limit
