"""Cases that others have published, as docs/validation.md has them, and what counts as failing there."""

from __future__ import annotations

import re
from pathlib import Path

import mpmath
import pytest

import kanegen as kg
from benchmarks.validation import __main__ as validation
from benchmarks.validation import digits
from benchmarks.validation.case import Case, Row, load, row
from benchmarks.validation.cases import CASES, Study
from benchmarks.validation.document import document
from tests.support.cases import slow_among
from tests.support.paths import ROOT


@pytest.mark.parametrize("name", slow_among(CASES, "puma560", "space_station", "flyball_governor"))
def test_published_case(name: str) -> None:
    case = CASES[name].quick()
    assert case.count > 0
    failing = [f"{one.quantity}: {one.found} against {one.expected}" for one in case.rows if not one.holds]
    assert not failing


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name, study in CASES.items() if study.full is not study.quick])
def test_whole_published_case(name: str) -> None:
    assert CASES[name].full().holds


def test_half_a_unit_of_the_last_digit_is_allowed() -> None:
    assert row("a", "m", "31.6399 -0.0000", [31.63994, 0.00004]).holds
    assert not row("a", "m", "31.6399 -0.0000", [31.63996, 0.0]).holds
    assert not row("a", "m", "31.6399 0.0000", [31.6399, 0.00006]).holds
    assert row("a", "m", "1.5e-3", [0.00154]).holds
    assert not row("a", "m", "1.5e-3", [0.00156]).holds


def test_a_number_that_is_not_finite_fails() -> None:
    assert not row("a", "m", "1.0", [float("nan")], allowed=1e9).holds


def test_taylor_series_have_the_digits_of_elliptic_functions() -> None:
    """The simple pendulum of A01 for 2 s: sin(phi/2) = k sn(K - sqrt(g/L) t), phi = theta + pi/2."""
    equations, none = kg.derive(load("simple_pendulum")), dict[str, str]()
    field = digits.rates(equations, [])
    runs = (digits.Run(steps=60, order=30), digits.Run(steps=80, order=26))
    thetas = [digits.motion(field, _horizontal, none, "2", run)[0] for run in runs]
    with mpmath.workdps(40):
        k = mpmath.sin(mpmath.pi / 4)
        sn = mpmath.ellipfun("sn", mpmath.ellipk(k**2) - 2 * mpmath.sqrt(mpmath.mpf(9.81)), m=k**2)
        theta = 3 * mpmath.pi / 2 - 2 * mpmath.asin(k * sn)
        text = digits.agreed(*thetas, most=20)
        assert len(text) == 21
        assert abs(mpmath.mpf(text) - theta) < mpmath.mpf(10) ** -19 / 2


def _horizontal() -> list[digits.arb]:
    return [digits.arb.pi(), digits.arb(0)]


def test_digits_agree_up_to_where_two_runs_differ() -> None:
    assert digits.agreed(digits.arb("1.23456789"), digits.arb("1.23456712")) == "1.23457"
    assert digits.agreed(digits.arb("-12.5"), digits.arb("-12.5"), most=4) == "-12.50"
    assert digits.agreed(digits.arb("1"), digits.arb("9")) == "none"


def test_as_many_numbers_are_found_as_expected() -> None:
    with pytest.raises(ValueError, match="2 numbers against 1"):
        Row("a", "m", ("1", "2"), (1.0,))


def test_the_document_names_what_fails() -> None:
    rows = (row("height", "m", "1.00 2.00", [1.001, 2.1]),)
    text = document([Case("A title, short", "model", "source", "problem", "allowance", rows)])
    assert "[A title, short](#a-title-short) | 2 | 20 | **fails**" in text
    assert re.search(r"\|  \|  \| 2.00 \| 2.10000 \| 1.0e-01 \*\*fails\*\* \| 5.0e-03 \|", text)


def test_a_failing_case_fails_the_command(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    good = Case("Good", "model", "source", "problem", "allowance", (row("a", "m", "1.0", [1.04]),))
    bad = Case("Bad", "model", "source", "problem", "allowance", (row("a", "m", "1.0", [1.06]),))
    monkeypatch.setattr("sys.argv", ["validation", "--docs", str(tmp_path)])
    studies = {case.title: Study(lambda case=case: case, lambda case=case: case) for case in (good, bad)}
    monkeypatch.setattr(validation, "CASES", studies)
    with pytest.raises(SystemExit, match=r"larger than the sources allow: Bad$"):
        validation.main()
    assert "[Bad](#bad) | 1 | 1.2 | **fails**" in (tmp_path / "validation.md").read_text(encoding="utf-8")


def test_the_document_has_every_case() -> None:
    text = (ROOT / "docs" / "validation.md").read_text(encoding="utf-8")
    titles = re.findall(r"^## (.*)$", text, flags=re.MULTILINE)
    assert len(titles) == len(CASES)
    assert "fails**" not in text
    for name in CASES:
        assert f"benchmarks/validation/models/{name}.toml" in text
