"""States in which errors are large: constructed near singular states, or found by a search.

A uniform sample hardly ever contains such states. `hard_states` constructs them: it changes some numbers of
uniform rows, leaves the other numbers of a state ordinary, brings the rows back into the box, and drops rows
too near to gimbal lock. `climb` searches for them: it changes one state step by step, so that the error
grows; from an equilibrium half of its steps lead to equilibria. A search counts evaluations, not seconds, so
that the same seed finds the same state on every machine.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from kanegen.model.arrays import Floats
from kanegen.model.coordinates import Coordinate
from kanegen.reference import equations as reference
from kanegen.studies.tradeoff.domain import Domain, Sample, joined

GIMBAL_LOCK = "next to gimbal lock"
STRAIGHT = "folded or straight"
EQUILIBRIUM = "near equilibrium"
BALANCED = "in equilibrium"
NEARLY_SINGULAR = "nearly singular"

FOUND = "found by search"
"""The kind of states that a search finds."""

_NEAREST = 4.0
"""Largest number of powers of ten by which a hard state approaches the singular state of its kind."""

_REFINEMENTS = 24
"""Number of steps by which the least eigenvalue of [A] is made smaller in every nearly singular state."""

_TOGETHER = 8
"""Number of states that a search tries at once; it goes on from the worst of them."""

_FINEST = 5.0
"""Powers of ten between the size of the box and the smallest step of a search."""


def hard_states(domain: Domain, count: int, seed: int | Sequence[int]) -> Sample | None:
    """Return up to `count` states of each kind of hard states that a system has; None if there are none.

    Args:
        domain: The domain to which the states belong.
        count: Largest number of states of each kind.
        seed: Seed of the random numbers.
    """
    found = []
    for number, (kind, harden) in enumerate(HARD_KINDS.items()):
        rng = np.random.default_rng([*np.atleast_1d(seed), number])
        sample = domain.states(harden(domain, domain.uniform(count, rng), rng), kind)
        found += [sample[k : k + 1] for k in range(len(sample)) if domain.contains(sample[k : k + 1])]
    return joined(found) if found else None


def climb(
    domain: Domain,
    start: Sample,
    error: Callable[[Sample], Floats],
    evaluations: int,
    seed: int | Sequence[int],
) -> tuple[Sample, float]:
    """Return the state with the largest error that a search finds, and this error.

    Every step changes a few numbers of the worst state so far, by steps of all sizes. If the start is an
    equilibrium, half of the changed states are put into equilibrium again.

    Args:
        domain: The domain that the search does not leave.
        start: The state to begin with, as a sample of one state.
        error: Function that returns the (B,) errors in a sample; infinite where there is no result.
        evaluations: Number of states that are tried.
        seed: Seed of the random numbers.
    """
    rng, width = np.random.default_rng(seed), domain.high - domain.low
    worst, largest, keeps_balance = start, float(error(start)[0]), start.kinds[0] == BALANCED
    for tried in range(0, evaluations, _TOGETHER):
        count = min(_TOGETHER, evaluations - tried)
        changed = rng.random((count, domain.size)) < rng.choice([1 / domain.size, 0.1, 1.0], (count, 1))
        step = rng.standard_normal((count, domain.size)) * 10.0 ** -rng.uniform(0.5, _FINEST, (count, 1))
        rows = worst.flat() + width * step * changed
        if keeps_balance:
            rows = np.where(rng.random((count, 1)) < 0.5, balanced(domain, rows), rows)
        sample = domain.states(rows, FOUND)
        inside = [k for k in range(count) if domain.contains(sample[k : k + 1])]
        errors = error(sample)
        best = max(inside, key=lambda k: errors[k], default=None)
        if best is not None and errors[best] > largest:
            worst, largest = sample[best : best + 1], float(errors[best])
    return replace(worst, kinds=(FOUND,)), largest


def _next_to_gimbal_lock(domain: Domain, rows: Floats, rng: np.random.Generator) -> Floats:
    """Put about half of the second angles of joints at a small distance from gimbal lock."""
    if not domain.gimbal_lock_angles:
        return rows[:0]
    shape = (len(rows), len(domain.gimbal_lock_angles))
    places, locks = list(domain.gimbal_lock_angles), np.array(list(domain.gimbal_lock_angles.values()))
    angles = locks - rng.choice([0.0, 1.0], shape) * np.pi + _small(rng, shape)
    near = rng.random(shape) < 0.5
    near[np.arange(len(rows)), rng.integers(0, shape[1], len(rows))] = True
    rows[:, places] = np.where(near, angles, rows[:, places])
    return rows


def _unitless(coordinates: Sequence[Coordinate]) -> list[list[int]]:
    """Return the places in {x} of the coordinates without a unit, such as a quaternion's, body by body."""
    places: dict[int, list[int]] = {}
    for place, coordinate in enumerate(coordinates):
        if coordinate.unit == "1":
            places.setdefault(coordinate.body, []).append(place)
    return list(places.values())


