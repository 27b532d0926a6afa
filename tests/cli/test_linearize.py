"""`kanegen linearize`: numbers and symbols in all formats, values by name, and what is refused."""

from __future__ import annotations

import json

import numpy as np
import pytest

import kanegen as kg
from tests.support.command import kanegen
from tests.support.paths import MODELS

FURUTA = str(MODELS / "furuta_pendulum.toml")


def test_numbers() -> None:
    done = kanegen(
        "linearize", FURUTA, "--input", "arm_angle", "--output", "x.arm_angle", "--x", "pendulum=pi"
    )
    assert "about\n  x.pendulum = 3.14159265\n" in done.stdout
    assert "inputs tau.arm_angle: controllable (rank 4 of 4)" in done.stdout
    data = json.loads(kanegen("linearize", FURUTA, "--format", "json", "--x", "pendulum=pi/2").stdout)
    expected = kg.linearize(kg.load(FURUTA), {"pendulum": np.pi / 2})
    assert np.array(data["A"]) == pytest.approx(expected.A)


def test_symbols() -> None:
    done = kanegen("linearize", FURUTA, "--symbolic", "--x", "pendulum=pi")
    assert "about x.pendulum = pi\n" in done.stdout
    assert "A[y.pendulum, x.pendulum] = -9.81*length*mass*(arm_inertia + arm_length**2*mass)/(" in done.stdout
    assert "bmatrix" in kanegen("linearize", FURUTA, "--symbolic", "--format", "latex").stdout
    table = kanegen("linearize", FURUTA, "--format", "markdown").stdout
    assert "| d y.pendulum | 0 | 97.258 | 0 | 0 |" in table
    widths = {line.count("|") for line in table.partition("## B")[0].splitlines() if line.startswith("|")}
    assert widths == {6}  # five columns


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--x", "pol=1"], "x: there is no 'pol'"),
        (["--x", "pendulum"], "--x: 'pendulum' is not NAME=VALUE, such as pole=0.3."),
        (["--tau", "pendulum=1", "--tau", "pendulum=2"], "--tau: 'pendulum' has two values. Give one."),
        (["--y", "pendulum=open('x')"], "there is no function 'open'"),
        (["--x", "pendulum=__import__"], "--x pendulum: expression '__import__': there is no parameter"),
        (
            ["--format", "yaml"],
            "unknown format 'yaml'. Known are 'text', 'markdown', 'latex', 'json', 'python'.",
        ),
        (
            ["--symbolic", "--format", "json"],
            "unknown format 'json'. Known are 'text', 'markdown', 'latex', 'python'.",
        ),
        (["--input", "arm"], "inputs: there is no freedom 'arm'"),
    ],
)
def test_what_is_refused(arguments: list[str], message: str) -> None:
    done = kanegen("linearize", FURUTA, *arguments, status=2)
    assert message in done.stderr
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize("form", [[], ["--symbolic"]])
def test_an_output_of_points_without_points_is_refused(form: list[str]) -> None:
    arguments = ["linearize", str(MODELS / "cart_pole.toml"), "--output", "point_positions", *form]
    error = kanegen(*arguments, status=2).stderr
    assert "'point_positions'" in error
    assert "on the command line --points" in error
    assert "point_positions.tip.x" in kanegen(*arguments, "--points", "tip=rod:0,0.1,0.5").stdout
