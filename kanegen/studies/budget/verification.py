"""The verification of a certificate: all that can be derived is derived again and compared.

A certificate that was edited, or that belongs to another model or version, is an error. From its request,
model, domain and variant the C is generated and built again, and every measurement is made again in the same
states: selection, validation and both searches. Each statement must follow from these. Then come states that
the certification has not seen. Times, and what became of the other variants, cannot be derived; a finding
names each of them as not checked.
"""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from kanegen.errors import BuildError, CertificateError, KanegenError
from kanegen.measure.truth.certify import WIDTH
from kanegen.model.system import System
from kanegen.options import Progress, quiet
from kanegen.readers import load as load_model
from kanegen.studies.budget.budget_evaluator import BudgetEvaluator, is_reproducible
from kanegen.studies.budget.certificate import (
    Certificate,
    Given,
    built_with,
    given,
    model_text,
    read_certificate,
)
from kanegen.studies.budget.confidence import exceedance_floor
from kanegen.studies.budget.confirmation import Confirmation, confirmation, is_refuted, is_refuted_by
from kanegen.studies.budget.differences import differences
from kanegen.studies.budget.region import region_from_table
from kanegen.studies.budget.request import Request
from kanegen.studies.budget.sampling import random_stream, sample_from_table, sample_region
from kanegen.studies.budget.statements import claim_words, request_from_table, statements
from kanegen.studies.budget.times import inconsistency
from kanegen.studies.tradeoff.exact_results import unit_roundoff
from kanegen.studies.tradeoff.variants import Candidate

MEASURED = ("claim", "validation", "search", "proof", "bits")
"""Sections that depend on the results of the variant, and so on the machine if it is not reproducible."""

GIVEN = ("request", "model", "domain", "variant")
"""Sections from which the other statements are derived; these no longer follow if one of them is changed."""

SHOWN = 3
"""Number of differences that a finding names."""


@dataclass(frozen=True)
class Finding:
    """The outcome of checking one statement of a certificate.

    Attributes:
        subject: Subject of the statement: a section of the certificate, a file, or a check.
        holds: Whether it still holds; None where it was not checked or cannot be checked.
        explanation: What was found, in words.
    """

    subject: str
    holds: bool | None
    explanation: str


@dataclass(frozen=True)
class Verification:
    """The outcome of checking a certificate.

    Attributes:
        findings: One finding for each statement of the certificate.
    """

    findings: tuple[Finding, ...]

    @property
    def passed(self) -> bool:
        """Whether no statement that was checked has failed."""
        return all(finding.holds is not False for finding in self.findings)


def verify(
    path: Path,
    model: System | None = None,
    states: int | None = None,
    seed: int = 1,
    progress: Progress = quiet,
) -> Verification:
    """Check a certificate: generate the C anew, repeat the measurements, and derive all statements again.

    Args:
        path: The certificate file. C files that lie beside it are checked as well.
        model: The model to which the certificate must belong; None for the model that it holds.
        states: Number of fresh states; None for as many as the certificate was validated by.
        seed: Seed of the fresh states.
        progress: Function that is called with the name of each stage.

    Raises:
        BuildError: If there is no C compiler, or the compiler fails.
        CertificateError: If the file is no certificate, was edited, or belongs to another model or version.
        ReadError: If the file cannot be read.

    Example:
        >>> found = verify(Path("build/panda_certificate.json"))
        >>> found.passed
        True
    """
    certificate = read_certificate(path)
    progress("generating and building")
    try:
        checks = _Checks.of(path.parent, certificate, model, progress)
    except BuildError:
        raise
    except KanegenError as error:
        raise CertificateError(f"{path}: {error}") from None
    return Verification(tuple(checks.findings(states or checks.request.fresh_states, seed)))


