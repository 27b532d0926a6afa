"""Conversion between kanegen's generalized speeds and those of a free-flyer, Pinocchio's floating joint.

The velocity v of a free-flyer is that of the body in body components, v = [J]{y}; its six numbers take the
places of the rates of three translations and three angles. {x} stays as it is, and the driver computes the
quaternion itself.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kanegen.model.arrays import Floats
from kanegen.reference.states import ActuatedStates
from kanegen.studies.bench.peers.joints import Joint
from kanegen.studies.bench.results import Results

STEP = 1e-30
"""Step of complex-step derivatives, which have no truncation error."""


class FreeFlyer:
    """The conversion for a model with free-flyers among its joints."""

    def __init__(self, joints: Sequence[Joint]) -> None:
        self.blocks = [np.array(joint.columns) for joint in joints if joint.kind == "free-flyer"]

    def states(self, states: ActuatedStates) -> ActuatedStates:
        """Convert states of kanegen to those of the model with free-flyers."""
        y, tau = np.empty_like(states.y), np.empty_like(states.tau)
        for b, x in enumerate(states.x):
            jacobian = self._jacobian(x)
            y[b] = jacobian @ states.y[b]
            tau[b] = np.linalg.solve(jacobian.T, states.tau[b])
        return ActuatedStates(states.x, y, tau=tau)

    def results(self, theirs: Results, states: ActuatedStates) -> Results:
        """Convert [A], {f} and {ydot} of the model with free-flyers to those of kanegen."""
        converted = {task: values.copy() for task, values in theirs.items()}
        for b, (x, y) in enumerate(zip(states.x, states.y, strict=True)):
            jacobian = self._jacobian(x)
            drift = (self._jacobian(x + 1j * STEP * y) @ y).imag / STEP  # [Jdot]{y}
            for values in converted.values():
                *matrix, vector = values[b].copy()
                if matrix:
                    values[b, :-1] = jacobian.T @ matrix @ jacobian
                    values[b, -1] = jacobian.T @ (vector - matrix @ drift)
                else:
                    values[b, 0] = np.linalg.solve(jacobian, vector - drift)
        return converted

    def _jacobian(self, x: Floats) -> Floats:
        """Return the (n, n) matrix [J] of v = [J]{y} at the coordinates {x}."""
        jacobian = np.eye(len(x), dtype=x.dtype)
        for block in self.blocks:
            jacobian[np.ix_(block, block)] = _body_velocity(x[block[3:]])
        return jacobian


def _body_velocity(angles: Floats) -> Floats:
    """Return the (6, 6) matrix from rates of translations and angles 1-2-3 to body components of velocity."""
    (s1, s2, s3), (c1, c2, c3) = np.sin(angles), np.cos(angles)
    one, zero = np.ones_like(s1), np.zeros_like(s1)
    turn_1 = np.array([[one, zero, zero], [zero, c1, -s1], [zero, s1, c1]])
    turn_2 = np.array([[c2, zero, s2], [zero, one, zero], [-s2, zero, c2]])
    turn_3 = np.array([[c3, -s3, zero], [s3, c3, zero], [zero, zero, one]])
    block = np.zeros((6, 6), dtype=angles.dtype)  # linear, then angular
    block[:3, :3] = (turn_1 @ turn_2 @ turn_3).T
    block[3:, 3] = (turn_2 @ turn_3)[0]
    block[3:, 4] = turn_3[1]
    block[3:, 5] = [0, 0, 1]
    return block
