"""Columns of entries of {y} that move several freedoms by couplings: sums of the columns of these.

Where couplings let one entry of {y} move several freedoms, their columns are added as soon as they have one
frame and one origin, so that no more columns pass inward than there are entries of {y}.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol, TypeVar

from sympy import Expr, S

from kanegen.recursion.columns import Column, RotationColumn
from kanegen.recursion.vectors import ZERO, add, scale
from kanegen.symbolic.definitions import Definitions


class HasPlaces(Protocol):
    """A column that entries of {y} cause."""

    @property
    def places(self) -> Mapping[int, Expr]:
        """Factors by place in {y}."""
        ...


AnyColumn = TypeVar("AnyColumn", bound=HasPlaces)

Parts = Sequence[tuple[Expr, AnyColumn]]
"""Columns about one origin and in one frame, each with a factor."""


def merged(
    columns: Sequence[AnyColumn], add_up: Callable[[int, Parts[AnyColumn]], AnyColumn]
) -> list[AnyColumn]:
    """Return columns about one origin, with those of the same entries of {y} added where this leaves fewer.

    Args:
        columns: Columns in one frame and about one origin.
        add_up: Function that returns the column of an entry of {y}, by its place and what it causes.
    """
    result: list[AnyColumn] = []
    for group in _groups(columns):
        places = sorted({place for col in group for place in col.places})
        if len(places) >= len(group):
            result += group
        else:
            result += [add_up(at, [(col.places.get(at, S.Zero), col) for col in group]) for at in places]
    return result


def rotation_sum(
    place: int, parts: Parts[Column], body: str, frame: str, definitions: Definitions
) -> RotationColumn:
    """Return the column of an entry of {y} that moves several freedoms.

    Args:
        place: Place of the entry in {y}.
        parts: The columns of the freedoms, each with the factor of the entry in its rate.
        body: Number of the body at which they have arrived.
        frame: Suffix of the names of quantities in the frame.
        definitions: Definitions that the intermediates are added to.
    """
    force = moment = ZERO
    for share, col in parts:
        force = add(force, scale(share, col.force))
        moment = add(moment, scale(share, col.whole_moment(definitions)))
    label = f"{body}y{place}"
    force = definitions.vector(f"F_{label}_{frame}", force)
    moment = definitions.vector(f"M_{label}_{frame}", moment)
    return RotationColumn(place, {place: S.One}, label, force, moment)


def _groups(columns: Sequence[AnyColumn]) -> list[list[AnyColumn]]:
    """Return columns in groups that have no entries of {y} in common, in the order of their first columns."""
    groups: list[list[AnyColumn]] = []
    for col in columns:
        linked = [
            group for group in groups if any(other.places.keys() & col.places.keys() for other in group)
        ]
        groups = [group for group in groups if group not in linked]
        groups.append([*(other for group in linked for other in group), col])
    return groups
