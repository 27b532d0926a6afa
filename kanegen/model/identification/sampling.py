"""Which combinations of inertial parameters count, from random positions, where motions depend on each other.

A coupling lets joints of several branches move together, and of prescribed motion the equations hold no row.
The entries of [A] and the generalized weights of a random position are linear forms of the inertial
parameters; so are, where motion is prescribed, the derivatives of the entries between prescribed freedoms by
the free coordinates, which are their centrifugal forces. Forms of enough positions span all forms, with
probability one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from kanegen.model.arrays import Floats
from kanegen.model.coordinates import Freedom
from kanegen.model.identification.single_joints import Geometry, Placement, SingleJoint
from kanegen.model.identification.spaces import SAME, commuted, energy_forms, motions_outward, span
from kanegen.model.rotations import turn

CONFIRMATIONS = 3
"""Number of positions in a row that must add nothing before the forms are taken for complete."""


def sampled_forms(geometry: Geometry, columns: Sequence[int]) -> Floats:
    """Return a basis of the linear forms of some inertial parameters in the equations of motion.

    Args:
        geometry: The tree.
        columns: (c,) places of the parameters.

    Returns:
        (r, c) forms.
    """
    rng, sampler = np.random.default_rng(0), _Sampler(geometry)
    found, unchanged = np.zeros((0, len(columns))), 0
    while unchanged < CONFIRMATIONS:
        rows = sampler.forms(rng)[:, columns]
        sizes = np.linalg.norm(rows, axis=1)
        kept = sizes > SAME * sizes.max(initial=0.0)
        more = span(np.concatenate([found, rows[kept] / sizes[kept, None]]))
        unchanged = unchanged + 1 if len(more) == len(found) else 0
        found = more
    return found


@dataclass(frozen=True)
class _Moving:
    """A freedom that moves, as a linear function of the independent ones.

    Attributes:
        place: Row among all moving freedoms.
        is_angle: Whether it is an angle.
    """

    place: int
    is_angle: bool


class _Sampler:
    """Forms of inertial parameters in random positions of a system."""

    def __init__(self, geometry: Geometry) -> None:
        self.geometry, self.arrays, self.length = geometry, geometry.arrays, geometry.length
        joints = [one for chain in geometry.chains for one in chain if isinstance(one, SingleJoint)]
        self.moving = {one.freedom: _Moving(i, one.is_hinge) for i, one in enumerate(joints)}
        coupled = {one.freedom for one in self.arrays.coupled}
        independent = [freedom for freedom in self.moving if freedom not in coupled]
        self.free = [self._is_free(freedom) for freedom in independent]
        self.rates = self._rates(independent)

    def _is_free(self, freedom: Freedom) -> bool:
        """Return whether a freedom is free, not prescribed."""
        return bool(self.arrays.free[freedom.body - 1, freedom.index])

    def _unit(self, freedom: Freedom) -> float:
        """Return the unit of a coordinate: 1 rad, or that of lengths."""
        return 1.0 if freedom.is_angle else self.length

    def _rates(self, independent: Sequence[Freedom]) -> Floats:
        """Return (M, r) rates of all moving freedoms by those of the independent ones."""
        rates = np.zeros((len(self.moving), len(independent)))
        for i, freedom in enumerate(independent):
            rates[self.moving[freedom].place, i] = 1.0
        for one in self.arrays.coupled:
            for other, factor in one.terms:
                share = factor * self._unit(other) / self._unit(one.freedom)
                rates[self.moving[one.freedom].place] += share * rates[self.moving[other].place]
        return rates

    def _position(self, rng: np.random.Generator) -> Floats:
        """Return (M,) values of all moving freedoms in a random position, in rad and the unit of lengths."""
        value = rng.uniform(-2.0, 2.0, len(self.moving))
        for one in self.arrays.coupled:
            terms = (f * self._unit(other) * value[self.moving[other].place] for other, f in one.terms)
            value[self.moving[one.freedom].place] = (one.offset + sum(terms)) / self._unit(one.freedom)
        return value

    def forms(self, rng: np.random.Generator) -> Floats:
        """Return the forms in one random position, a row each, in the frames that users see."""
        position = self._position(rng)
        blocks = [self._of_body(*motions) for motions in self._motions(position)]
        found: Floats = np.concatenate(blocks, axis=1)
        return found

    def _of_body(self, path: Sequence[int], motions: Floats, weight: Floats) -> Floats:
        """Return the forms of one body, (r, 10).

        Args:
            path: Rows of the moving freedoms that carry it, outward.
            motions: (M, 6) its motions by unit rates of the moving freedoms.
            weight: (6,) motion of the ground along gravity, as the body sees it.
        """
        reduced = self.rates.T @ motions
        free = [i for i, flag in enumerate(self.free) if flag]
        driven = [i for i, flag in enumerate(self.free) if not flag]
        rows = []
        for i in free:
            rows += [energy_forms(reduced, reduced[i]), energy_forms(weight[None], reduced[i])]
            if driven:
                changes = self.rates.T[driven] @ self._changes(path, motions, self.rates[:, i])
                for place, j in enumerate(driven):
                    one, other = reduced[driven], reduced[j]
                    rows.append(energy_forms(changes, other) + energy_forms(one, changes[place]))
        return np.concatenate(rows)

    def _changes(self, path: Sequence[int], motions: Floats, rates: Floats) -> Floats:
        """Return (M, 6) derivatives of the motions of a body along some rates of the moving freedoms."""
        changes = np.zeros_like(motions)
        for place, outer in enumerate(path):
            inner = list(path[:place])
            changes[inner] += rates[outer] * commuted(motions[outer], motions[inner])
        return changes

    def _motions(self, position: Floats) -> Iterator[tuple[list[int], Floats, Floats]]:
        """Yield for each body the arguments of `_of_body`."""
        ground = np.zeros((len(self.moving) + 1, 6))
        ground[-1] = self.geometry.weight
        found: list[tuple[list[int], Floats]] = [([], ground)]
        of_bodies = zip(self.geometry.connection, self.geometry.chains, self.geometry.frames, strict=True)
        for lower, chain, frame in of_bodies:
            path, motions = list(found[lower][0]), found[lower][1]
            for one in chain:
                if isinstance(one, Placement):
                    motions = motions_outward(motions, one)
                else:
                    place = self.moving[one.freedom].place
                    motions = motions_outward(motions, _moved(one, position[place]))
                    motions[place] = one.motion
                    path.append(place)
            found.append((path, motions))
            seen = motions_outward(motions, frame)
            yield path, seen[:-1], seen[-1]


def _moved(joint: SingleJoint, value: float) -> Placement:
    """Return the placement above a single joint at a value of its coordinate."""
    if joint.is_hinge:
        return Placement(np.array(turn(joint.axis, value)), np.zeros(3))
    return Placement(np.eye(3), value * np.eye(3)[joint.axis])
