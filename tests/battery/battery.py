"""Every subject of the battery, in the order of their numbers."""

from __future__ import annotations

from collections.abc import Iterator

from tests.battery import (
    angles,
    cancelling,
    chains,
    compiling,
    conservation,
    flags,
    fuzzing,
    gimbal,
    identities,
    invariances,
    lasting,
    literals,
    masses,
    mutations,
    passage,
    reproducibility,
    rounding,
    sanitizing,
    scaling,
    searching,
    sines,
    specialisation,
    stiffness,
    tiers,
)
from tests.battery.rows import SUBJECTS, Subject

MODULES = (
    chains,
    masses,
    gimbal,
    passage,
    angles,
    sines,
    scaling,
    specialisation,
    cancelling,
    flags,
    stiffness,
    lasting,
    conservation,
    identities,
    invariances,
    literals,
    compiling,
    reproducibility,
    sanitizing,
    fuzzing,
    searching,
    rounding,
    tiers,
    mutations,
)
"""Reading them has entered their subjects."""


def subjects() -> Iterator[Subject]:
    """By number."""
    for number in sorted(SUBJECTS, key=lambda name: int(name[1:])):
        yield SUBJECTS[number]
