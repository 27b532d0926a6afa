"""The same physical states for variants with other generalized speeds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kanegen.check.kinematics import kinematics
from kanegen.study.domain import rounded
from kanegen.study.samples import Sample
from kanegen.system import Freedom, System


def converted(sample: Sample, system: System, other: System) -> Sample:
    """A sample of `system` for `other`, where some joints have the relative angular velocity as speeds.

    There y becomes [P] y, Eq. (8), and tau becomes [P]^-T tau, which does the same work. Both are rounded to
    the grid: the states are the same up to that, and each is the exact input of its variant.
    """
    turned = [
        k
        for k, (body, changed) in enumerate(zip(system.bodies, other.bodies, strict=True), start=1)
        if changed.joint.spins and not body.joint.spins
    ]
    if not turned:
        return sample
    bodies = kinematics(system.values(), sample.states.x, sample.states.y)
    y, tau = sample.states.y.copy(), sample.tau.copy()
    for k in turned:
        own = [system.places[Freedom(k, index)] for index in range(3)]
        matrix = bodies[k - 1].rate_matrix
        y[:, own] = np.einsum("bij,bj->bi", matrix, y[:, own])
        tau[:, own] = np.linalg.solve(matrix.swapaxes(1, 2), tau[:, own, None])[..., 0]
    return Sample(replace(sample.states, y=rounded(y)), rounded(tau), sample.strata)
