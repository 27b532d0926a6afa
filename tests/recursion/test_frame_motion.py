"""Outputs about frames: Jacobians, velocities and accelerations, against the equations of the notes."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.program.count import count
from kanegen.recursion.outputs import MOTIONS_OF_FRAMES
from kanegen.reference.frames import FrameMotions, frame_motions
from tests.support import random_trees, systems
from tests.support.cases import slow_except
from tests.support.orientation_trees import ANGULAR_VELOCITY, KINDS, close, mixed, tree_of_kind, values
from tests.support.paths import MODELS
from tests.support.robots import robot_file

ALL = ("body_poses", "frame_velocities", "frame_accelerations", "frame_bias_accelerations", "frame_jacobians")


def framed(system: kg.System, seed: int) -> kg.System:
    """Return the system with two frames on every body but the last and one on the ground, all chosen."""
    rng = np.random.default_rng(seed)
    frames: dict[str, Any] = {"table": ("ground", rng.normal(size=3), rng.normal(size=3))}
    for body in system.bodies[:-1]:
        frames[f"{body.name}-a"] = (body.name, rng.normal(size=3), rng.normal(size=3))
        frames[f"{body.name}-b"] = (f"{body.name}-a", rng.normal(size=3), rng.normal(size=3))
    system = system.with_frames(frames)
    return system.with_poses(system.frame_names)


def state(system: kg.System, seed: int) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(seed)
    found = {name: rng.normal(size=len(system.freedoms)) for name in ("y", "ydot")}
    return found | {"x": rng.uniform(-1, 1, len(system.coordinates))}


def expected(system: kg.System, given: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the outputs by the reference."""
    found = frame_motions(system, system.pose_names, given["x"], given["y"], given["ydot"])
    return by_output(found)


def by_output(found: FrameMotions) -> dict[str, np.ndarray]:
    parts = (found.poses, found.velocities, found.accelerations, found.bias, found.jacobians)
    return dict(zip(ALL, parts, strict=True))


def test_the_outputs_about_frames() -> None:
    assert MOTIONS_OF_FRAMES == ALL


@pytest.mark.parametrize("kind", slow_except(KINDS, "quaternions"))
def test_the_equations_of_the_notes(kind: str) -> None:
    for seed in range(3):
        system = framed(tree_of_kind(kind, seed), seed)
        given = state(system, seed)
        right = expected(system, given)
        together = values(system, given, *ALL)
        for name in ALL:
            close(values(system, given, name)[name].reshape(right[name].shape), right[name])
            close(together[name].reshape(right[name].shape), right[name])


@pytest.mark.parametrize("seed", slow_except(range(6), 0))
def test_trees_with_everything(seed: int) -> None:
    """Frames in frames, frames of bodies for their users, and parameters in positions and angles."""
    system = random_trees.everything(seed, 3)
    system = system.with_poses(system.frame_names)
    given = state(system, seed)
    right = expected(system, given)
    library = kg.build(system, ALL)
    changed = random_trees.other_parameters(system, seed)
    for model, built in (
        (system, library),
        (system.with_parameters(changed), library.with_parameters(changed)),
    ):
        right = expected(model, given)
        x, y, ydot = given["x"], given["y"], given["ydot"]
        close(built.body_poses(x), right["body_poses"])
        close(built.frame_velocities(x, y), right["frame_velocities"])
        close(built.frame_accelerations(x, y, ydot), right["frame_accelerations"])
        close(built.frame_bias_accelerations(x, y), right["frame_bias_accelerations"])
        close(built.frame_jacobians(x), right["frame_jacobians"])


def test_compiled_code_in_batches() -> None:
    system = framed(mixed(2).with_speeds(ANGULAR_VELOCITY), 2)
    library = kg.build(system, ALL)
    given = {name: np.stack([one, -one]) for name, one in state(system, 4).items()}
    right = expected(system, given)
    x, y, ydot = given["x"], given["y"], given["ydot"]
    k = len(system.frame_names)
    assert library.pose_names == system.frame_names
    assert library.frame_jacobians(x).shape == (2, k, 6, library.n)
    assert library.frame_jacobians(x[:0]).shape == (0, k, 6, library.n)
    close(library.frame_jacobians(x), right["frame_jacobians"])
    close(library.frame_accelerations(x, y, ydot), right["frame_accelerations"])
    jacobians = library.frame_jacobians(x)
    close(np.einsum("bkin,bn->bki", jacobians, y), library.frame_velocities(x, y))
    bias = library.frame_bias_accelerations(x, y)
    close(np.einsum("bkin,bn->bki", jacobians, ydot) + bias, library.frame_accelerations(x, y, ydot))
    still = library.frame_accelerations(x, y, 0 * ydot)
    close(still, bias)


