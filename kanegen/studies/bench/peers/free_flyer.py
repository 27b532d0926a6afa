"""Conversion between kanegen's generalized speeds and those of free-flyers, Pinocchio's floating joints.

The velocity of a free-flyer takes the places of the rates of its three translations and three angles. {x}
stays as it is, and the driver computes the quaternion itself.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from kanegen.interop.blocks import Block, Floating, Scalars
from kanegen.interop.matching import Matching
from kanegen.interop.state_map import StateMap
from kanegen.model.system import System
from kanegen.reference.states import ActuatedStates
from kanegen.studies.bench.peers.joints import Joint
from kanegen.studies.bench.results import Results


class FreeFlyer:
    """The conversion for a model with free-flyers among its joints."""

    def __init__(self, system: System, joints: Sequence[Joint]) -> None:
        blocks, n = tuple(_blocks(system, joints)), len(system.freedoms)
        self._map = StateMap(blocks, n, n, sum(len(block.q) for block in blocks), n)

    def states(self, states: ActuatedStates) -> ActuatedStates:
        """Convert states of kanegen to those of the model with free-flyers."""
        x = states.x
        return ActuatedStates(x, self._map.to_v(x, states.y), tau=self._map.to_tau(x, states.tau))

    def results(self, theirs: Results, states: ActuatedStates) -> Results:
        """Convert [A], {f} and {ydot} of the model with free-flyers to those of kanegen."""
        converted, x, y = {}, states.x, states.y
        for task, values in theirs.items():
            matrix, vector = values[:, :-1], values[:, -1]
            if matrix.shape[1]:
                a = self._map.from_mass_matrix(x, matrix)
                f = self._map.from_bias(x, y, matrix, -vector)
                converted[task] = np.concatenate([a, f[:, None]], axis=1)
            else:
                converted[task] = self._map.from_vdot(x, y, vector)[:, None]
        return converted


def _blocks(system: System, joints: Sequence[Joint]) -> Iterator[Block]:
    """Yield a block for each joint, with velocities at the places of kanegen's speeds."""
    matching, first = Matching(system, "Pinocchio"), 0
    for joint in joints:
        places, is_floating = joint.columns, joint.kind == "free-flyer"
        q = tuple(range(first, first + len(places) + is_floating))
        first += len(q)
        if is_floating:
            ball = matching.ball(system.freedoms[places[0]].body, q[3:], places[3:], scalar_last=True)
            yield Floating(places, places, q, places, ball, is_local=True)
        else:
            yield Scalars(places, places, q, places)
