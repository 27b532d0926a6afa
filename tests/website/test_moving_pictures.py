"""Moving pictures: shapes stand where their bodies are, and pictures are the same whenever they are made."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest
from website import gallery
from website.moving_picture import HEIGHT, WIDTH, Camera, moving_svg

import kanegen as kg
from kanegen.viewer.making import scene_of
from tests.support.paths import ROOT

SCENES = {scene.model: scene for scene in gallery.SCENES}


def pendulum(angles: np.ndarray) -> str:
    """Return the picture of a point mass on a rod of 1 m below the origin, at angles from the vertical."""
    body = kg.Body(
        "bob",
        0,
        1.0,
        np.zeros((3, 3)),
        (1.0, 0, 0),
        joint=kg.Joint(free=(False, False, True, False, False, False)),
    )
    system = kg.System("pendulum", (body,), gravity=(9.81, 0, 0))
    c, s, zero = np.cos(angles), np.sin(angles), np.zeros_like(angles)
    rotations = np.stack([[c, s, zero], [-s, c, zero], [zero, zero, zero + 1]]).transpose(2, 0, 1)[:, None]
    camera = Camera.of((-1, 0, 0), (0, 0, -1), 0.0)
    return moving_svg(scene_of(system), 2.0, rotations, np.zeros((len(angles), 1, 3)), camera)


def test_a_bob_moves_on_its_circle() -> None:
    angles = np.linspace(-1.0, 1.0, 81)
    text = pendulum(angles)
    ElementTree.fromstring(text)
    rod = re.findall(r"%\{transform:matrix\(([^)]*)\)\}", text)
    lines = np.array([[float(value) for value in one.split(",")] for one in rod])
    along = lines[lines[:, 0] != 0][:, :2]
    lengths = np.linalg.norm(along, axis=1)
    assert np.allclose(lengths, lengths.max(), atol=1.5)
    turned = np.unwrap(np.arctan2(along[:, 0], along[:, 1]))
    assert np.ptp(turned) == pytest.approx(2.0, abs=0.02)


def test_a_picture_is_as_large_as_it_may_be() -> None:
    camera = Camera.of((0, 0, 1), (0, 1, 0), 0.3)
    assert np.allclose(camera.right, (1, 0, 0))
    assert np.allclose(camera.up @ camera.up, 1) and camera.up[2] > 0.9
    assert f'viewBox="0 0 {WIDTH} {HEIGHT}"' in pendulum(np.linspace(0, 1, 5))


def test_what_does_not_move_has_no_keyframes() -> None:
    assert "@keyframes s" not in pendulum(np.zeros(5))


def test_the_gallery_has_every_model_and_its_page() -> None:
    models = {path.stem for path in (ROOT / "models").glob("*.toml")}
    assert set(SCENES) == models
    assert (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8") == gallery.page()
    assert {path.stem for path in (ROOT / "docs" / "gallery").glob("*.svg")} == models


@pytest.mark.parametrize(
    "model", ["cart_pole", *(pytest.param(name, marks=pytest.mark.slow) for name in SCENES)]
)
def test_a_picture_is_made_again(model: str) -> None:
    made = gallery.picture(SCENES[model])
    assert made == (ROOT / "docs" / "gallery" / f"{model}.svg").read_text(encoding="utf-8")
