"""What a certificate is about, so that it is recognised when made anew: model, source, compiler, results."""

from __future__ import annotations

import hashlib
import platform
from pathlib import Path
from typing import Any

from kanegen.c import Source
from kanegen.library import Library
from kanegen.measure import machine
from kanegen.model.system import System
from kanegen.model.toml_text import toml_text
from kanegen.studies.budget import evaluating
from kanegen.studies.budget.region import Region
from kanegen.studies.budget.sampling import stream

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
    return evaluating.bits(library, sample, objective)
