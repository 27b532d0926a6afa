"""The certificate beside the C: the request, its result, and all that is needed to reproduce the result.

A certificate is a JSON file. Its first line has the provenance of a generated file (`c.folder`), so that
an edited file is recognised. `Certificate` is the content of a file; `CertificateFields` are the parts that a
verification reads, with their types. The fingerprints at the end identify the model, the C files, the
compiler and the results of a variant, so that they are recognised when they are made anew.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from kanegen import __version__
from kanegen.c import Source
from kanegen.c.folder import is_unchanged
from kanegen.errors import CertificateError, KanegenError
from kanegen.library import Library
from kanegen.measure.machine import Machine
from kanegen.measure.timing import OBJECTIVES
from kanegen.model.saving import toml_text
from kanegen.model.system import System
from kanegen.options import Variant
from kanegen.readers.reader import read_text
from kanegen.studies.budget.region import Region
from kanegen.studies.budget.request import SHARE
from kanegen.studies.budget.sampling import random_stream
from kanegen.studies.tradeoff.domain import Sample
from kanegen.studies.tradeoff.exact_results import compute_accelerations
from kanegen.studies.tradeoff.variants import Candidate

KIND = "error and time of one variant of one model"
"""The kind of a certificate file, which distinguishes it from other JSON files."""

FORMAT = 1
"""Version of the format of a certificate file."""

DIGEST_STATES = 1000
"""Number of states whose results are part of the fingerprint of the results."""


@dataclass(frozen=True)
class Certificate:
    """The content of a certificate file.

    Attributes:
        content: The sections as plain data, in the form that `certification` writes.
    """

    content: Mapping[str, Any]

    def section(self, name: str) -> Any:
        """Return the section of this name.

        Raises:
            CertificateError: If the certificate has no such section.
        """
        if name not in self.content:
            raise CertificateError(f"it has no section {name!r}. Generate the model anew.")
        return self.content[name]

    @property
    def candidate(self) -> Candidate:
        """The variant that was chosen.

        Raises:
            CertificateError: If this version of kanegen has no such variant.
        """
        choices = self.section("variant")
        try:
            fields: dict[str, Any] = {n: tuple(v) if isinstance(v, list) else v for n, v in choices.items()}
            return Candidate(Variant(**fields))
        except (AttributeError, TypeError, KanegenError) as error:
            raise CertificateError(f"its variant is unknown: {error}") from None


def read_certificate(path: Path) -> Certificate:
    """Return the certificate in a file.

    Raises:
        CertificateError: If the file is no certificate, was edited, or comes from another version of kanegen;
            names the file.
        ReadError: If the file does not exist or is not text.
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
class WorstState:
    """The state with the largest error that one part of a certification found.

    Attributes:
        part: Name of this part, "validation" or "search".
        error: The error in the state.
        state: The state, in the form of `sampling.state_table`.
    """

    part: str
    error: float
    state: Mapping[str, Any]


@dataclass(frozen=True)
class CertificateFields:
    """The fields of a certificate that a verification needs, with the types that they must have.

    Attributes:
        model_text: Content of the model file.
        domain: Table of the region (`budget.region`).
        source: SHA-256 of every C file, by its name.
        built_with: Compiler, flags and machine.
        objective: The time that was measured, one of `OBJECTIVES`.
        error: The error that is claimed.
        is_strict: Whether no tried state may exceed it.
        share: Share of the domain that may exceed it.
        alpha: Probability of a wrong claim that the successful attempt may have.
        states: Number of states by which it was validated.
        seed: Seed of all samples.
        results_digest: Fingerprint of the results.
        worst: The worst states that the validation and the search found.
        time: Median time of one evaluation (ns).
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
    results_digest: str
    worst: tuple[WorstState, ...]
    time: float


def certificate_fields(certificate: Certificate) -> CertificateFields:
    """Return the fields of a certificate that a verification needs.

    Raises:
        CertificateError: If a field is missing, has another type, or is out of range.
    """
    section = certificate.section
    try:
        claim, validation, search = section("claim"), section("validation"), section("search")
        holds_everywhere = claim["quantile"] == "max"
        fields = CertificateFields(
            model_text=str(section("model")["text"]),
            domain=dict(section("domain")),
            source=dict(section("source")),
            built_with=dict(section("built_with")),
            objective=claim["objective"],
            error=float(claim["error"]),
            is_strict=holds_everywhere and section("request")["error"] is not None,
            share=SHARE if holds_everywhere else 1 - float(claim["quantile"]),
            alpha=float(validation["alpha"]),
            states=int(validation["states"]),
            seed=int(section("request")["seed"]),
            results_digest=str(section("bits")["sha256"]),
            worst=tuple(
                WorstState(name, float(part["worst"]["error"]), dict(part["worst"]["state"]))
                for name, part in (("validation", validation), ("search", search))
            ),
            time=float(section("times")["median"]),
        )
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        raise CertificateError(f"not a certificate of this version: {error!r}.") from None
    in_range = fields.objective in OBJECTIVES and fields.seed >= 0 and fields.states > 0 and fields.error > 0
    if not in_range or any(Path(name).name != name for name in fields.source):
        raise CertificateError("not a certificate of this version: a value is out of range.")
    return fields


def variant_table(variant: Variant) -> dict[str, Any]:
    """Return a variant as the table from which `Certificate.candidate` reads it."""
    return {name: list(value) if isinstance(value, tuple) else value for name, value in vars(variant).items()}


def model_text(model: System) -> str:
    """Return the content of the model file of a system, the fingerprint of the model."""
    return toml_text(model.as_table())


def source_digests(source: Source) -> dict[str, str]:
    """Return the SHA-256 of every C file and header, by its name."""
    return {
        name: hashlib.sha256(text.encode()).hexdigest()
        for name, text in sorted(source.files.items())
        if Path(name).suffix in (".c", ".h")
    }


def built_with(source: Source) -> dict[str, Any]:
    """Return the compiler, its flags, the processor and the C library of this machine, by name."""
    machine = Machine.here()
    return {
        "compiler": machine.compiler,
        "flags": list(source.variant.flags),
        "processor": f"{machine.processor}, {machine.system}",
        "libc": machine.libc,
    }


def results_digest(region: Region, library: Library, objective: str, seed: int) -> str:
    """Return the fingerprint of the results in fixed states of the box of a region.

    The states that a region excludes from its box do not matter here.
    """
    rows = region.domain.uniform(DIGEST_STATES, random_stream(seed, "bits", 0))
    return _digest_of_results(library, region.domain.states(rows), objective)


def _digest_of_results(library: Library, sample: Sample, objective: str) -> str:
    """Return the SHA-256 of the bits of all results; all NaN count as one number.

    Numbers longer than a double count as the nearest double and the rest, because their bytes have gaps.
    """
    values = compute_accelerations(library, sample, objective).copy()
    values[np.isnan(values)] = np.nan
    parts = [values]
    if values.dtype.itemsize > np.dtype(np.float64).itemsize:
        near = values.astype(np.float64)
        parts = [near, (values - near).astype(np.float64)]
    return hashlib.sha256(b"".join(np.ascontiguousarray(part).tobytes() for part in parts)).hexdigest()
