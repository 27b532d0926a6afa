"""The script of pages puts every frame where the reference in NumPy does, in random trees of every kind."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.c.templates import raw
from kanegen.reference.frames import frame_motions
from kanegen.viewer.making import scene_of
from tests.support.cases import slow_except
from tests.support.prescribed_trees import KINDS, tree
from tests.support.random_trees import everything

SCRIPT = "([scene, x, prescribed]) => Array.from(kanegenViewer.poses(scene, x, prescribed))"

TOLERANCE = 1e-12
"""Of rounding errors in some hundred operations with lengths of a few metres."""


@pytest.fixture(scope="module")
def page(browser: Any) -> Iterator[Any]:
    found = browser.new_page()
    found.add_script_tag(content=raw("viewer/viewer.js"))
    yield found
    found.close()


def frames_by_script(page: Any, system: kg.System, x: Any, prescribed: Any) -> np.ndarray:
    """Return (k, 4, 3) poses of all frames as the reference gives them, from the poses of the script."""
    scene = scene_of(system)
    flat = page.evaluate(SCRIPT, [scene.as_table(), list(x), list(prescribed)])
    poses = np.array(flat).reshape(-1, 12)
    found = []
    for frame in scene.frames:
        rotation, origin = poses[frame.body][:9].reshape(3, 3), poses[frame.body][9:]
        inside = np.array(frame.rotation).reshape(3, 3)
        found.append([*(rotation @ inside).T, origin + rotation @ frame.position])
    return np.array(found)


def compare(page: Any, system: kg.System, seed: int) -> None:
    rng = np.random.default_rng(seed)
    x = rng.uniform(-2.0, 2.0, len(system.coordinates))
    motion = rng.uniform(-2.0, 2.0, (3, len(system.prescribed)))
    still = np.zeros(len(system.freedoms))
    expected = frame_motions(system, system.frame_names, x, still, still, motion).poses
    assert frames_by_script(page, system, x, motion[0]) == pytest.approx(expected, abs=TOLERANCE)


@pytest.mark.parametrize("seed", slow_except(range(12), *range(4)))
def test_random_trees(page: Any, seed: int) -> None:
    """Successive seeds have every kind of rotation and orientation; odd ones have couplings."""
    compare(page, everything(seed), seed)


@pytest.mark.parametrize("kind", KINDS)
def test_prescribed_freedoms(page: Any, kind: str) -> None:
    compare(page, tree(kind, 1), 5)


def test_a_quaternion_of_zeros_turns_nothing(page: Any) -> None:
    """As sliders may give one, the picture must not lose the body."""
    joint = kg.Joint(coordinates="quaternion")
    system = kg.System("ball", (kg.Body("ball", 0, 1.0, np.eye(3).tolist(), joint=joint),))
    (pose,) = frames_by_script(page, system, [0, 0, 0, 0, 1, 2, 3], [])
    assert pose.tolist() == [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 2, 3]]
