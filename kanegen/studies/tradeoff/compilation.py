"""Variants as compiled libraries; a variant that cannot be built is refused with the reason."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from kanegen import compiler, library
from kanegen.c import Source
from kanegen.errors import KanegenError
from kanegen.library import Library
from kanegen.model.system import System
from kanegen.options import Progress
from kanegen.studies.tradeoff.exact_results import OUTPUT
from kanegen.studies.tradeoff.variants import Candidate, Refusal

_COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)


@dataclass(frozen=True)
class CompiledVariant:
    """A variant as a compiled library.

    Attributes:
        candidate: The variant.
        library: The library of its forward dynamics.
    """

    candidate: Candidate
    library: Library

    @property
    def size(self) -> int:
        """Size of the shared library in bytes."""
        return self.library.path.stat().st_size

    @property
    def operations(self) -> int:
        """Number of operations of one evaluation; a sine and cosine count as one each."""
        return sum(self.library.source.operations.values()) - self.library.source.operations["prepare"]

    @property
    def fingerprint(self) -> tuple[str, ...]:
        """Compiler flags and C without comments; variants with the same fingerprint are the same program."""
        source = self.library.source
        names = sorted(name for name in source.files if name.endswith((".c", ".h")))
        return (*source.variant.flags, *(_COMMENT.sub("", source.files[name]) for name in names))


def compile_variants(
    system: System, candidates: Iterable[Candidate], progress: Progress
) -> tuple[list[CompiledVariant], list[Refusal]]:
    """Generate and compile candidates, several at a time.

    Args:
        system: The system whose forward dynamics they compute.
        candidates: The variants to compile.
        progress: Function that is called with the name of each stage.

    Returns:
        The compiled variants in the order of the candidates, and the refusals of the others.
    """
    sources: dict[Candidate, Source] = {}
    refused: list[Refusal] = []
    for candidate in candidates:
        progress(f"generating: {candidate.label}")
        try:
            sources[candidate] = generate_variant(system, candidate)
        except KanegenError as error:
            refused.append(Refusal(candidate.label, str(error)))
    progress(f"compiling {len(sources)} variants")
    with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
        futures = {candidate: pool.submit(library.load, source) for candidate, source in sources.items()}
    built: list[CompiledVariant] = []
    for candidate, future in futures.items():
        try:
            built.append(CompiledVariant(candidate, future.result()))
        except KanegenError as error:
            first_line, *_ = str(error).splitlines()
            refused.append(Refusal(candidate.label, first_line))
    return built, refused


def generate_variant(system: System, candidate: Candidate) -> Source:
    """Return the C of the forward dynamics of a system by one variant.

    Raises:
        OptionError, ModelError, SingularError: As `kanegen.generate`.
    """
    return compiler.generate(candidate.of(system), (OUTPUT,), tier=candidate.variant)
