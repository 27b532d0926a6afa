"""Systems whose [A] is singular in every state, found before any code is written.

[A] is singular where some motion moves neither mass nor inertia, that is where the columns of `moving_rows`
depend on each other. They are orthogonalised from the outermost freedom inward, so the first one that fails
is a freedom whose motion can be undone by freedoms further out. "Undone" means up to rounding: what is left
is below the error of the velocities that were subtracted, of which the model's own rotations, accepted when
orthogonal to `ORTHOGONALITY`, have the largest part. A state drawn at random tells, because almost all states
have the same rank.
"""

from __future__ import annotations

import numpy as np

from kanegen.errors import SingularError
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.model.validation import ORTHOGONALITY
from kanegen.reference.moving import MovingRows, moving_rows
from kanegen.reference.states import random_states

STATES = 3
"""One regular state is proof; so many unlucky ones do not happen."""

NEGLIGIBLE = 1e-6
"""Share of a motion below which a freedom is not named as taking part in it."""


def require_regular(system: System) -> None:
    """Make sure that [A] is regular in almost every state; parameters stand at their defaults.

    Raises:
        SingularError: If it is singular in every state; names the body and the freedom.
    """
    arrays = system.values()
    inward = _inward(system)
    motion: list[int] = []
    states = random_states(arrays, STATES)
    for x, told in zip(states.x, states.motion, strict=True):
        motion = _empty_motion(moving_rows(arrays, x, inward, told))
        if not motion:
            return
    raise SingularError(_message(system, [inward[i] for i in motion]))


def _inward(system: System) -> list[int]:
    """The freedoms from the outermost inward; within a joint angles lie outside translations."""
    keys = [(freedom.body, freedom.is_angle, freedom.axis) for freedom in system.freedoms]
    return sorted(range(len(keys)), key=keys.__getitem__, reverse=True)


def _empty_motion(rows: MovingRows) -> list[int]:
    """The first column that depends on those before it, and those; empty if all are independent.

    The combination of earlier columns that comes closest to column j is R[:j,:j]^-1 R[:j,j]; the inverse
    grows by a column at every step.
    """
    r: Floats = np.asarray(np.linalg.qr(rows.velocities, mode="r"))
    inverse = np.zeros_like(r)
    for j in range(len(r)):
        combination = inverse[:j, :j] @ r[:j, j]
        rounding = ORTHOGONALITY * (rows.magnitudes[j] + np.abs(combination) @ rows.magnitudes[:j])
        if abs(r[j, j]) <= rounding:
            return [j, *(int(i) for i in np.flatnonzero(np.abs(combination) > NEGLIGIBLE))]
        inverse[:j, j] = -combination / r[j, j]
        inverse[j, j] = 1 / r[j, j]
    return []


def _message(system: System, motion: list[int]) -> str:
    names = [system.speed_names[i] for i in motion]
    body = system.bodies[system.freedoms[motion[0]].body - 1].name
    others = f" together with {', '.join(repr(name) for name in names[1:])}" if names[1:] else ""
    return (
        f"body {body!r}: freedom {names[0]!r}{others} moves neither mass nor inertia, so [A] is singular in "
        f"every state. Give {body!r} mass or inertia that moves with it, or lock the freedom."
    )
