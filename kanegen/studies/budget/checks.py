"""What is looked at to see whether a certificate still holds."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from kanegen.library import Library
from kanegen.measure.truth.certify import WIDTH
from kanegen.studies.budget import evaluating, worst
from kanegen.studies.budget.certificate_fields import Evidence
from kanegen.studies.budget.confidence import exceedance_floor
from kanegen.studies.budget.fingerprint import BITS, bits, built_with, hashes
from kanegen.studies.budget.region import Region
from kanegen.studies.budget.sampling import drawn, stream
from kanegen.studies.tradeoff.judge import Judge, unit

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
            sample = worst.sample_of(self._region.domain, state)
            found = float(evaluating.errors(self._judge, self._library, sample, self._said.objective)[0])
            same = abs(found - error) <= 2 * WIDTH * self._roundoff + 1e-9 * error
            may_differ = bool(self._elsewhere) and not self._reproducible and found <= self._said.error
            words = f"error {found:.3g}, was {error:.3g}"
            yield Finding(f"worst state of the {what}", same or may_differ, words)

    def _fresh(self, states: int, seed: int) -> Finding:
        sample = drawn(self._region, self._judge, states, stream(seed, "verify", 0))
        errors = evaluating.errors(self._judge, self._library, sample, self._said.objective)
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
