"""The class of products: a name, a sentence for users, and a function from a source to bytes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from kanegen.c.source import Source
from kanegen.products.platforms import Platform

Platforms = tuple[Platform, ...]
"""The platforms on which a file is to run."""


@dataclass(frozen=True)
class CompiledFile:
    """A file that a compiler makes of a source.

    Attributes:
        name: Name of the product, as users write it. An artifact of the same name, if there is one, has the
            texts that go into the file, and the outputs that a source needs.
        summary: Purpose of the file, in one sentence.
        file: Function from a source to the name of the file.
        make: Function from a source and platforms to the bytes of the file.
        require_tools: Function that raises `BuildError` where a tool for the platforms is missing; it is
            called before anything else is done.
        folder: Folder below that of the C in which the file stands beside the texts of the artifact, "" for
            that of the C.
        has_platforms: Whether the file holds code for processors and operating systems. One without is the
            same everywhere, and its functions are given no platforms.
    """

    name: str
    summary: str
    file: Callable[[Source], str]
    make: Callable[[Source, Platforms], bytes]
    require_tools: Callable[[Platforms], object]
    folder: str = ""
    has_platforms: bool = True
