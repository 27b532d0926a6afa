"""From a model to C with a certificate, and from the certificate to its verification."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.artifacts.certificate import certificate_text
from kanegen.c.provenance import with_provenance
from kanegen.errors import BudgetError, CertificateError, OptionError, ReadError
from kanegen.measure.truth import measure
from kanegen.options import AUTO, STRICT
from kanegen.studies.budget import certificate
from kanegen.studies.budget.budget_evaluator import allowed_candidates, is_reproducible, usable_errors
from kanegen.studies.budget.certification import CertifiedSource, certify_variant
from kanegen.studies.budget.proofs import bounds_by_state
from kanegen.studies.budget.region import read_region
from kanegen.studies.budget.request import METRICS, Effort, Request
from kanegen.studies.budget.sampling import sample_from_table
from kanegen.studies.budget.statements import claim_words
from kanegen.studies.budget.verification import Verification, verify
from kanegen.studies.tradeoff.domain import joined
from kanegen.studies.tradeoff.exact_results import ExactResults, compute_accelerations
from kanegen.studies.tradeoff.hard_states import hard_states
from kanegen.studies.tradeoff.variants import Candidate
from tests.support.cases import slow_except
from tests.support.paths import MODELS

MODEL = kg.load(MODELS / "double_pendulum.toml")
FILE = "double_pendulum_certificate.json"
SINGLE = Candidate(replace(STRICT, precision="float"))
CANDIDATES = (Candidate(STRICT), SINGLE, Candidate(replace(STRICT, optimisation=1)))
EFFORT = Effort(select=24, search=32, rounds=6, seconds=0.0005)
BOX = "x.angles = [-1, 1]; exclude.cancellation = 100"


def request(**terms: Any) -> Request:
    return Request(**{"quantile": 0.9, "attempts": 1, "effort": EFFORT, **terms})


@pytest.fixture(scope="module")
def strict() -> CertifiedSource:
    """A budget that only double precision keeps."""
    return certify_variant(MODEL, read_region(BOX, MODEL), request(error=1e-10), CANDIDATES)


@pytest.fixture(scope="module")
def written(strict: CertifiedSource, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return strict.source.write(tmp_path_factory.mktemp("out") / "strict") / FILE


def copied(written: Path, tmp_path: Path) -> Path:
    shutil.copytree(written.parent, tmp_path / "copy")
    return tmp_path / "copy" / FILE


def failed(found: Verification) -> set[str]:
    return {finding.subject for finding in found.findings if finding.holds is False}


def test_the_certificate_says_what_was_measured(strict: CertifiedSource, written: Path) -> None:
    content = json.loads(written.read_text())
    assert content["variant"]["precision"] == "double"
    assert content["candidates"][SINGLE.label].startswith("not built")
    assert content["claim"]["error"] == 1e-10
    assert "guarantee" not in written.read_text()
    assert "no counterexample found in" in content["claim"]["words"]
    assert content["claim"]["evidence"] == content["proof"]["kind"] == "proven by state"
    assert content["proof"]["by_state"]["kept"] == content["validation"]["states"]
    seen = content["validation"]
    assert (seen["states"], seen["exceeded"]) == (29, 0)
    assert content["claim"]["exceeded_by_less_than"] == pytest.approx(1 - 0.05 ** (1 / 29))
    assert 1 <= seen["chi"][0] <= seen["chi"][1] <= 100
    assert content["search"]["evaluations"] > 32
    assert content["times"]["median"] == pytest.approx(np.median(content["times"]["rounds"]))
    assert {"double_pendulum.c", "double_pendulum.h"} <= set(content["source"])


def test_the_worst_state_has_the_error_that_is_told(strict: CertifiedSource) -> None:
    """The error is measured again by `truth.measure`, which shares no code with the search."""
    worst = strict.certificate.content["validation"]["worst"]
    box = read_region(BOX, MODEL)
    sample = sample_from_table(box.domain, worst["state"])
    library = kg.build(MODEL, ("forward_dynamics",), tier=strict.choice.candidate.variant)
    found = measure(MODEL, library, sample, sample.tau)["forward_dynamics"]
    alone = library.forward_dynamics(sample.x[0], sample.y[0], sample.tau[0])
    together = library.forward_dynamics(sample.x, sample.y, sample.tau)[0]
    if (alone == together).all():
        assert found.normwise[0] == pytest.approx(worst["error"], rel=1e-4)
    assert worst["error"] <= found.bound[0]


def test_a_certificate_verifies(written: Path) -> None:
    found = verify(written, MODEL)
    assert found.passed, found.findings
    names = [finding.subject for finding in found.findings]
    assert {"claim", "source", "double_pendulum.c", "bits", "confirmation", "fresh states"} <= set(names)
    open_ones = {finding.subject for finding in found.findings if finding.holds is None}
    assert open_ones == {"times", "candidates", "request.effort.seconds"}


def test_another_model_is_an_error(written: Path) -> None:
    with pytest.raises(CertificateError, match="of another model than 'cart_pole'"):
        verify(written, kg.load(MODELS / "cart_pole.toml"))
    with pytest.raises(CertificateError, match="of another model than 'double_pendulum' as it is now"):
        verify(written, MODEL.with_parameters({"m1": 1.0000000000000002}))


def test_changed_c_does_not_hold(written: Path, tmp_path: Path) -> None:
    path = copied(written, tmp_path)
    file = path.parent / "double_pendulum.c"
    file.write_text(file.read_text().replace("+", "-", 1))
    assert failed(verify(path)) == {"double_pendulum.c"}
    file.unlink()
    assert verify(path, states=1).passed


def rewritten(path: Path, change: Callable[[dict[str, Any]], Any]) -> Path:
    """Forge a certificate: change its content and renew its digest."""
    content = json.loads(path.read_text())
    del content["//"]
    change(content)
    path.write_text(certificate_text(path.name, content))
    return path


def test_a_forged_certificate_does_not_hold(written: Path, tmp_path: Path) -> None:
    def forge(content: dict[str, Any]) -> None:
        content["claim"].update(error=1e-18, quantile="max")
        content["source"]["double_pendulum.h"] = "0" * 64
        content["bits"]["sha256"] = "0" * 64
        content["validation"]["worst"]["error"] = 1e-12

    found = failed(verify(rewritten(copied(written, tmp_path), forge)))
    assert found == {"claim", "source", "bits", "validation", "worst state of the validation"}


def leaves(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yield the path of every value that is no mapping and no list, and of every empty one."""
    if isinstance(value, dict | list) and value:
        for key, own in value.items() if isinstance(value, dict) else enumerate(value):
            yield from leaves(own, (*path, key))
    else:
        yield path


