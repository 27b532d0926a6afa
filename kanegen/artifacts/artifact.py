"""The class of artifacts: a name, a sentence for users, and a function from a source to files."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from kanegen.c.source import Source


def _never(source: Source) -> str:
    """Return the refusal of an artifact that can stand beside every source: none."""
    return ""


@dataclass(frozen=True)
class Artifact:
    """Optional files beside generated code, for one kind of user.

    Attributes:
        name: Name of the artifact, as users write it.
        summary: Purpose of the artifact, in one sentence.
        files: Function from a source to the text of each file by name, without the line of provenance.
        refusal: Function from a source to the reason why the source cannot have this artifact, "" if it can.
        is_default: Whether every source that can have the artifact gets it.
    """

    name: str
    summary: str
    files: Callable[[Source], Mapping[str, str]]
    refusal: Callable[[Source], str] = _never
    is_default: bool = False