def test_single_precision() -> None:
    system = framed(mixed(3), 3)
    library = kg.build(system, ALL, tier="single")
    given = state(system, 3)
    found = library.frame_jacobians(given["x"])
    assert found.dtype == np.float32
    assert found == pytest.approx(expected(system, given)["frame_jacobians"], abs=1e-4)


def test_all_bodies_are_chosen_by_default() -> None:
    system = mixed(1)
    given = state(system, 1)
    found = values(system, given, "frame_velocities")["frame_velocities"]
    close(found.reshape(-1, 6), expected(system, given)["frame_velocities"])
    header = kg.generate(system, ("frame_velocities",)).files[f"{system.name}.h"]
    assert f"double frame_velocities[{system.number_of_bodies} * 6]" in header
    assert "for each body its angular velocity" in header


def test_a_header_lists_chosen_frames() -> None:
    system = kg.load(MODELS / "double_pendulum.toml").with_frames(
        {"tool": ("lower", (0.7, 0, 0)), "table": ("ground", (0, 0, 1))}
    )
    source = kg.generate(system.with_poses(["tool", "table", "upper"]), ("frame_jacobians",))
    header = source.files["double_pendulum.h"]
    assert "0  tool  on lower\n *     1  table  on the ground\n *     2  upper\n" in header
    assert "\n- `tool` on `lower`\n- `table` on the ground\n- `upper`\n" in source.files["README.md"]
    assert re.search(r"DOUBLE_PENDULUM_POSES += 3,", header)
    assert "double frame_jacobians[3 * 6 * 2]" in header


def cost(system: kg.System, *outputs: str) -> int:
    (program,) = compile_module(system, outputs).module.functions.values()
    counts = count(program)
    return counts["add"] + counts["multiply"]


@pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")
@pytest.mark.parametrize(
    ("robot", "frame", "jacobian", "bias"),
    [
        ("ur5_robot", "tool0", 154, 256),
        ("panda", "panda_hand", 169, 266),
        ("talos_reduced", "gripper_left_fingertip_3_link", 396, 496),
    ],
)
def test_the_frame_of_a_leaf_of_a_robot(robot: str, frame: str, jacobian: int, bias: int) -> None:
    system = kg.load(robot_file(robot), floating_base=robot.startswith("talos")).with_poses([frame])
    assert cost(system, "frame_jacobians") <= jacobian
    assert cost(system, "frame_bias_accelerations") <= bias


def test_a_frame_costs_what_its_branch_costs() -> None:
    """The bias costs less than accelerations; two frames of a body share its angular velocity."""
    system = systems.eight_body(loads=False)
    frames = {"a": ("body3", (0.1, 0.2, 0.3)), "b": ("body3", (0.3, -0.1, 0.2))}
    system = system.with_frames(frames)
    one, two = system.with_poses(["a"]), system.with_poses(["a", "b"])
    assert cost(one, "frame_bias_accelerations") < cost(one, "frame_accelerations")
    arm, turns = 9 + 3, 3 * 3 * 6
    assert cost(two, "frame_velocities") - cost(one, "frame_velocities") <= arm + turns
    assert cost(one, "frame_velocities") < cost(system, "frame_velocities")


def test_turning_a_frame_costs_nothing_but_its_pose() -> None:
    system = systems.eight_body(loads=False)
    plain = system.with_frames({"a": ("body3", (0.1, 0.2, 0.3))}).with_poses(["a"])
    turned = system.with_frames({"a": ("body3", (0.1, 0.2, 0.3), (0.1, 0.2, 0.3))}).with_poses(["a"])
    for name in ALL[1:]:
        assert cost(plain, name) == cost(turned, name)
    assert cost(turned, "body_poses") == cost(plain, "body_poses") + 3 * 3 * 5


def test_prescribed_freedoms_move_frames() -> None:
    """Their rates are part of velocities, their second derivatives of accelerations and of the bias."""
    system = framed(systems.random_system(np.random.default_rng(4), 4), 4)
    system = system.with_prescribed([system.freedom_names[0], system.freedom_names[-1]])
    rng, n = np.random.default_rng(5), len(system.freedoms)
    x, y, ydot = rng.uniform(-1, 1, (3, n))
    motion = rng.uniform(-1, 1, (3, 2))
    library = kg.build(system, ALL)
    right = by_output(frame_motions(system, system.pose_names, x, y, ydot, motion))
    close(library.frame_velocities(x, y, prescribed=motion), right["frame_velocities"])
    close(library.frame_accelerations(x, y, ydot, prescribed=motion), right["frame_accelerations"])
    close(library.frame_bias_accelerations(x, y, prescribed=motion), right["frame_bias_accelerations"])
    close(library.frame_jacobians(x, prescribed=motion), right["frame_jacobians"])
    carried = library.frame_velocities(x, 0 * y, prescribed=motion)
    close(library.frame_jacobians(x, prescribed=motion) @ y + carried, right["frame_velocities"])
