"""The same physical states for variants with other generalized speeds or coordinates."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from kanegen.extras import module
from kanegen.model.arrays import Floats
from kanegen.model.coordinates import Freedom
from kanegen.model.freedoms import FREEDOMS
from kanegen.model.system import System
from kanegen.reference.kinematics import BodyKinematics, kinematics
from kanegen.studies.tradeoff import EXTRA
from kanegen.studies.tradeoff.domain import rounded
from kanegen.studies.tradeoff.samples import Sample


def converted(sample: Sample, system: System, other: System) -> Sample:
    """A sample of `system` for `other`, where some joints have another description.

    With the relative angular velocity for speeds, y becomes [P] y, Eq. (8), and tau becomes [P]^-T tau, which
    does the same work; a quaternion stands for the same orientation. All are rounded to the grid: the states
    are the same up to that, and each is the exact input of its variant.
    """
    if other == system:
        return sample
    bodies = kinematics(system.values(), sample.x, sample.y)
    y, tau = sample.y.copy(), sample.tau.copy()
    pairs = zip(system.bodies, other.bodies, strict=True)
    for k, (body, changed) in enumerate(pairs, start=1):
        if changed.joint.spins and not body.joint.spins:
            own = [system.places[Freedom(k, index)] for index in range(3)]
            matrix = bodies[k - 1].rate_matrix
            y[:, own] = np.einsum("bij,bj->bi", matrix, y[:, own])
            tau[:, own] = np.linalg.solve(matrix.swapaxes(1, 2), tau[:, own, None])[..., 0]
    x = np.stack(list(_columns(sample.x, system, other, bodies)), axis=1)
    return replace(sample, x=rounded(x), y=rounded(y), tau=rounded(tau))


def _columns(
    x: Floats, system: System, other: System, bodies: tuple[BodyKinematics, ...]
) -> Iterator[Floats]:
    """By coordinate of `other` its values."""
    orientations = system.values().joint_orientation
    for coordinate in other.coordinates:
        if coordinate in system.coordinate_places:
            yield x[:, system.coordinate_places[coordinate]]
        else:
            k = coordinate.body - 1
            turn = bodies[k].relative_rotation @ orientations[k].T
            yield _quaternion(turn.swapaxes(1, 2))[:, coordinate.index - len(FREEDOMS)]


def _quaternion(rotation: Floats) -> Floats:
    """(B, 4) scalar first, of (B, 3, 3) rotations from body to joint components."""
    found = module("scipy.spatial.transform", extra=EXTRA).Rotation.from_matrix(rotation)
    return np.roll(found.as_quat(), 1, axis=1)
