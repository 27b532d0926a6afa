"""What a trade-off study recommends in words, how sure it is, and the picture of its variants."""

from __future__ import annotations

import re
import xml.etree.ElementTree

import pytest

from kanegen.measure.timing import BATCH, LATENCY
from kanegen.options import STRICT, Variant
from kanegen.studies.tradeoff.outcome import VariantResult
from kanegen.studies.tradeoff.plot import error_bands, tradeoff_svg
from kanegen.studies.tradeoff.recommendation import Recommendation, recommendations
from kanegen.studies.tradeoff.report import markdown
from kanegen.studies.tradeoff.tables import rows
from kanegen.studies.tradeoff.variants import QUICK, Candidate, candidates
from tests.support.made_studies import made_study, result

DEFAULT = result(Candidate(STRICT), 200.0, 1e-15)
NATIVE = Candidate(Variant(solver="factorisation", refinement=0, machine="native"))
FLOAT = Candidate(Variant(solver="factorisation", refinement=0, precision="float"))
PAIRS = Candidate(Variant(solver="factorisation", refinement=0, precision="double-double"))
TURNING = Candidate(STRICT, speeds="angular_velocity")
NOISY = (1.0, 1.6, 0.7, 1.3, 0.8, 1.1, 0.9)


def lines(*results: VariantResult, objective: str = LATENCY) -> list[str]:
    return Recommendation(made_study(*results), objective).lines()


def test_what_is_faster_and_what_it_loses_are_measured_from_the_default() -> None:
    found = lines(DEFAULT, result(NATIVE, 125.0, 1.1e-15), result(FLOAT, 50.0, 1e-11))
    assert (
        found[0]
        == "Take factorisation, native: 1.6 (1.6 to 1.6) times as fast as the default, no digit lost."
    )
    assert found[1] == (
        "For more speed take float, factorisation: 4 (4 to 4) times as fast as the default, 4 digits "
        "lost; that is 2.5 (2.5 to 2.5) times as fast as the fastest that loses none."
    )
    assert found[2] == "No variant is a digit more accurate."


def test_nothing_is_gained_by_float_where_it_is_not_faster() -> None:
    found = lines(DEFAULT, result(NATIVE, 125.0, 1.1e-15), result(FLOAT, 125.5, 1e-6))
    assert "Nothing is gained by losing digits." in found
    float_line = next(line for line in found if line.startswith("Nothing is gained by float"))
    assert float_line == (
        "Nothing is gained by float: its fastest variant, float, factorisation, is 0.996 (0.996 to "
        "0.996) times as fast as factorisation, native, 9 digits lost."
    )


def test_the_price_of_more_digits() -> None:
    found = lines(DEFAULT, result(PAIRS, 2000.0, 1e-31))
    assert found[0] == "Keep the default: nothing that is as accurate is faster."
    assert "16 digits more: double-double, factorisation, 10 (10 to 10) times the time of default." in found
    assert not any(line.startswith("Nothing is gained by double-double") for line in found)


def test_a_gain_that_the_rounds_do_not_show_is_no_gain() -> None:
    found = lines(DEFAULT, result(NATIVE, 196.0, 1e-15, NOISY))
    assert found[0].startswith(
        "Keep the default: the fastest variant that is as accurate, factorisation, native, is "
    )
    assert found[0].endswith("which may be chance.")
    low, high = map(float, re.findall(r"\(([\d.]+) to ([\d.]+)\)", found[0])[0])
    assert low < 1 < high


def test_a_noisy_machine_is_named() -> None:
    noisy = [result(Candidate(STRICT), 200.0, 1e-15, NOISY), result(NATIVE, 100.0, 1e-15, NOISY)]
    assert lines(*noisy)[-1].startswith(
        "This machine is noisy: the slowest round of a program takes 60 % longer"
    )
    assert not any("noisy" in line for line in lines(DEFAULT, result(NATIVE, 100.0, 1e-15)))
    once = [result(Candidate(STRICT), 200.0, 1e-15, (1.0,)), result(NATIVE, 100.0, 1e-15, (1.0,))]
    assert lines(*once)[-1].startswith("There was one round of timing")
    assert lines(*once)[0].endswith("is 2 times as fast, which may be chance.")


def test_other_coordinates_stand_apart() -> None:
    study = made_study(DEFAULT, result(NATIVE, 125.0, 1e-15), result(TURNING, 20.0, 1e-15))
    for objective in (LATENCY, BATCH):
        assert [c.result.label for c in study.pareto_fronts[objective]] == ["factorisation, native"]
        assert [row[0] for row in rows(study, objective)] == ["factorisation, native", "default"]
        assert [row[0] for row in rows(study, objective, reformulated=True)] == [TURNING.label]
    found = Recommendation(study, LATENCY).lines()
    assert found[0].startswith("Take factorisation, native")
    assert found[-1].startswith("Apart from these, with other coordinates or speeds")
    assert "10 (10 to 10) times as fast as the default, no digit lost" in found[-1]
    assert "## Variants with other coordinates or speeds" in markdown(study)


def test_a_default_that_shares_its_program_is_found_and_one_that_is_absent_is_not() -> None:
    shared = result(Candidate(STRICT), 200.0, 1e-15, same_as="factorisation, native")
    assert lines(shared, result(NATIVE, 200.0, 1e-15))[0].startswith("Keep the default")
    assert lines(result(NATIVE, 200.0, 1e-15)) == []
    assert recommendations(made_study(result(NATIVE, 200.0, 1e-15))) == []


def test_the_document_begins_with_the_recommendation() -> None:
    study = made_study(DEFAULT, result(NATIVE, 125.0, 1.1e-15))
    found = recommendations(study)
    assert found[0].startswith("One state a call: Take factorisation, native")
    assert any(line.startswith("Batches: Take factorisation, native") for line in found)
    assert "95 % confidence" in found[-1]
    assert markdown(study).index(found[0]) < markdown(study).index("## How")


def test_an_axis_is_broken_where_nothing_is() -> None:
    assert error_bands([1e-31, 2e-31, 1e-16, 1e-14, 1e-7]) == [
        pytest.approx((1e-7 / 10**0.5, 1e-7 * 10**0.5)),
        pytest.approx((1e-16 / 10**0.5, 1e-14 * 10**0.5)),
        pytest.approx((1e-31 / 10**0.5, 2e-31 * 10**0.5)),
    ]
    assert len(error_bands([1e-16, 1e-13, float("inf")])) == 1
    assert len(error_bands([])) == 1


def test_the_picture_names_the_default_and_the_front() -> None:
    study = made_study(
        DEFAULT, result(NATIVE, 125.0, 1.1e-15), result(FLOAT, 50.0, 1e-6), result(PAIRS, 2000.0, 1e-31)
    )
    texts = " ".join(xml.etree.ElementTree.fromstring(tradeoff_svg(study)).itertext())
    assert "default" in texts
    for number, label in enumerate(("float", "factorisation, native", "default", "double-double"), start=1):
        assert re.search(rf"{number}\s+{label}", texts), label


def test_quick_variants_hold_the_default_and_differ() -> None:
    found, refused = candidates(QUICK)
    assert not refused
    assert found[0] == Candidate(STRICT)
    assert 10 <= len(found) == len({candidate.label for candidate in found}) <= 14
