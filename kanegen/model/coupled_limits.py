"""Limits of coupled freedoms, as limits of the freedoms that they follow.

A coupled freedom with x = a x_i + b stays within its limits where x_i is between (lower - b)/a and
(upper - b)/a, and |y_i| is at most its largest speed over |a|. Where it follows several freedoms, or one
whose motion is prescribed, its limits are no ranges of single coordinates; `SystemLimits.not_kept` names it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from kanegen.model.coordinates import Coordinate, Freedom
from kanegen.model.coupling import values_of
from kanegen.model.limits import SystemLimits
from kanegen.model.system_coordinates import SystemCoordinates

_Line = tuple[dict[Freedom, float], float]
"""Factors of the free and prescribed freedoms that a freedom follows, and its value where all are zero."""


def with_coupled_limits(limits: SystemLimits, system: SystemCoordinates) -> SystemLimits:
    """Return limits within which coupled freedoms stay within their own, to rounding.

    The limits of the efforts are those of the free freedoms alone. Limits of a coupled freedom that leave no
    motion, together with those of the freedom that it follows, are not kept.

    Args:
        limits: The limits of the free freedoms, in the order of {x} and {y}.
        system: The bodies and their couplings, parameters at their defaults.
    """
    lower, upper, speed = limits.lower.copy(), limits.upper.copy(), limits.speed.copy()
    not_kept = []
    for name, (freedom, (terms, offset)) in zip(system.coupled_names, _lines(system), strict=True):
        own = system.bodies[freedom.body - 1].joint.limits
        ends = (own.lower[freedom.index], own.upper[freedom.index])
        fastest = own.speed[freedom.index]
        if not any(map(math.isfinite, (*ends, fastest))):
            continue
        followed = [one for one in terms if one in system.places]
        if len(terms) != 1 or not followed:
            not_kept.append(name)
            continue
        leader, factor = followed[0], terms[followed[0]]
        x, y = system.coordinate_places[Coordinate(leader.body, leader.index)], system.places[leader]
        low, high = sorted((end - offset) / factor for end in ends)
        low, high = max(low, lower[x]), min(high, upper[x])
        if low >= high:
            not_kept.append(name)
            continue
        lower[x], upper[x], speed[y] = low, high, min(speed[y], fastest / abs(factor))
    return replace(limits, lower=lower, upper=upper, speed=speed, not_kept=tuple(not_kept))


def _lines(system: SystemCoordinates) -> Iterator[tuple[Freedom, _Line]]:
    """Yield each coupled freedom as a linear function of freedoms that are not coupled."""
    found: dict[Freedom, _Line] = {}
    for one in values_of(system.coupled):
        terms: dict[Freedom, float] = {}
        offset = one.offset
        for other, factor in one.terms:
            inner, constant = found.get(other, ({other: 1.0}, 0.0))
            offset += factor * constant
            for freedom, share in inner.items():
                terms[freedom] = terms.get(freedom, 0.0) + factor * share
        found[one.freedom] = ({freedom: total for freedom, total in terms.items() if total}, offset)
        yield one.freedom, found[one.freedom]