def _folded_or_straight(domain: Domain, rows: Floats, rng: np.random.Generator) -> Floats:
    """Put angles near 0 or half a turn, translations near 0, and quaternions near a basis vector."""
    coordinates = domain.system.coordinates
    angles = [place for place, coordinate in enumerate(coordinates) if coordinate.is_angle]
    m = len(coordinates)
    x = np.zeros((len(rows), m))
    x[:, angles] = rng.choice([-np.pi, 0.0, np.pi], (len(rows), len(angles)))
    for joint_places in _unitless(coordinates):
        chosen = joint_places[0] + rng.integers(0, len(joint_places), len(rows))
        x[np.arange(len(rows)), chosen] = domain.high[chosen]
    rows[:, :m] = x + _small(rng, (len(rows), m)) * domain.high[:m]
    return rows


def _near_equilibrium(domain: Domain, rows: Floats, rng: np.random.Generator) -> Floats:
    """Make the speeds small, and let tau almost hold the tree against gravity and loads."""
    n, y, tau = len(domain.system.freedoms), domain.first["y"], domain.first["tau"]
    rows[:, y : y + n] *= np.abs(_small(rng, (len(rows), n)))
    rows = balanced(domain, rows)
    rows[:, tau : tau + n] *= 1 + _small(rng, (len(rows), 1)) * rng.uniform(-1, 1, (len(rows), n))
    return rows


def _in_equilibrium(domain: Domain, rows: Floats, rng: np.random.Generator) -> Floats:
    """Let tau hold the tree: a third of the states at rest, a third moving, a third at corners of the box."""
    n, y, tau = len(domain.system.freedoms), domain.first["y"], domain.first["tau"]
    corners = np.where(rng.random((len(rows), tau)) < 0.5, domain.low[:tau], domain.high[:tau])
    third = np.arange(len(rows)) % 3
    rows[third == 0, y : y + n] = 0.0
    rows[third == 2, :tau] = corners[third == 2]
    return balanced(domain, rows)


def balanced(domain: Domain, rows: Floats) -> Floats:
    """Return rows (B, m) with tau = -{f} in single precision, so that only rounding accelerates the tree.

    Where this tau lies outside the box, the state that `Domain.states` makes of the row is no equilibrium.
    """
    n, tau = len(domain.system.freedoms), domain.first["tau"]
    states = domain.states(rows)
    found = states.flat()
    found[:, tau : tau + n] = -reference.forcing(
        domain.system, states.x, states.y, states.force, states.torque
    )
    return found


def _nearly_singular(domain: Domain, rows: Floats, rng: np.random.Generator) -> Floats:
    """Change x so that the least eigenvalue of [A], scaled to a diagonal of ones, gets small."""
    first = domain.first["y"]
    width = (domain.high - domain.low)[:first]
    least = _least_eigenvalue(domain, rows)
    for step in np.geomspace(1.0, 10.0**-_NEAREST, _REFINEMENTS):
        tried = rows.copy()
        tried[:, :first] += step * width * rng.uniform(-0.5, 0.5, (len(rows), first))
        tried = domain.states(tried).flat()
        value = _least_eigenvalue(domain, tried)
        better = value < least
        rows[better], least[better] = tried[better], value[better]
    return rows


def _least_eigenvalue(domain: Domain, rows: Floats) -> Floats:
    """Return (B,) least eigenvalues of [A], scaled to a diagonal of ones; 1 where that is impossible."""
    matrix = reference.mass_matrix(domain.system, domain.states(rows).x)
    scale = 1 / np.sqrt(np.diagonal(matrix, axis1=1, axis2=2))
    scaled = matrix * scale[:, :, None] * scale[:, None, :]
    usable = np.isfinite(scaled).all(axis=(1, 2))
    return np.where(usable, np.linalg.eigvalsh(np.where(usable[:, None, None], scaled, 1.0))[:, 0], 1.0)


def _small(rng: np.random.Generator, shape: tuple[int, ...]) -> Floats:
    """Return numbers of either sign from 10^-`_NEAREST` to 10^-1, all powers equally likely."""
    sign: Floats = rng.choice([-1.0, 1.0], shape)
    return sign * 10.0 ** -rng.uniform(1.0, _NEAREST, shape)


HARD_KINDS: dict[str, Callable[[Domain, Floats, np.random.Generator], Floats]] = {
    GIMBAL_LOCK: _next_to_gimbal_lock,
    STRAIGHT: _folded_or_straight,
    EQUILIBRIUM: _near_equilibrium,
    BALANCED: _in_equilibrium,
    NEARLY_SINGULAR: _nearly_singular,
}
"""Kinds of hard states, each with the function that changes uniform rows (B, m) into states of this kind."""
