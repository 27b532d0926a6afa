"""The URDF file for peers with a gravity of their own: turned, in another unit, and converted back."""

from __future__ import annotations

import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import kanegen as kg
from kanegen.errors import MissingError
from kanegen.reference import equations as reference
from kanegen.reference.states import ActuatedStates, states_away_from_gimbal_lock
from kanegen.studies.bench.peers.urdf_tree import UrdfTree, roll_pitch_yaw, urdf_tree
from kanegen.studies.bench.results import DYNAMICS, EQUATIONS, Results
from tests.support import systems

Floats = NDArray[np.float64]
MAGNITUDE = 9.80665
"""The gravity of the program that reads the file, m/s^2."""


def tree(seed: int) -> kg.System:
    """Return a random tree with turns and slides, with gravity in a random direction."""
    rng = np.random.default_rng(seed)
    free = systems.random_free(rng, 5)
    free[:, seed % 6] = True
    system = systems.random_system(rng, 5, free=free, loads=False)
    return replace(system, gravity=tuple(rng.uniform(-9, 9, 3)))


def computed(system: kg.System, states: ActuatedStates) -> Results:
    """Compute [A], {f} and {ydot} by the reference."""
    arrays = system.values()
    matrices = np.array([reference.mass_matrix(arrays, x) for x in states.x])
    rows = zip(states.x, states.y, strict=True)
    vectors = np.array([reference.forcing(arrays, x, y) for x, y in rows])
    accelerations = np.linalg.solve(matrices, (vectors + states.tau)[:, :, None])[:, None, :, 0]
    return {EQUATIONS: np.concatenate([matrices, vectors[:, None]], axis=1), DYNAMICS: accelerations}


def read_back(file: UrdfTree, folder: Path) -> tuple[kg.System, list[int]]:
    """Read a file as a program with its own gravity does; return the index in {x} of each coordinate."""
    path = folder / "tree.urdf"
    path.write_text(file.text, encoding="utf-8")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", kg.KanegenWarning)
        found = replace(kg.load(path), gravity=(0.0, 0.0, -MAGNITUDE))
    return found, [int(name) for name in found.freedom_names]


@pytest.mark.parametrize("seed", range(4))
def test_a_reader_of_the_file_computes_the_same(seed: int, tmp_path: Path) -> None:
    system = tree(seed)
    states = states_away_from_gimbal_lock(system, 3)
    file = urdf_tree(system, MAGNITUDE)
    theirs, order = read_back(file, tmp_path)
    scaled = file.states(states)
    ordered = ActuatedStates(scaled.x[:, order], scaled.y[:, order], tau=scaled.tau[:, order])
    back = np.argsort(order)
    raw = computed(theirs, ordered)
    matrix, vector = raw[EQUATIONS][:, :-1], raw[EQUATIONS][:, -1:]
    equations = np.concatenate([matrix[:, back][:, :, back], vector[:, :, back]], axis=1)
    found = file.results({EQUATIONS: equations, DYNAMICS: raw[DYNAMICS][:, :, back]})
    for task, expected in computed(system, states).items():
        np.testing.assert_allclose(found[task], expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


def turn(axis: int, angle: float) -> Floats:
    """Return the (3, 3) rotation about a basis vector."""
    c, s = np.cos(angle), np.sin(angle)
    matrix = np.eye(3)
    a, b = (axis + 1) % 3, (axis + 2) % 3
    matrix[a, a] = matrix[b, b] = c
    matrix[b, a], matrix[a, b] = s, -s
    return matrix


@pytest.mark.parametrize("pitch", [0.3, np.pi / 2, -np.pi / 2, np.pi / 2 - 1e-9, 2.5])
def test_angles_are_accurate_at_a_right_angle(pitch: float) -> None:
    rotation = turn(2, 0.7) @ turn(1, pitch) @ turn(0, -1.1)
    roll, pitch_, yaw = roll_pitch_yaw(rotation)
    np.testing.assert_allclose(turn(2, yaw) @ turn(1, pitch_) @ turn(0, roll), rotation, atol=1e-15)


def test_what_the_format_lacks_is_named() -> None:
    chain = systems.chain(2)
    with pytest.raises(MissingError, match="cannot switch gravity off"):
        urdf_tree(replace(chain, gravity=(0.0, 0.0, 0.0)), MAGNITUDE)
    first = chain.bodies[0]
    armature = replace(first.joint, armature=(0.1,) * 6)
    motor = replace(chain, bodies=(replace(first, joint=armature), *chain.bodies[1:]))
    with pytest.raises(MissingError, match="no inertia of motors"):
        urdf_tree(motor, MAGNITUDE)
