"""Whether a certificate still holds: everything in it but the times is made and measured anew.

What was edited, or belongs to another model or version, is an error. What can be compared but differs is a
finding that does not hold.
"""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from kanegen.compiler import Progress, quiet
from kanegen.errors import BuildError, CertificateError, KanegenError
from kanegen.library import Library, load
from kanegen.measure.truth.certify import WIDTH
from kanegen.model.system import System
from kanegen.readers import load as load_model
from kanegen.studies.budget.certificate import (
    BITS,
    Evidence,
    bits,
    built_with,
    evidence,
    hashes,
    model_text,
    read,
)
from kanegen.studies.budget.confidence import exceedance_floor
from kanegen.studies.budget.region import Region, region
from kanegen.studies.budget.sampling import drawn, sample_from_table, stream
from kanegen.studies.budget.variant_evaluator import is_reproducible, normwise_errors
from kanegen.studies.tradeoff.compilation import generate_variant
from kanegen.studies.tradeoff.judge import Judge, unit


@dataclass(frozen=True)
class Verification:
    """What became of a certificate."""

    findings: tuple[Finding, ...]

    @property
    def passed(self) -> bool:
        """Whether nothing that was looked at has failed."""
        return all(finding.holds is not False for finding in self.findings)


def verify(
    path: Path,
    model: System | None = None,
    states: int | None = None,
    seed: int = 1,
    progress: Progress = quiet,
) -> Verification:
    """Make and measure anew what a certificate says.

    Args:
        path: The certificate; C that lies beside it is looked at as well.
        model: What it should be of; by default the model that it holds is believed.
        states: Fresh ones; by default as many as it was validated by.
        seed: Of the fresh states.
        progress: Told the name of each stage.

    Raises:
        BuildError: If there is no C compiler, or it fails.
        CertificateError: If the file is no certificate, was edited, or is of another model or version.
        ReadError: If it cannot be read.
    """
    certificate = read(path)
    progress("generating and building")
    try:
        said = evidence(certificate)
        if model is not None and model_text(model) != said.model_text:
            raise CertificateError(f"of another model than {model.name!r} as it is now. Generate it anew.")
        box = region(_model(said.model_text), said.domain)
        library = load(generate_variant(box.system, certificate.candidate))
    except BuildError:
        raise
    except KanegenError as error:
        raise CertificateError(f"{path}: {error}") from None
    checks = Checks(path.parent, said, box, library, is_reproducible(certificate.candidate))
    progress("exact results in fresh states")
    return Verification(tuple(checks.findings(states or said.states, seed)))


def _model(text: str) -> System:
    """The system in the text of a model file."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "model.toml"
        file.write_text(text, encoding="utf-8")
        return load_model(file)


MACHINE = ("processor", "compiler", "libc")
"""What the times depend on and, for what is not strict, the results."""


@dataclass(frozen=True)
class Finding:
    """One thing that a certificate says.

    Attributes:
        what: Of what it speaks.
        holds: Whether it still does; None where that was not, or cannot be, looked at.
        words: What was found.
    """

    what: str
    holds: bool | None
    words: str


class Checks:
    """The findings about one certificate.

    Args:
        folder: Where it lies.
        said: What it says.
        region: Its states.
        library: Its variant, generated and built anew.
        reproducible: Whether this has the same bits from every compiler and on every machine.
    """

    def __init__(
        self, folder: Path, said: Evidence, region: Region, library: Library, reproducible: bool
    ) -> None:
        self._folder, self._said = folder, said
        self._region, self._library = region, library
        self._reproducible = reproducible
        self._roundoff = unit(library.source.variant)
        self._judge = Judge(region.system)

    def findings(self, states: int, seed: int) -> Iterator[Finding]:
        """All of them.

        Args:
            states: Fresh ones.
            seed: Of these.
        """
        yield self._source()
        yield from self._beside()
        yield self._bits()
        yield from self._worst()
        yield self._fresh(states, seed)
        yield self._times()

    @cached_property
    def _elsewhere(self) -> str:
        """What differs from where the certificate was made."""
        now, then = built_with(self._library.source), self._said.built_with
        return ", ".join(f"another {what}" for what in MACHINE if now[what] != then.get(what))

    def _source(self) -> Finding:
        now, then = hashes(self._library.source), self._said.source
        changed = sorted(name for name in {**now, **then} if now.get(name) != then.get(name))
        if changed:
            return Finding("source", False, f"generated anew, {', '.join(changed)} differs")
        return Finding("source", True, f"generated anew, {len(now)} files are the same to the last byte")

    def _beside(self) -> Iterator[Finding]:
        """The C in the folder of the certificate, where there is any."""
        for name, digest in self._said.source.items():
            file = self._folder / name
            if file.is_file():
                same = hashlib.sha256(file.read_bytes()).hexdigest() == digest
                yield Finding(
                    name, same, f"beside the certificate, {'unchanged' if same else 'changed since'}"
                )

    def _bits(self) -> Finding:
        if bits(self._region, self._library, self._said.objective, self._said.seed) == self._said.bits:
            return Finding("results", True, f"the same bits in {BITS} states")
        if self._elsewhere and not self._reproducible:
            return Finding("results", None, f"other bits in {BITS} states, as it may be: {self._elsewhere}")
        return Finding("results", False, f"other bits in {BITS} states")

    def _worst(self) -> Iterator[Finding]:
        """The errors in the worst states that the certificate knows."""
        for what, error, state in self._said.worst:
            sample = sample_from_table(self._region.domain, state)
            found = float(normwise_errors(self._judge, self._library, sample, self._said.objective)[0])
            same = abs(found - error) <= 2 * WIDTH * self._roundoff + 1e-9 * error
            may_differ = bool(self._elsewhere) and not self._reproducible and found <= self._said.error
            words = f"error {found:.3g}, was {error:.3g}"
            yield Finding(f"worst state of the {what}", same or may_differ, words)

    def _fresh(self, states: int, seed: int) -> Finding:
        sample = drawn(self._region, self._judge, states, stream(seed, "verify", 0))
        errors = normwise_errors(self._judge, self._library, sample, self._said.objective)
        exceeded = int(np.sum(~(errors <= self._said.error)))
        refuted = exceedance_floor(exceeded, states, self._said.alpha) > self._said.share
        holds = not exceeded if self._said.is_strict else not refuted
        words = f"{exceeded} of {states} fresh states exceed {self._said.error:.3g}, the largest error is"
        return Finding("error", holds, f"{words} {errors.max():.3g}")

    def _times(self) -> Finding:
        said = f"{self._said.time:.4g} ns for {self._said.objective}"
        if self._elsewhere:
            return Finding("times", None, f"{said} says nothing here: {self._elsewhere}")
        return Finding("times", None, f"{said}, not measured again; processor and compiler are the same")
