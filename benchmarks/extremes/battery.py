"""Every subject of the battery, in the order of their numbers."""

from __future__ import annotations

from collections.abc import Iterator

from benchmarks.extremes import (
    angles,
    cancelling,
    chains,
    flags,
    gimbal,
    identities,
    invariances,
    literals,
    masses,
    mutations,
    reproducibility,
    scaling,
    specialisation,
)
from benchmarks.extremes.rows import SUBJECTS, Subject

MODULES = (
    chains,
    masses,
    gimbal,
    angles,
    scaling,
    specialisation,
    cancelling,
    flags,
    identities,
    invariances,
    literals,
    reproducibility,
    mutations,
)
"""Reading them has entered their subjects."""


def subjects() -> Iterator[Subject]:
    """By number."""
    for number in sorted(SUBJECTS, key=lambda name: int(name[1:])):
        yield SUBJECTS[number]
