"""States where arithmetic is hardest, drawn on purpose: a uniform sample hardly ever meets them.

Each stratum changes uniform rows, so that everything else of a state stays ordinary. The result is brought
back into the box, and rows that come too near to gimbal lock are left out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from kanegen.model.arrays import Floats
from kanegen.model.freedoms import QUATERNION
from kanegen.reference import equations as reference
from kanegen.studies.tradeoff.domain import Domain
from kanegen.studies.tradeoff.samples import Sample, joined

LOCK = "next to gimbal lock"
STRAIGHT = "folded or straight"
EQUILIBRIUM = "near equilibrium"

_NEAREST = 4.0
"""Powers of ten up to which a stratum approaches what it is named after."""


def hard_states(domain: Domain, count: int, seed: int | Sequence[int]) -> Sample | None:
    """Up to `count` states of each stratum that the system has; None where there are none.

    Args:
        domain: To draw from.
        count: Of states of each.
        seed: Of the generator.
    """
    found = []
    for name, changed in STRATA.items():
        rng = np.random.default_rng([*np.atleast_1d(seed), list(STRATA).index(name)])
        sample = domain.states(changed(domain, domain.uniform(count, rng), rng), name)
        found += [sample[k : k + 1] for k in range(len(sample)) if domain.contains(sample[k : k + 1])]
    return joined(found) if found else None


def _next_to_lock(domain: Domain, rows: Floats, rng: np.random.Generator) -> Floats:
    """About half of the second angles at a small distance from where their joints lock."""
    if not domain.locking:
        return rows[:0]
    shape = (len(rows), len(domain.locking))
    places, locks = list(domain.locking), np.array(list(domain.locking.values()))
    angles = locks - rng.choice([0.0, 1.0], shape) * np.pi + _small(rng, shape)
    near = rng.random(shape) < 0.5
    near[np.arange(len(rows)), rng.integers(0, shape[1], len(rows))] = True
    rows[:, places] = np.where(near, angles, rows[:, places])
    return rows


def _straight(domain: Domain, rows: Floats, rng: np.random.Generator) -> Floats:
    """Every angle at a small distance from 0 or half a turn, every translation near 0.

    Every quaternion is near one of its basis vectors.
    """
    coordinates = domain.system.coordinates
    angles = [place for place, coordinate in enumerate(coordinates) if coordinate.is_angle]
    m = len(coordinates)
    turned = np.zeros((len(rows), m))
    turned[:, angles] = rng.choice([-np.pi, 0.0, np.pi], (len(rows), len(angles)))
    for first in (place for place, coordinate in enumerate(coordinates) if coordinate.name == QUATERNION[0]):
        chosen = first + rng.integers(0, len(QUATERNION), len(rows))
        turned[np.arange(len(rows)), chosen] = domain.high[chosen]
    rows[:, :m] = turned + _small(rng, (len(rows), m)) * domain.high[:m]
    return rows


def _near_equilibrium(domain: Domain, rows: Floats, rng: np.random.Generator) -> Floats:
    """Almost still, and tau almost holds the tree against gravity and loads."""
    n, y, tau = len(domain.system.freedoms), domain.first["y"], domain.first["tau"]
    rows[:, y : y + n] *= np.abs(_small(rng, (len(rows), n)))
    states = domain.states(rows)
    forcing = reference.forcing(domain.system, states.x, states.y, states.force, states.torque)
    rows[:, tau : tau + n] = -forcing * (1 + _small(rng, (len(rows), 1)) * rng.uniform(-1, 1, forcing.shape))
    return rows


def _small(rng: np.random.Generator, shape: tuple[int, ...]) -> Floats:
    """Numbers of either sign, 10^-1 to 10^-`_NEAREST`, all powers equally likely."""
    sign: Floats = rng.choice([-1.0, 1.0], shape)
    return sign * 10.0 ** -rng.uniform(1.0, _NEAREST, shape)


STRATA: dict[str, Callable[[Domain, Floats, np.random.Generator], Floats]] = {
    LOCK: _next_to_lock,
    STRAIGHT: _straight,
    EQUILIBRIUM: _near_equilibrium,
}
"""By name; each is given uniform rows and may change them."""


FOUND = "found by search"
"""The stratum of the states that come of it."""

_TOGETHER = 8
"""States that are tried at once, of which the worst is climbed from."""

_FINEST = 5.0
"""Powers of ten between the box and the smallest step."""


def climb(
    domain: Domain,
    start: Sample,
    error: Callable[[Sample], Floats],
    evaluations: int,
    seed: int | Sequence[int],
) -> tuple[Sample, float]:
    """The worst state that was found, and its error.

    Every step changes a few numbers of the worst state so far, by steps of all sizes.

    Args:
        domain: Not to be left.
        start: One state of it.
        error: (B,) of a sample; infinite where there is no result.
        evaluations: How many states are tried.
        seed: Of the generator.
    """
    rng, width = np.random.default_rng(seed), domain.high - domain.low
    worst, height = start, float(error(start)[0])
    for tried in range(0, evaluations, _TOGETHER):
        count = min(_TOGETHER, evaluations - tried)
        changed = rng.random((count, domain.size)) < rng.choice([1 / domain.size, 0.1, 1.0], (count, 1))
        step = rng.standard_normal((count, domain.size)) * 10.0 ** -rng.uniform(0.5, _FINEST, (count, 1))
        sample = domain.states(worst.flat() + width * step * changed, FOUND)
        inside = [k for k in range(count) if domain.contains(sample[k : k + 1])]
        errors = error(sample)
        best = max(inside, key=lambda k: errors[k], default=None)
        if best is not None and errors[best] > height:
            worst, height = sample[best : best + 1], float(errors[best])
    return replace(worst, strata=(FOUND,)), height
