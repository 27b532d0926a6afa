"""`kanegen generate` with a budget and `kanegen verify` on the command line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from kanegen.cli.app import app
from kanegen.errors import KanegenError
from tests.support.command import kanegen
from tests.support.paths import MODELS, PENDULUM

CHEAP = (
    *("--quantile", "0.9", "--confidence", "0.9", "--attempts", "1", "--states", "16", "--search", "16"),
    *("--domain", "x.angles = [-1, 1]", "--reproducible", "--precision", "float"),
)


def test_generate_and_verify(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    said = kanegen("generate", PENDULUM, "-o", str(folder), "--error", "1e-2", *CHEAP).stdout
    assert "error at most 0.01 relative to the terms: exceeded in 0 of 22 fresh states" in said
    assert "so in less than 9.9 % of the domain with 90 % confidence" in said
    assert "ns for latency on this machine" in said
    file = folder / "double_pendulum_certificate.json"
    assert json.loads(file.read_text())["variant"]["precision"] == "float"
    held = kanegen("verify", str(file), "--model", PENDULUM).stdout
    assert "holds as far as it was looked at" in held
    assert "candidates: open; not checked" in held
    (folder / "double_pendulum.h").write_text("edited")
    failed = kanegen("verify", str(file), "--states", "1", status=1).stdout
    assert "double_pendulum.h: does not hold" in failed
    assert "DOES NOT HOLD" in failed
    other = kanegen("verify", str(file), "--model", str(MODELS / "cart_pole.toml"), status=2)
    assert "of another model than 'cart_pole'" in other.stderr
    assert other.stderr.count("\n") == 1
    foreign = kanegen("generate", PENDULUM, "-o", str(folder), "--error", "1e-2", *CHEAP, status=2)
    assert "double_pendulum.h, which are not this model's files" in foreign.stderr


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--error", "1e-9", "--budget", "200ns"), "give one of them"),
        (("--error", "0"), "error is 0.0; it must be a positive number"),
        (("--error", "-1e-9"), "error is -1e-09"),
        (("--error", "nan"), "error is nan"),
        (("--error", "tiny"), "error is 'tiny'"),
        (("--budget", "200"), "no unit"),
        (("--budget", "200 parsecs"), "unknown unit 'parsecs'"),
        (("--error", "1e-9", "--tier", "fast"), "--tier: not with --error"),
        (("--budget", "1us", "--output", "forcing"), "--output: not with --budget"),
        (("--error", "1e-9", "--without", "fold"), "--without: not with --error"),
        (("--error", "1e-9", "--sincos", "libm"), "--sincos: not with --error"),
        (("--error", "1e-9", "--reanchoring"), "--reanchoring: not with --error"),
        (("--domain", "x.q1 = 1", "--seed", "3"), "--domain, --seed: only with a budget"),
        (("--error", "1e-9", "--precision", "triple"), "unknown precision 'triple'"),
        (("--error", "1e-9", "--quantile", "2"), 'or "max"'),
        (("--error", "1e-9", "--confidence", "1"), "confidence is 1.0"),
        (("--error", "1e-9", "--attempts", "0"), "attempts is 0"),
        (("--error", "1e-9", "--states", "0"), "select is 0"),
        (("--error", "1e-9", "--objective", "speed"), "unknown objective 'speed'"),
        (("--error", "1e-9", "--relative-to", "solutions"), "Did you mean 'solution'"),
        (("--relative-to", "terms"), "--relative-to: only with a budget"),
        (("--error", "1e-9", "--domain", "nowhere.toml"), "nowhere.toml: there is no such file"),
        (("--error", "1e-9", "--domain", "x.q3 = 1"), "--domain: x: unknown key 'q3'"),
    ],
)
def test_bad_requests(options: tuple[str, ...], message: str, tmp_path: Path) -> None:
    """The commands run in this process, which is faster; `main` turns every `KanegenError` into one line."""
    done = CliRunner().invoke(app, ["generate", PENDULUM, "-o", str(tmp_path / "out"), *options])
    assert isinstance(done.exception, KanegenError), done.output
    assert message in str(done.exception)
    assert not (tmp_path / "out").exists()


def test_a_singular_domain_names_what_to_exclude(tmp_path: Path) -> None:
    body = str(MODELS / "free_body.toml")
    done = kanegen("generate", body, "-o", str(tmp_path / "out"), "--error", "1e-9", status=2)
    assert "exclude.clearance" in done.stderr


def test_an_impossible_budget_says_what_is_reachable(tmp_path: Path) -> None:
    done = kanegen("generate", PENDULUM, "-o", str(tmp_path / "o"), "--error", "1e-12", *CHEAP, status=2)
    assert "no variant keeps an error of 1e-12" in done.stderr
    assert "which allows for a budget of" in done.stderr


def test_a_compiler_that_fails(tmp_path: Path) -> None:
    missing = kanegen(
        "generate", PENDULUM, "-o", str(tmp_path / "a"), "--error", "1e-9", status=2, KANEGEN_CC="no-such-cc"
    )
    assert "no-such-cc" in missing.stderr
    failing = kanegen(
        "generate",
        PENDULUM,
        "-o",
        str(tmp_path / "b"),
        "--error",
        "1e-2",
        *CHEAP,
        status=2,
        KANEGEN_CC="false",
    )
    assert "refused" in failing.stderr


def test_no_certificate(tmp_path: Path) -> None:
    assert "there is no such file" in kanegen("verify", str(tmp_path / "c.json"), status=2).stderr
    (tmp_path / "c.json").write_text("{}")
    assert "not a certificate" in kanegen("verify", str(tmp_path / "c.json"), status=2).stderr


@pytest.mark.parametrize("command", ["generate", "verify"])
def test_help(command: str) -> None:
    assert "kanegen[study]" in kanegen(command, "--help").stdout
