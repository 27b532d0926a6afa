"""`kanegen bound`: bounds as text and as JSON, reasons where there are none, errors of a bad domain."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.support.command import kanegen
from tests.support.paths import MODELS, PENDULUM

BOX = "x.angles = [-1.0, 1.0]; y.angles = [-2.0, 2.0]"


def test_text_and_json_have_the_same_bounds(tmp_path: Path) -> None:
    path = tmp_path / "box.toml"
    path.write_text(BOX.replace(";", "\n"))
    text = kanegen("bound", PENDULUM, "--domain", str(path), "--precision", "float").stdout
    plain = json.loads(kanegen("bound", PENDULUM, "--domain", BOX, "--precision", "float", "--json").stdout)
    assert "proven bounds of |computed - exact|" in text
    largest = max(map(max, plain["outputs"]["mass_matrix"]["bounds"]))
    assert f"{largest:.3g}" in text
    assert 1e-8 < largest < 1e-6  # a few roundoffs of single precision, entries being near 2 kg m^2


def test_an_assumed_sine_is_said() -> None:
    assert (
        "Assumed: sine and cosine of the C library" in kanegen("bound", PENDULUM, "--sincos", "libm").stdout
    )


def test_an_output_without_bound_has_a_reason_and_exit_status_1() -> None:
    arguments = (
        str(MODELS / "free_body.toml"),
        "--speeds",
        "angular_velocity",
        "--output",
        "coordinate_rates",
    )
    found = kanegen("bound", *arguments, status=1)
    assert "may be 0 in the box" in found.stdout


def test_a_bound_itself_needs_none() -> None:
    found = kanegen("bound", PENDULUM, "--output", "error_bound", "--output", "forcing", status=0)
    assert "it is a bound itself" in found.stdout


@pytest.mark.parametrize(
    "domain", ["x.elbow = [0, 1]", "x.angles = [1, 0]", "x.angles = [0, 1", "missing.toml"]
)
def test_a_bad_domain_is_one_line(domain: str) -> None:
    found = kanegen("bound", PENDULUM, "--domain", domain, status=2)
    assert found.stderr.startswith("error:") and found.stderr.count("\n") == 1
