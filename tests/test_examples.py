"""The examples do what their first lines promise, and stay short."""

from __future__ import annotations

import importlib
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from tests.support.paths import ROOT

PROGRAMS = sorted((ROOT / "examples").glob("*.py"))
"""Every example in Python."""


def example(name: str) -> Any:
    return importlib.import_module(f"examples.{name}")


@pytest.mark.parametrize("file", PROGRAMS, ids=lambda file: file.stem)
def test_an_example_has_at_most_a_hundred_lines_and_its_picture_and_place_on_the_page(file: Path) -> None:
    assert len(file.read_text(encoding="utf-8").splitlines()) <= 100
    page = (ROOT / "docs" / "examples.md").read_text(encoding="utf-8")
    assert f"](../examples/{file.name})" in page and f"](examples/{file.stem}.svg)" in page
    picture = ROOT / "docs" / "examples" / f"{file.stem}.svg"
    assert picture.stat().st_size < 100_000


def test_pictures_of_the_pole_that_swings_up_have_the_same_words() -> None:
    for name in ("mppi_cart_pole", "mpc_cart_pole"):
        picture = (ROOT / "docs" / "examples" / f"{name}.svg").read_text(encoding="utf-8")
        words = set(re.findall("<!-- ([a-z].*?) -->", picture))
        assert words == {"cosine of pole's angle", "cart, m", "force, N", "time, s"}


def test_lqr_catches_the_pole_from_angles_up_to_a_limit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    example("lqr_cart_pole").main(tmp_path / "picture.svg")
    assert "<svg" in (tmp_path / "picture.svg").read_text()
    assert capsys.readouterr().out.splitlines()[1:] == [
        f"from {angle} rad: {end} after 4 s"
        for angle, end in ((0.3, "upright"), (0.6, "upright"), (0.75, "upright"), (0.9, "fallen"))
    ]


def test_the_gain_of_lqr_makes_the_linear_model_stable() -> None:
    lqr = example("lqr_cart_pole")
    system = kg.load(lqr.MODEL)
    linear = kg.linearize(system, {"pole": 0.0}, inputs=["cart_position"])
    assert np.linalg.eigvals(linear.A).real.max() > 0
    assert np.linalg.eigvals(linear.A - linear.B @ lqr.gain(system)).real.max() < -0.5


def test_mppi_swings_the_pole_up(monkeypatch: pytest.MonkeyPatch) -> None:
    mppi = example("mppi_cart_pole")
    monkeypatch.setattr(mppi, "SAMPLES", 256)
    monkeypatch.setattr(mppi, "CYCLES", 175)
    states, forces = mppi.motion()
    assert np.cos(states[0, 0]) == -1.0
    assert (np.cos(states[-25:, 0]) > 0.9).all()  # for the last half second
    assert np.abs(states[:, 1]).max() < 2.5 and np.abs(forces).max() <= mppi.LARGEST_FORCE


def test_mpc_swings_the_pole_up_on_a_short_rail() -> None:
    mpc = example("mpc_cart_pole")
    states, forces = mpc.motion(cycles=65)
    assert states[0, 0] == np.pi
    assert (np.cos(states[-5:, 0]) > 0.99).all()
    # Plans keep the limits to the tolerance of Ipopt; the heavier pole pushes the cart a little further.
    assert np.abs(states[:, 1]).max() < 1.01 * mpc.RAIL
    assert np.abs(forces).max() < mpc.LARGEST_FORCE + 1e-6


def test_the_kalman_filter_finds_the_angle_that_is_not_measured(tmp_path: Path) -> None:
    ekf = example("ekf_double_pendulum")
    assert len(ekf.FILTER.read_text().splitlines()) <= 100
    states = ekf.truth(system := kg.load(ekf.MODEL))
    found = ekf.estimates(ekf.run_here(tmp_path, ekf.write_sources(system, states, tmp_path)))
    errors = found[200:, :4] - states[200:]
    assert abs(found[0, 1] - states[0, 1]) == pytest.approx(0.4)
    assert np.sqrt(np.mean(errors**2, axis=0)) == pytest.approx([0.004, 0.026, 0.028, 0.098], rel=0.1)
    # The error is within the deviations that the filter states, as often as of a normal distribution or more.
    assert np.mean(np.abs(errors[:, 1]) < 3 * np.sqrt(found[200:, 4])) > 0.99


@pytest.mark.slow
def test_computed_torque_follows_a_motion_more_closely_than_springs() -> None:
    errors = example("computed_torque_panda").motions()
    before = {name: np.abs(values[:2500]).max() for name, values in errors.items()}
    springs, exact, loaded = before.values()
    assert exact < 1e-3 < loaded < 0.05 < springs < 0.2  # rad
    pushed = np.abs(errors["computed torque"][2500:]).max(axis=1)
    assert pushed.max() > 0.01 and pushed[-300:].max() < 1e-3  # and it has come back
