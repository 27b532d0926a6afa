"""Which combinations of inertial parameters count, from random positions, where motions depend on each other.

A coupling lets joints of several branches move together, and for prescribed freedoms the equations hold no
row. The entries of [A] and the generalized weights of a random position are linear forms of the inertial
parameters: the pairing of any motion of the bodies, or of one along gravity, with a motion by free rates.
Where motion is prescribed, so are the derivatives, along a motion by free rates, of the pairing of two
prescribed motions: their centrifugal forces. Random motions in random positions span all such forms, with
probability one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from kanegen.model.arrays import Floats
from kanegen.model.coordinates import Freedom
from kanegen.model.identification.single_joints import Element, Geometry, Placement, SingleJoint
from kanegen.model.identification.spaces import SAME, commuted, energy_forms, motions_outward, span
from kanegen.model.rotations import turn

MOTIONS = 32
"""Number of random motions in each position."""

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
    rng, rates = np.random.default_rng(0), _Rates(geometry)
    found, unchanged = np.zeros((0, len(columns))), 0
    while unchanged < CONFIRMATIONS:
        rows = _forms(geometry, rates, rng)[:, columns]
        sizes = np.linalg.norm(rows, axis=1)
        kept = sizes > SAME * sizes.max()  # others are rounding errors of zero
        rows = rows[kept] / sizes[kept, None]
        for _ in range(2):  # the second time removes what rounding leaves
            rows = rows - rows @ found.T @ found
        new = span(rows)
        found, unchanged = np.concatenate([found, new]), 0 if len(new) else unchanged + 1
    return found


class _Rates:
    """The rates of all single joints as linear functions of those of the independent freedoms."""

    def __init__(self, geometry: Geometry) -> None:
        self.geometry = geometry
        joints = [one for chain in geometry.chains for one in chain if isinstance(one, SingleJoint)]
        self.places = {one.freedom: place for place, one in enumerate(joints)}
        arrays = geometry.arrays
        coupled = {one.freedom for one in arrays.coupled}
        independent = [freedom for freedom in self.places if freedom not in coupled]
        is_free = np.array([bool(arrays.free[one.body - 1, one.index]) for one in independent])
        every = np.zeros((len(independent), len(joints)))
        every[range(len(independent)), [self.places[freedom] for freedom in independent]] = 1.0
        for one in arrays.coupled:
            for other, factor in one.terms:
                share = factor * self._unit(other) / self._unit(one.freedom)
                every[:, self.places[one.freedom]] += share * every[:, self.places[other]]
        self.every, self.free, self.prescribed = every, every[is_free], every[~is_free]

    def _unit(self, freedom: Freedom) -> float:
        """Return the unit of a coordinate: 1 rad, or that of lengths."""
        return 1.0 if freedom.is_angle else self.geometry.length

    def position(self, rng: np.random.Generator) -> Floats:
        """Return (M,) random values of all single joints, in rad and in the unit of lengths."""
        value = rng.uniform(-2.0, 2.0, len(self.places))
        for one in self.geometry.arrays.coupled:
            terms = (factor * self._unit(other) * value[self.places[other]] for other, factor in one.terms)
            value[self.places[one.freedom]] = (one.offset + sum(terms)) / self._unit(one.freedom)
        return value


def _random(rates: Floats, rng: np.random.Generator) -> Floats:
    """Return (`MOTIONS`, M) random sums of rates."""
    found: Floats = rng.normal(size=(MOTIONS, len(rates))) @ rates
    return found


@dataclass(frozen=True)
class _Field:
    """Random motions, seen by one body after the other: (`MOTIONS`, 6) by rates of the single joints.

    Attributes:
        rates: (`MOTIONS`, M) the rates.
        motion: The motion of the body that has been reached.
        along: (`MOTIONS`, M) rates along which the position changes; None where it does not.
        change: Derivative of the motion by this change.
    """

    rates: Floats
    motion: Floats
    along: Floats | None
    change: Floats

    @classmethod
    def starting(cls, rates: Floats, motion: Floats, along: Floats | None = None) -> _Field:
        """Return motions as the ground sees them."""
        return cls(rates, motion, along, np.zeros_like(motion))

    def outward(self, placement: Placement) -> _Field:
        """Return the motions as the upper frame of a placement sees them, if it is fixed to the lower one."""
        motion = motions_outward(self.motion, placement)
        return replace(self, motion=motion, change=motions_outward(self.change, placement))

    def with_joint(self, joint: SingleJoint, place: int, value: float) -> _Field:
        """Return the motions above a single joint with rates at `place`, at a value of its coordinate."""
        seen = self.outward(_moved(joint, value))
        change = seen.change
        if seen.along is not None:
            change = change + seen.along[:, place, None] * commuted(joint.motion, seen.motion)
        own = seen.rates[:, place, None] * joint.motion
        return replace(seen, motion=seen.motion + own, change=change)


def _forms(geometry: Geometry, rates: _Rates, rng: np.random.Generator) -> Floats:
    """Return the forms of random motions in one random position, a row each, in the frames that users see."""
    position = rates.position(rng)
    still = np.zeros((MOTIONS, 6))
    weight = rng.normal(size=(MOTIONS, 1)) * geometry.weight
    fields = [
        _Field.starting(_random(rates.every, rng), weight),
        _Field.starting(_random(rates.free, rng), still),
    ]
    if len(rates.prescribed):
        along = _random(rates.free, rng)
        fields += [_Field.starting(_random(rates.prescribed, rng), still, along) for _ in range(2)]
    reached, forms = [fields], []
    for lower, chain, frame in zip(geometry.connection, geometry.chains, geometry.frames, strict=True):
        reached.append([_through(chain, field, rates, position) for field in reached[lower]])
        any_motion, free, *prescribed = (field.outward(frame) for field in reached[-1])
        own = [energy_forms(any_motion.motion, free.motion)]
        if prescribed:
            one, other = prescribed
            own.append(energy_forms(one.change, other.motion) + energy_forms(one.motion, other.change))
        forms.append(np.concatenate(own))
    found: Floats = np.concatenate(forms, axis=1)
    return found


def _through(chain: Sequence[Element], field: _Field, rates: _Rates, position: Floats) -> _Field:
    """Return motions above the placements and single joints of a chain."""
    for one in chain:
        if isinstance(one, Placement):
            field = field.outward(one)
        else:
            place = rates.places[one.freedom]
            field = field.with_joint(one, place, position[place])
    return field


def _moved(joint: SingleJoint, value: float) -> Placement:
    """Return the placement above a single joint at a value of its coordinate."""
    if joint.is_hinge:
        return Placement(np.array(turn(joint.axis, value)), np.zeros(3))
    return Placement(np.eye(3), value * np.eye(3)[joint.axis])
