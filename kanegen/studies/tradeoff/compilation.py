"""Variants become compiled libraries; those that cannot are refused with the reason."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

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
    """A candidate as compiled code."""

    candidate: Candidate
    library: Library

    @property
    def file(self) -> Path:
        """The shared library."""
        return self.library.path

    @property
    def size(self) -> int:
        """Bytes of the shared library."""
        return self.file.stat().st_size

    @property
    def operations(self) -> int:
        """Operations of one evaluation, sines and cosines counted as one each."""
        return sum(self.library.source.operations.values()) - self.library.source.operations["prepare"]

    @property
    def fingerprint(self) -> tuple[str, ...]:
        """What the machine code depends on: variants with the same one are the same program."""
        source = self.library.source
        return (*source.variant.flags, *_code(source))


def compile_variants(
    system: System, candidates: Iterable[Candidate], progress: Progress
) -> tuple[list[CompiledVariant], list[Refusal]]:
    """Every candidate compiled, in order, and the others with the reason.

    Args:
        system: The tree.
        candidates: What to compile.
        progress: Told the name of each stage.
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
            refused.append(Refusal(candidate.label, _first_line(str(error))))
    return built, refused


def generate_variant(system: System, candidate: Candidate) -> Source:
    """The C of a candidate.

    Raises:
        OptionError, ModelError, SingularError: As `kanegen.generate`.
    """
    return compiler.generate(candidate.of(system), (OUTPUT,), tier=candidate.variant)


def _code(source: Source) -> list[str]:
    """The C without its comments."""
    names = sorted(name for name in source.files if name.endswith((".c", ".h")))
    return [_COMMENT.sub("", source.files[name]) for name in names]


def _first_line(text: str) -> str:
    """Of the words of a compiler, which may be many."""
    return text.splitlines()[0]
