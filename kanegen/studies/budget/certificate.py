"""The certificate beside the C: the request, its result, and all that is needed to reproduce the result.

A certificate is a JSON file. Its first line has the provenance of a generated file (`c.folder`), so that
an edited file is recognised. `Certificate` is the content of a file; `Given` are the parts from which
a verification derives all others. The fingerprints at the end identify the model, the C files, the
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
from kanegen.c.provenance import is_unchanged
from kanegen.errors import CertificateError, KanegenError, quoted
from kanegen.library import Library
from kanegen.measure.machine import Machine
from kanegen.model.saving import toml_text
from kanegen.model.system import System
from kanegen.options import Variant
from kanegen.readers.reader import read_text
from kanegen.studies.budget.region import Region
from kanegen.studies.budget.sampling import random_stream
from kanegen.studies.tradeoff.domain import Sample
from kanegen.studies.tradeoff.exact_results import compute_accelerations
from kanegen.studies.tradeoff.variants import Candidate

KIND = "error and time of one variant of one model"
"""The kind of a certificate file, which distinguishes it from other JSON files."""

FORMAT = 2
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
        content = json.loads(text, object_pairs_hook=_without_duplicates)
    except (ValueError, RecursionError) as error:
        raise CertificateError(f"{path}: not a certificate: it is not valid JSON: {error}.") from None
    if not isinstance(content, dict) or content.get("kind") != KIND:
        raise CertificateError(f"{path}: not a certificate of kanegen.")
    if content.get("format") != FORMAT or content.get("generator") != __version__:
        raise CertificateError(
            f"{path}: made by kanegen {content.get('generator')} in format {content.get('format')}, this is "
            f"{__version__} with format {FORMAT}. Verify it with that version, or generate the model anew."
        )
    if not is_unchanged(text):
        raise CertificateError(f"{path}: edited since kanegen wrote it. Generate the model anew.")
    return Certificate(content)


def _without_duplicates(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Return a JSON object; of two values with one key, a reader sees the first and a program the last."""
    content = dict(pairs)
    if len(content) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"the key {quoted(twice)} occurs twice in one object")
    return content


@dataclass(frozen=True)
class Given:
    """What a certificate is about, from which its statements can be derived.

    Attributes:
        model_text: Content of the model file.
        domain: Table of the region (`budget.region`).
        request: Table of the request (`budget.statements`).
        attempt: Number of the attempt in which the variant was validated, counted from 1.
        worst: The worst states that the validation and the search found, by the name of the section: the
            error, and the state in the form of `sampling.state_table`.
    """

    model_text: str
    domain: Mapping[str, Any]
    request: Mapping[str, Any]
    attempt: int
    worst: Mapping[str, tuple[float, Mapping[str, Any]]]


def given(certificate: Certificate) -> Given:
    """Return what a certificate is about.

    Raises:
        CertificateError: If a field is missing or has another type.
    """
    section = certificate.section
    try:
        worst = {name: section(name)["worst"] for name in ("validation", "search")}
        return Given(
            model_text=str(section("model")["text"]),
            domain=dict(section("domain")),
            request=dict(section("request")),
            attempt=int(section("validation")["attempts"]["made"]),
            worst={name: (float(part["error"]), dict(part["state"])) for name, part in worst.items()},
        )
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        raise CertificateError(f"not a certificate of this version: {error!r}.") from None


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


def built_with() -> dict[str, str]:
    """Return the compiler, the processor and the C library of this machine, by name."""
    machine = Machine.here()
    return {
        "compiler": machine.compiler,
        "processor": f"{machine.processor}, {machine.system}",
        "libc": machine.libc,
    }


def results_digest(region: Region, library: Library, objective: str, seed: int) -> str:
    """Return the fingerprint of a region and of the results in fixed states of its box."""
    rows = region.domain.uniform(DIGEST_STATES, random_stream(seed, "bits", 0))
    table = json.dumps(region.as_table(), sort_keys=True).encode()
    return hashlib.sha256(
        table + _bytes_of_results(library, region.domain.states(rows), objective)
    ).hexdigest()


def _bytes_of_results(library: Library, sample: Sample, objective: str) -> bytes:
    """Return the bits of all results; all NaN count as one number.

    Numbers longer than a double count as the nearest double and the rest, because their bytes have gaps.
    """
    values = compute_accelerations(library, sample, objective).copy()
    values[np.isnan(values)] = np.nan
    parts = [values]
    if values.dtype.itemsize > np.dtype(np.float64).itemsize:
        near = values.astype(np.float64)
        parts = [near, (values - near).astype(np.float64)]
    return b"".join(np.ascontiguousarray(part).tobytes() for part in parts)