def mutated(value: Any) -> Any:
    """Return another value of the same type where there is one."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, int | float):
        return value + 1 if isinstance(value, int) else 0.5 * value + (value == 0)
    if isinstance(value, str) and value.startswith(("0x", "-0x")):
        return (0.5 * float.fromhex(value) + 0.25).hex()
    return f"{value}x" if isinstance(value, str) else [1] if isinstance(value, list) else 1


def mutation(path: tuple[Any, ...]) -> Callable[[dict[str, Any]], None]:
    """Return a function that changes the value at a path of a certificate."""

    def change(content: dict[str, Any]) -> None:
        for key in path[:-1]:
            content = content[key]
        content[path[-1]] = mutated(content[path[-1]])

    return change


UNCHECKED = {
    ("built_with",): "built_with",
    ("candidates",): "candidates",
    ("request", "effort", "seconds"): "request.effort.seconds",
}
"""What cannot be derived, by the beginning of its path, and the finding that says so.

A time would belong to this list, but a single one contradicts the median, the least time, or the budget.
"""


def refused_or_named(path: tuple[Any, ...], file: Path) -> bool:
    """Return whether a changed certificate is refused, or the changed value is named as not checked."""
    try:
        found = verify(rewritten(file, mutation(path)), states=1)
    except CertificateError:
        return True
    named = {finding.subject for finding in found.findings if finding.holds is None}
    unchecked = (subject in named for start, subject in UNCHECKED.items() if path[: len(start)] == start)
    return not found.passed or any(unchecked)


TOLD = (
    *(("claim", name) for name in ("error", "relative_to", "evidence", "quantile", "confidence", "words")),
    *(("request", name) for name in ("error", "relative_to", "seed")),
    *(("request", "effort", "validate"), ("request", "effort", "search"), ("request", "effort", "rounds")),
    *(("validation", "alpha"), ("validation", "errors", "p99"), ("validation", "worst", "error")),
    *(("search", "evaluations"), ("search", "worst", "state", "y", 0)),
    *(("domain", "x", "q1", 1), ("domain", "tau", "q2", 0), ("domain", "exclude", "cancellation")),
    *(("not_claimed", 2), ("flags", 0), ("times", "median"), ("variant", "optimisation")),
)
"""Paths of which one of every kind stands for all."""


@pytest.mark.parametrize("path", slow_except(TOLD, *TOLD[::8]), ids=str)
def test_a_changed_statement_is_refused_although_the_digest_was_made_anew(
    path: tuple[Any, ...], written: Path, tmp_path: Path
) -> None:
    assert refused_or_named(path, copied(written, tmp_path))


@pytest.mark.slow
def test_every_changed_value_is_refused_or_named_as_not_checked(written: Path, tmp_path: Path) -> None:
    path = copied(written, tmp_path)
    content = json.loads(path.read_text())
    original, missed = path.read_text(), []
    paths = [one for one in leaves(content) if one != ("//",)]
    for one in paths:
        path.write_text(original)
        missed += [] if refused_or_named(one, path) else [one]
    assert len(paths) > 100
    assert missed == []


@pytest.mark.parametrize("section", ["claim", "domain", "built_with", "times", "variant"])
def test_an_additional_statement_is_refused(section: str, written: Path, tmp_path: Path) -> None:
    path = rewritten(copied(written, tmp_path), lambda c: c[section].update(approved="by all"))
    try:
        assert not verify(path, states=1).passed
    except CertificateError as error:
        assert "approved" in str(error)


def test_a_claim_that_its_own_measurements_refute_is_refused(
    strict: CertifiedSource, written: Path, tmp_path: Path
) -> None:
    """Budget, claim and words are changed together, as a program would write them."""

    def forge(content: dict[str, Any]) -> None:
        content["request"]["error"] = content["claim"]["error"] = 1e-18
        content["validation"]["exceeded"] = content["validation"]["states"]
        content["claim"]["exceeded_by_less_than"] = 1.0
        parts = (content[name] for name in ("claim", "validation", "search", "proof"))
        content["claim"]["words"] = claim_words(*parts)

    found = failed(verify(rewritten(copied(written, tmp_path), forge)))
    assert {"confirmation", "fresh states", "proof"} <= found


def test_a_variant_that_was_exchanged_has_another_source(written: Path, tmp_path: Path) -> None:
    path = rewritten(copied(written, tmp_path), lambda content: content["variant"].update(without=["factor"]))
    assert "source" in failed(verify(path, states=1))


def test_another_machine_takes_the_times_only(written: Path, tmp_path: Path) -> None:
    path = rewritten(copied(written, tmp_path), lambda c: c["built_with"].update(processor="abacus"))
    found = verify(path)
    assert found.passed
    (machine,) = (finding for finding in found.findings if finding.subject == "built_with")
    assert "another processor" in machine.explanation


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "not valid JSON"),
        ("[1, 2]", "not a certificate of kanegen"),
        ('{"kind": "cake"}', "not a certificate of kanegen"),
        (
            f'{{"kind": "{certificate.KIND}", "format": 2, "generator": "0.0.1"}}',
            "made by kanegen 0.0.1 in format 2, this is",
        ),
    ],
)
def test_files_that_are_no_certificate(text: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "c.json"
    file.write_text(text)
    with pytest.raises(CertificateError, match=message) as error:
        verify(file)
    assert str(error.value).startswith(str(file))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda c: c.pop("claim"), "no section 'claim'"),
        (lambda c: c["request"].pop("effort"), "its request is none"),
        (lambda c: c["request"].update(error=0.0), "its request is none: error is 0.0"),
        (lambda c: c["request"].update(error="small"), "its request is none"),
        (lambda c: c["validation"]["attempts"].update(made=2), "validated in attempt 2 of 1"),
        (lambda c: c["validation"].pop("worst"), "KeyError"),
        (lambda c: c.update(model=3), "TypeError"),
        (
            lambda c: c["variant"].update(precision="triple"),
            "its variant is unknown: unknown precision 'triple'",
        ),
        (lambda c: c["variant"].update(charm=1), "its variant is unknown"),
        (lambda c: c["model"].update(text="name = 'x'"), "a model needs bodies"),
        (lambda c: c["domain"].update(z=1), "unknown key 'z'"),
        (
            lambda c: c["validation"]["worst"].update(state={"x": ["0x1p0"]}),
            "worst state is not a state of this model",
        ),
    ],
)
def test_broken_certificates(
    change: Callable[[dict[str, Any]], Any], message: str, written: Path, tmp_path: Path
) -> None:
    with pytest.raises(CertificateError, match=message):
        verify(rewritten(copied(written, tmp_path), change))


def test_an_edited_certificate_is_an_error(written: Path, tmp_path: Path) -> None:
    path = copied(written, tmp_path)
    path.write_text(path.read_text().replace("1e-10", "1e-11"))
    with pytest.raises(CertificateError, match="edited since kanegen wrote it"):
        verify(path)
    with pytest.raises(ReadError, match="there is no such file"):
        verify(tmp_path / "nothing.json")


def test_a_key_that_occurs_twice_is_an_error(written: Path, tmp_path: Path) -> None:
    """A reader would see the first claim, a program the last."""
    path = copied(written, tmp_path)
    path.write_text(path.read_text().replace('"claim": {', '"claim": {"error": 1e-15}, "claim": {', 1))
    with pytest.raises(CertificateError, match="the key 'claim' occurs twice"):
        verify(path)


def test_single_precision_where_it_is_good_enough() -> None:
    """Single precision keeps a budget of 1e-2 but not one of 1e-9."""
    found = certify_variant(MODEL, read_region(BOX, MODEL), request(error=1e-2), (SINGLE,))
    assert found.source.precision == "float"
    assert 1e-9 < found.choice.validation.errors.max() <= 1e-2
    with pytest.raises(BudgetError, match=rf"error of 1e-09.*'{SINGLE.label}' with"):
        certify_variant(MODEL, read_region(BOX, MODEL), request(error=1e-9), (SINGLE,))


def test_a_counterexample_names_what_to_exclude() -> None:
    """Near equilibrium single precision loses all digits, and a search finds that."""
    effort = replace(EFFORT, search=200)
    terms = request(error=2e-5, relative_to="solution", quantile=1.0, effort=effort)
    with pytest.raises(BudgetError, match=r"refuted in \d+ evaluations.*exclude\.cancellation"):
        certify_variant(MODEL, read_region("x.angles = [-1, 1]", MODEL), terms, (SINGLE,))
    terms = request(error=2e-5, quantile=0.9)
    kept = certify_variant(MODEL, read_region("x.angles = [-1, 1]", MODEL), terms, (SINGLE,))
    assert kept.choice.worst.error < 2e-5


def test_a_budget_of_time() -> None:
    found = certify_variant(MODEL, read_region(BOX, MODEL), request(time=1e9), CANDIDATES)
    assert found.source.precision == "double"
    assert found.choice.validation.exceeded == 0
    claim, proof = (found.certificate.content[name] for name in ("claim", "proof"))
    assert claim["evidence"] == "sampled"  # a claim of the largest error found is below its proven bound
    assert proof["by_state"]["median_bound"] > claim["error"]
    with pytest.raises(BudgetError, match=r"time of 0\.001 ns for latency.*fastest one is"):
        certify_variant(MODEL, read_region(BOX, MODEL), request(time=1e-3), CANDIDATES)


@pytest.mark.parametrize("yardstick", METRICS)
def test_bounds_by_state_are_never_below_errors(yardstick: str) -> None:
    """In ordinary states and in equilibrium, for results of double and of single precision."""
    domain = read_region(BOX, MODEL).domain
    hard = hard_states(domain, 6, 0)
    assert hard is not None
    sample = joined([domain.sample(10, 0), hard])
    exact = ExactResults(MODEL)
    for precision in ("double", "float"):
        library = kg.build(MODEL, ("forward_dynamics",), precision=precision)
        values = compute_accelerations(library, sample, "latency")
        bounds = bounds_by_state(exact, sample, values, yardstick)
        errors = usable_errors(exact.errors(library, sample, "latency"), yardstick)
        assert (errors <= bounds).all()
        assert np.median(bounds[:10] / errors[:10]) < (1e2 if precision == "double" else 10)


@pytest.mark.slow
def test_a_budget_in_units(tmp_path: Path) -> None:
    found = certify_variant(
        MODEL, read_region(BOX, MODEL), request(error=1e-9, relative_to="units"), CANDIDATES
    )
    content = found.certificate.content
    assert "error at most 1e-09 in rad/s^2 and m/s^2" in content["claim"]["words"]
    assert content["claim"]["evidence"] == "proven"
    assert "in every state of the domain" in content["claim"]["words"]
    assert "an upper bound on the error in every state of the domain" not in content["not_claimed"]
    assert found.choice.worst.error <= content["proof"]["domain"]["bound"] <= 1e-9
    assert verify(found.source.write(tmp_path / "out") / FILE, states=8).passed
    sample = sample_from_table(read_region(BOX, MODEL).domain, content["validation"]["worst"]["state"])
    library = kg.build(MODEL, ("forward_dynamics",), tier=found.choice.candidate.variant)
    (exact,) = ExactResults(MODEL).states(sample)
    off = exact.outputs["forward_dynamics"].distance(
        library.forward_dynamics(sample.x[0], sample.y[0], sample.tau[0])
    )
    assert found.choice.validation.errors.max() == pytest.approx(off.max(), rel=1e-3)


@pytest.mark.slow
def test_batches_are_measured_as_batches(tmp_path: Path) -> None:
    found = certify_variant(
        MODEL, read_region(BOX, MODEL), request(error=1e-9, objective="batch"), CANDIDATES
    )
    assert found.certificate.content["times"]["objective"] == "batch"
    assert verify(found.source.write(tmp_path / "out") / FILE).passed


@pytest.mark.slow
def test_regular_speeds_need_no_clearance(tmp_path: Path) -> None:
    """A free body over all orientations, through gimbal lock."""
    body = kg.load(MODELS / "free_body.toml").with_speeds("angular_velocity")
    found = certify_variant(body, read_region(None, body), request(error=1e-8), CANDIDATES)
    assert found.certificate.content["domain"]["exclude"] == {"clearance": 0.0}
    assert found.choice.validation.errors.max() < 1e-10
    path = found.source.write(tmp_path / "out") / f"{body.name}_certificate.json"
    assert verify(path, body).passed


@pytest.mark.slow
def test_loads_and_parameters(tmp_path: Path) -> None:
    """The C keeps them; the claim is for the parameters that the domain gives."""
    crane = kg.load(MODELS / "gantry_crane.toml")
    names = [parameter.name for parameter in crane.parameters]
    value = 1.25 * crane.parameters[0].value
    box = read_region(f"parameters.{names[0]} = {value!r}; exclude.cancellation = 100", crane)
    found = certify_variant(crane, box, request(error=1e-8), CANDIDATES)
    assert [parameter for parameter, _ in found.source.model.parameters] == names
    assert found.certificate.content["domain"]["parameters"] == {names[0]: value}
    assert verify(found.source.write(tmp_path / "out") / f"{crane.name}_certificate.json", crane).passed


def test_the_candidates_of_a_study() -> None:
    found = allowed_candidates()
    assert found[0] == Candidate(STRICT)
    assert len(set(found)) == len(found)
    assert all(candidate.speeds is None for candidate in found)
    assert {c.variant.machine for c in allowed_candidates(is_reproducible)} == {AUTO}
    with pytest.raises(OptionError, match="no variant is left"):
        allowed_candidates(lambda candidate: False)


def test_results_that_are_not_finite_have_infinite_errors(strict: CertifiedSource) -> None:
    class Broken:
        source = strict.source

        def forward_dynamics(self, x: Any, *_: Any) -> Any:
            return np.full_like(x, np.nan)

    box = read_region(BOX, MODEL)
    sample = box.domain.sample(3, 0)
    assert (usable_errors(ExactResults(MODEL).errors(Broken(), sample, "latency"), "terms") == np.inf).all()
    assert with_provenance(FILE, "x").startswith('{"//": "Generated by kanegen ')
