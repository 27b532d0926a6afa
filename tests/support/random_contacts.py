"""Random contacts of random systems: points and frames, held in all or some directions, some with damping."""

from __future__ import annotations

import numpy as np

import kanegen as kg
from kanegen.reference.independence import dependent_rows

TRIES = 4
"""Number of contacts that are drawn; those whose directions depend on others are left out."""

MOST = 2
"""Largest number of contacts of a system."""


def with_contacts(system: kg.System, rng: np.random.Generator) -> kg.System:
    """Return the system with one contact or two, whose directions without damping are independent."""
    found: list[kg.Contact] = []
    for i in range(TRIES):
        contact = _contact(system, rng, f"contact{i}")
        if len(found) < MOST and not dependent_rows(system.with_contacts([*found, contact])):
            found.append(contact)
    return system.with_contacts(found or _contact(system, rng, "damped", damping=0.7))


def _contact(
    system: kg.System, rng: np.random.Generator, name: str, damping: float | None = None
) -> kg.Contact:
    frames = [name for name in system.frame_names if system.frame(name).body]
    place = str(rng.choice([*system.point_names, *frames]))
    is_frame = place in frames and rng.random() < 0.5
    contact = kg.Contact(name, frame=place) if is_frame else kg.Contact(name, point=place)
    directions = None
    if rng.random() < 0.6:
        chosen = rng.permutation(contact.possible)[: int(rng.integers(1, 3))]
        directions = tuple(map(str, chosen))
    value = float(rng.uniform(0.2, 1.0))
    drawn = (0.0, 0.0, value, kg.Parameter(f"{name}_damping", value))[int(rng.integers(4))]
    return kg.Contact(
        name,
        point=contact.point,
        frame=contact.frame,
        directions=directions,
        damping=drawn if damping is None else damping,
    )
