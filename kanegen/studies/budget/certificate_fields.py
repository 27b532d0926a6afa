"""What a verification needs of a certificate."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kanegen.errors import CertificateError
from kanegen.studies.budget.certificate import Certificate
from kanegen.studies.budget.request import OBJECTIVES, SHARE


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
