"""The verification of a certificate: everything in it but the times is generated and measured anew.

A certificate that was edited, or that belongs to another model or version, is an error. A statement of the
certificate that can be checked and turns out different is a finding that does not hold.
"""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from kanegen.errors import BuildError, CertificateError, KanegenError
from kanegen.library import Library, load
from kanegen.measure.truth.certify import WIDTH
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.options import Progress, quiet
from kanegen.readers import load as load_model
from kanegen.studies.budget.budget_evaluator import is_reproducible, usable_errors
from kanegen.studies.budget.certificate import (
    DIGEST_STATES,
    CertificateFields,
    built_with,
    certificate_fields,
    model_text,
    read_certificate,
    results_digest,
    source_digests,
)
from kanegen.studies.budget.confidence import exceedance_floor
from kanegen.studies.budget.region import Region, region_from_table
from kanegen.studies.budget.sampling import random_stream, sample_from_table, sample_region
from kanegen.studies.tradeoff.compilation import generate_variant
from kanegen.studies.tradeoff.domain import Sample
from kanegen.studies.tradeoff.exact_results import ExactResults, unit_roundoff

MACHINE = ("processor", "compiler", "libc")
"""Properties of a machine on which times depend and, for a variant that is not reproducible, results too."""


@dataclass(frozen=True)
class Finding:
    """The outcome of checking one statement of a certificate.

    Attributes:
        subject: Subject of the statement.
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
    """Check a certificate: generate the C anew and repeat the measurements.

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
        fields = certificate_fields(certificate)
        if model is not None and model_text(model) != fields.model_text:
            raise CertificateError(
                f"it is of another model than {model.name!r} as it is now. Generate it anew."
            )
        region = region_from_table(_model_from_text(fields.model_text), fields.domain)
        library = load(generate_variant(region.system, certificate.candidate))
    except BuildError:
        raise
    except KanegenError as error:
        raise CertificateError(f"{path}: {error}") from None
    checks = _Checks(path.parent, fields, region, library, is_reproducible(certificate.candidate))
    progress("exact results in fresh states")
    return Verification(tuple(checks.findings(states or fields.states, seed)))


def _model_from_text(text: str) -> System:
    """Return the system that the content of a model file describes."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "model.toml"
        file.write_text(text, encoding="utf-8")
        return load_model(file)


class _Checks:
    """The checks of one certificate.

    Args:
        folder: Folder of the certificate file.
        fields: Fields of the certificate.
        region: The states for which the certificate claims an error.
        library: The variant of the certificate, generated and built anew.
        reproducible: Whether the variant has the same bits from every compiler and on every machine.
    """

    def __init__(
        self, folder: Path, fields: CertificateFields, region: Region, library: Library, reproducible: bool
    ) -> None:
        self._folder, self._fields = folder, fields
        self._region, self._library = region, library
        self._reproducible = reproducible
        self._roundoff = unit_roundoff(library.source.variant)
        self._exact = ExactResults(region.system)

    def findings(self, states: int, seed: int) -> Iterator[Finding]:
        """Yield the findings of all checks.

        Args:
            states: Number of fresh states.
            seed: Seed of the fresh states.
        """
        yield self._source()
        yield from self._files_beside()
        yield self._results()
        yield from self._worst_states()
        yield self._fresh_states(states, seed)
        yield self._times()

    @cached_property
    def _differences(self) -> str:
        """Differences between this machine and that of the certificate, in words; "" if there are none."""
        now, then = built_with(self._library.source), self._fields.built_with
        return ", ".join(f"another {name}" for name in MACHINE if now[name] != then.get(name))

    @property
    def _may_differ(self) -> bool:
        """Whether other bits than those of the certificate are to be expected on this machine."""
        return bool(self._differences) and not self._reproducible

    def _source(self) -> Finding:
        """Compare the C that is generated now with that of the certificate."""
        now, then = source_digests(self._library.source), self._fields.source
        changed = sorted(name for name in {**now, **then} if now.get(name) != then.get(name))
        if changed:
            return Finding("source", False, f"generated anew, {', '.join(changed)} differs")
        return Finding("source", True, f"generated anew, {len(now)} files are the same to the last byte")

    def _files_beside(self) -> Iterator[Finding]:
        """Compare each C file in the folder of the certificate with the certificate."""
        for name, digest in self._fields.source.items():
            file = self._folder / name
            if file.is_file():
                same = hashlib.sha256(file.read_bytes()).hexdigest() == digest
                state = "unchanged" if same else "changed since"
                yield Finding(name, same, f"beside the certificate, {state}")

    def _results(self) -> Finding:
        """Compare the bits of the results with those of the certificate."""
        fields = self._fields
        digest = results_digest(self._region, self._library, fields.objective, fields.seed)
        if digest == fields.results_digest:
            return Finding("results", True, f"the same bits in {DIGEST_STATES} states")
        different = f"other bits in {DIGEST_STATES} states"
        if self._may_differ:
            return Finding("results", None, f"{different}, as it may be: {self._differences}")
        return Finding("results", False, different)

    def _worst_states(self) -> Iterator[Finding]:
        """Compare the errors in the worst states of the certificate with those that it names."""
        for worst in self._fields.worst:
            sample = sample_from_table(self._region.domain, worst.state)
            error = float(self._errors(sample)[0])
            tolerance = 2 * WIDTH * self._roundoff + 1e-9 * worst.error
            is_same = abs(error - worst.error) <= tolerance
            is_kept = self._may_differ and error <= self._fields.error
            found = f"error {error:.3g}, was {worst.error:.3g}"
            yield Finding(f"worst state of the {worst.part}", is_same or is_kept, found)

    def _fresh_states(self, states: int, seed: int) -> Finding:
        """Compare the errors in fresh states with the claim."""
        fields = self._fields
        errors = self._errors(
            sample_region(self._region, self._exact, states, random_stream(seed, "verify", 0))
        )
        exceeded = int(np.sum(~(errors <= fields.error)))
        is_refuted = exceedance_floor(exceeded, states, fields.alpha) > fields.share
        holds = not exceeded if fields.is_strict else not is_refuted
        found = f"{exceeded} of {states} fresh states exceed {fields.error:.3g}, the largest error is"
        return Finding("error", holds, f"{found} {errors.max():.3g}")

    def _times(self) -> Finding:
        """Return whether the times of the certificate apply to this machine; they are not measured again."""
        claim = f"{self._fields.time:.4g} ns for {self._fields.objective}"
        if self._differences:
            return Finding("times", None, f"{claim} says nothing here: {self._differences}")
        return Finding("times", None, f"{claim}, not measured again; processor and compiler are the same")

    def _errors(self, sample: Sample) -> Floats:
        """Return the (B,) normwise errors of the variant in a sample of B states."""
        return usable_errors(self._exact.errors(self._library, sample, self._fields.objective))
