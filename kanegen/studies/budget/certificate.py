"""The record that goes beside the C: what was asked, what was found, and all that it takes to find it again.

It is a JSON file. Its first line is the stamp of a generated file (`c.stamp`), so an edited one is known.
"""

from __future__ import annotations

import hashlib
import json
import platform
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from kanegen import __version__
from kanegen.c import Source
from kanegen.c.provenance import is_unchanged, stamped
from kanegen.errors import CertificateError, KanegenError
from kanegen.library import Library
from kanegen.measure import machine
from kanegen.measure.timing import OBJECTIVES
from kanegen.model.system import System
from kanegen.model.toml_text import toml_text
from kanegen.options import Variant
from kanegen.readers.text import read_text
from kanegen.studies.budget.region import Region
from kanegen.studies.budget.request import SHARE
from kanegen.studies.budget.sampling import stream
from kanegen.studies.tradeoff.judge import computed
from kanegen.studies.tradeoff.samples import Sample
from kanegen.studies.tradeoff.variants import Candidate

KIND = "error and time of one variant of one model"
FORMAT = 1

SUFFIX = "_certificate.json"
"""What the name of the file ends in, after that of the model."""

Table = Mapping[str, Any]


@dataclass(frozen=True)
class Certificate:
    """What a certificate file holds; `content` is all of it as plain data.

    Attributes:
        content: By section, see `certified.certified`.
    """

    content: Table

    def text(self, name: str) -> str:
        """The file of this name."""
        return stamped(name, json.dumps(self.content, indent=2, allow_nan=False).removeprefix("{\n") + "\n")

    def section(self, name: str) -> Any:
        """One section.

        Raises:
            CertificateError: If it is missing.
        """
        if name not in self.content:
            raise CertificateError(f"it has no section {name!r}. Generate the model anew.")
        return self.content[name]

    @property
    def candidate(self) -> Candidate:
        """The variant that was chosen.

        Raises:
            CertificateError: If this version knows no such variant.
        """
        choices = self.section("variant")
        try:
            fields: dict[str, Any] = {n: tuple(v) if isinstance(v, list) else v for n, v in choices.items()}
            return Candidate(Variant(**fields))
        except (AttributeError, TypeError, KanegenError) as error:
            raise CertificateError(f"its variant is none: {error}") from None


def variant_table(variant: Variant) -> dict[str, Any]:
    """A variant as `Certificate.candidate` reads it."""
    return {name: list(value) if isinstance(value, tuple) else value for name, value in vars(variant).items()}


def read(path: Path) -> Certificate:
    """The certificate in a file.

    Raises:
        CertificateError: If it is none, was edited, or comes from another version; names the file.
        ReadError: If there is no such file, or it is not text.
    """
    text = read_text(path)
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise CertificateError(f"{path}: not a certificate: it is not valid JSON: {error}.") from None
    if not isinstance(content, dict) or content.get("kind") != KIND:
        raise CertificateError(f"{path}: not a certificate of kanegen.")
    if content.get("format") != FORMAT or content.get("generator") != __version__:
        raise CertificateError(
            f"{path}: made by kanegen {content.get('generator')}, this is {__version__}. Verify it with that "
            "version, or generate the model anew."
        )
    if not is_unchanged(text):
        raise CertificateError(f"{path}: edited since kanegen wrote it. Generate the model anew.")
    return Certificate(content)


@dataclass(frozen=True)
class Evidence:
    """Parts of a certificate, with the types that they must have.

    Attributes:
        model_text: The model file.
        domain: Table of the region.
        source: SHA-256 of the C by the name of the file.
        built_with: Compiler, flags and machine.
        objective: What was timed and judged.
        error: That is claimed.
        is_strict: Whether it was asked for in every state that is tried.
        share: Of the domain that may exceed it.
        alpha: Of the attempt that succeeded.
        states: By which it was validated.
        seed: Of all samples.
        bits: Digest of results.
        worst: The worst states: of what, with what error, and their numbers.
        time: Median, ns.
    """

    model_text: str
    domain: Mapping[str, Any]
    source: Mapping[str, str]
    built_with: Mapping[str, Any]
    objective: str
    error: float
    is_strict: bool
    share: float
    alpha: float
    states: int
    seed: int
    bits: str
    worst: tuple[tuple[str, float, Mapping[str, Any]], ...]
    time: float


def evidence(certificate: Certificate) -> Evidence:
    """The parts of a certificate.

    Raises:
        CertificateError: If one is missing or of another type.
    """
    section = certificate.section
    try:
        claim, validation, search = section("claim"), section("validation"), section("search")
        everywhere = claim["quantile"] == "max"
        found = Evidence(
            model_text=str(section("model")["text"]),
            domain=dict(section("domain")),
            source=dict(section("source")),
            built_with=dict(section("built_with")),
            objective=claim["objective"],
            error=float(claim["error"]),
            is_strict=everywhere and section("request")["error"] is not None,
            share=SHARE if everywhere else 1 - float(claim["quantile"]),
            alpha=float(validation["alpha"]),
            states=int(validation["states"]),
            seed=int(section("request")["seed"]),
            bits=str(section("bits")["sha256"]),
            worst=tuple(
                (what, float(part["worst"]["error"]), dict(part["worst"]["state"]))
                for what, part in (("validation", validation), ("search", search))
            ),
            time=float(section("times")["median"]),
        )
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        raise CertificateError(f"not a certificate of this version: {error!r}.") from None
    numbers = found.objective in OBJECTIVES and found.seed >= 0 and found.states > 0 and found.error > 0
    if not numbers or any(Path(name).name != name for name in found.source):
        raise CertificateError("not a certificate of this version: something in it makes no sense.")
    return found


BITS = 1000
"""States whose results are hashed."""


def model_text(model: System) -> str:
    """A model as a model file has it."""
    return toml_text(model.as_table())


def hashes(source: Source) -> dict[str, str]:
    """SHA-256 of every file that is compiled or included, by name."""
    return {
        name: hashlib.sha256(text.encode()).hexdigest()
        for name, text in sorted(source.files.items())
        if Path(name).suffix in (".c", ".h")
    }


def built_with(source: Source) -> dict[str, Any]:
    """Compiler, flags and processor."""
    processor, compiler, *_ = machine.description()
    return {
        "compiler": compiler,
        "flags": list(source.variant.flags),
        "processor": processor,
        "libc": " ".join(platform.libc_ver()),
    }


def bits(region: Region, library: Library, objective: str, seed: int) -> str:
    """The digest of results in fixed states of the box; what is excluded from it does not matter here."""
    sample = region.domain.states(region.domain.uniform(BITS, stream(seed, "bits", 0)))
    return result_digest(library, sample, objective)


def result_digest(library: Library, sample: Sample, objective: str) -> str:
    """A digest of the results to the last bit; all NaN count as one.

    Numbers longer than a double count as the nearest double and the rest, because their bytes have gaps.
    """
    values = computed(library, sample, objective).copy()
    values[np.isnan(values)] = np.nan
    parts = [values]
    if values.dtype.itemsize > np.dtype(np.float64).itemsize:
        near = values.astype(np.float64)
        parts = [near, (values - near).astype(np.float64)]
    return hashlib.sha256(b"".join(np.ascontiguousarray(part).tobytes() for part in parts)).hexdigest()