def _model_from_text(text: str) -> System:
    """Return the system that the content of a model file describes."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "model.toml"
        file.write_text(text, encoding="utf-8")
        return load_model(file)


@dataclass(frozen=True)
class _Checks:
    """The checks of one certificate.

    Attributes:
        folder: Folder of the certificate file.
        certificate: The certificate.
        given: What it is about.
        system: The model that it holds.
        request: Its request.
        seed: Seed of all its samples.
        candidate: Its variant.
        evaluator: The evaluator, which has built the variant again.
    """

    folder: Path
    certificate: Certificate
    given: Given
    system: System
    request: Request
    seed: int
    candidate: Candidate
    evaluator: BudgetEvaluator

    @classmethod
    def of(cls, folder: Path, certificate: Certificate, model: System | None, progress: Progress) -> _Checks:
        """Return the checks of a certificate, after building its variant again.

        Raises:
            BuildError: If the variant cannot be built.
            CertificateError: If the certificate belongs to another model, or what it is about is impossible.
            OptionError: If its domain is none of the model.
        """
        about, candidate = given(certificate), certificate.candidate
        if model is not None and model_text(model) != about.model_text:
            raise CertificateError(
                f"it is of another model than {model.name!r} as it is now. Generate it anew."
            )
        system = _model_from_text(about.model_text)
        region = region_from_table(system, about.domain)
        request, seed = request_from_table(about.request)
        if not 1 <= about.attempt <= request.attempts:
            raise CertificateError(f"it was validated in attempt {about.attempt} of {request.attempts}.")
        for _, state in about.worst.values():
            sample_from_table(region.domain, state)
        evaluator = BudgetEvaluator(region, request, [candidate], seed, progress)
        _, refused = evaluator.build([candidate])
        if candidate in refused:
            raise BuildError(f"{candidate.label}: {refused[candidate]}")
        return cls(folder, certificate, about, system, request, seed, candidate, evaluator)

    def findings(self, states: int, seed: int) -> Iterator[Finding]:
        """Yield the findings of all checks.

        Args:
            states: Number of fresh states.
            seed: Seed of the fresh states.
        """
        yield from self._sections()
        yield from self._files_beside()
        yield from self._worst_states()
        yield self._rules()
        yield self._fresh_states(states, seed)
        yield from self._measurements_of_the_machine()

    @cached_property
    def _confirmation(self) -> Confirmation[Candidate]:
        """The measurements of the certification, made again."""
        return confirmation(self.evaluator, self.request, self.candidate, self.given.attempt)

    @cached_property
    def _derived(self) -> dict[str, Any]:
        """The statements of the certificate, derived again.

        The words of the claim follow from the numbers that the certificate states.
        """
        text = model_text(self.system)
        derived = statements(text, self.evaluator, self.request, self._confirmation, self.seed)
        stated = [self.certificate.section(name) for name in ("claim", "validation", "search", "proof")]
        with suppress(KeyError, TypeError, ValueError):  # the words of the derived numbers stay
            derived["claim"]["words"] = claim_words(*stated)
        return derived

    @cached_property
    def _differences(self) -> str:
        """Differences between this machine and that of the certificate, in words; "" if there are none."""
        then = self.certificate.section("built_with")
        known = then if isinstance(then, Mapping) else {}
        return ", ".join(f"another {name}" for name, now in built_with().items() if now != known.get(name))

    @property
    def _may_differ(self) -> bool:
        """Whether other bits than those of the certificate are to be expected on this machine."""
        return bool(self._differences) and not is_reproducible(self.candidate)

    def _sections(self) -> Iterator[Finding]:
        """Compare each statement with what is derived again."""
        own = ("kind", "format", "generator", "//", "built_with", "times", "candidates")
        for name in self.certificate.content:
            if name not in self._derived and name not in own:
                yield Finding(name, False, "no certificate of this version has this section")
        for name, derived in self._derived.items():
            found = list(differences(name, self.certificate.section(name), derived))
            if not found:
                how = "given, in full" if name in GIVEN else "derived again and the same"
                yield Finding(name, True, how)
                continue
            listed = "; ".join(found[:SHOWN])
            more = f"; and {len(found) - SHOWN} more" if len(found) > SHOWN else ""
            if name in MEASURED and self._may_differ:
                yield Finding(name, None, f"differs, as it may: {self._differences}; {listed}{more}")
            else:
                yield Finding(name, False, f"{listed}{more}")

    def _files_beside(self) -> Iterator[Finding]:
        """Compare each C file in the folder of the certificate with the file that is generated now."""
        for name, digest in self._derived["source"].items():
            file = self.folder / name
            if file.is_file():
                same = hashlib.sha256(file.read_bytes()).hexdigest() == digest
                state = "the same" if same else "another file"
                yield Finding(name, same, f"beside the certificate, {state} as generated anew")

    def _worst_states(self) -> Iterator[Finding]:
        """Compare the errors in the worst states with those in the certificate, and with the claim."""
        roundoff = unit_roundoff(self.evaluator.library(self.candidate).source.variant)
        for part, (stated, state) in self.given.worst.items():
            sample = sample_from_table(self.evaluator.region.domain, state)
            error = float(self.evaluator.errors_in(self.candidate, sample)[0])
            is_same = abs(error - stated) <= 2 * WIDTH * roundoff + 1e-9 * stated
            obeys = not self.request.is_strict or error <= self._confirmation.validation.claim
            kept = "" if obeys else f", which exceeds {self._confirmation.validation.claim:.3g}"
            found = f"error {error:.3g}{kept}, was {stated:.3g}"
            yield Finding(f"worst state of the {part}", obeys and (is_same or self._may_differ), found)

    def _rules(self) -> Finding:
        """Return whether the measurements, made again, still confirm the variant."""
        again = self._confirmation
        refuting = [found for found in again.searches if is_refuted_by(self.request, found)]
        if refuting:
            return Finding("confirmation", False, f"a search finds an error of {refuting[0].error:.3g}")
        count = f"{again.validation.exceeded} of {len(again.validation.errors)}"
        said = f"{count} states of the validation exceed {again.validation.claim:.3g}"
        if is_refuted(self.request, again.validation):
            return Finding("confirmation", False, said)
        return Finding(
            "confirmation", True, f"{said}; no search refutes it in {again.evaluations} evaluations"
        )

    def _fresh_states(self, states: int, seed: int) -> Finding:
        """Compare the errors in states that the certification has not seen with the claim."""
        evaluator, request, claim = self.evaluator, self.request, self._confirmation.validation.claim
        sample = sample_region(evaluator.region, evaluator.exact, states, random_stream(seed, "verify", 0))
        errors = evaluator.errors_in(self.candidate, sample)
        exceeded = int(np.sum(~(errors <= claim)))
        too_many = exceedance_floor(exceeded, states, request.alpha) > request.share
        holds = not exceeded if request.is_strict and request.error is not None else not too_many
        found = f"{exceeded} of {states} fresh states exceed {claim:.3g}, the largest error is"
        return Finding("fresh states", holds, f"{found} {errors.max():.3g}")

    def _measurements_of_the_machine(self) -> Iterator[Finding]:
        """Yield what cannot be derived: the machine, the times, and what became of the other variants."""
        section = self.certificate.section
        here = differences("built_with", section("built_with"), built_with())
        if self._differences:
            yield Finding("built_with", None, f"not checked: {self._differences} than here")
        else:
            found = list(here)
            yield Finding("built_with", not found, "; ".join(found[:SHOWN]) or "the machine is the same")
        times, candidates = section("times"), section("candidates")
        wrong = inconsistency(times, candidates, self.request, self.candidate.label)
        where = f"says nothing here: {self._differences}" if self._differences else "the machine is the same"
        yield Finding("times", False if wrong else None, wrong or f"not measured again; {where}")
        yield Finding("candidates", None, "not checked: the other variants were not measured again")
        yield Finding("request.effort.seconds", None, "not checked: the duration of a timing leaves no trace")
