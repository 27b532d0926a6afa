"""Systems whose [A] is singular in every state, found before any code is written.

[A] is singular where some motion moves neither mass nor inertia, that is where the columns of `moving_rows`
depend on each other. They are orthogonalised from the outermost freedom inward, so the first one that fails
is a freedom whose motion can be undone by freedoms further out. "Undone" means up to rounding: what is left
is below the error of the velocities that were subtracted, of which the model's own rotations, accepted when
orthogonal to `ORTHOGONALITY`, have the largest part. A state drawn at random tells, because almost all states
have the same rank.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kanegen.errors import SingularError
from kanegen.model.arrays import Floats, SystemArrays
from kanegen.model.system import System
from kanegen.model.validation import INERTIA_ROUNDING, ORTHOGONALITY
from kanegen.reference.freedoms import UNPRESCRIBED, free_columns
from kanegen.reference.kinematics import kinematics
from kanegen.reference.magnitudes import reaches
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
    for x, told in zip(states.x, states.prescribed, strict=True):
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


SWEEPS = 5
"""How often rows and columns are scaled in turn; their largest entries are then close to 1."""


@dataclass(frozen=True)
class MovingRows:
    """Rows of [P] that carry mass or inertia, without units.

    Attributes:
        velocities: (r, n) the rows, about 1 in size, one column a freedom; r >= n.
        magnitudes: (n,) norms of what the columns are summed from; rounding errors are relative to these.
    """

    velocities: Floats
    magnitudes: Floats


def moving_rows(
    arrays: SystemArrays, x: Floats, order: Sequence[int], prescribed: Floats = UNPRESCRIBED
) -> MovingRows:
    """The rows where {x} is `x` and `prescribed` stands as it does, with the freedoms in the given order."""
    columns = np.flatnonzero(free_columns(arrays))[list(order)]
    still = np.zeros(len(columns))
    bodies = kinematics(arrays, x, still, prescribed)
    blocks, sizes = [], []
    for k, reach in enumerate(reaches(arrays, bodies, still, prescribed)):
        if arrays.mass[k] > 0:
            blocks.append(bodies[k].center_y[:, columns])
            sizes.append(reach.center_y[columns])
        axes = inertia_axes(arrays.inertia[k])
        if len(axes):
            blocks.append(axes @ bodies[k].omega_y[:, columns])
            sizes.append(reach.omega_y[columns])
    table = np.reshape(sizes, (-1, len(columns)))
    row_scale, column_scale = _equilibrating(table)
    scaled = [scale * block * column_scale for scale, block in zip(row_scale, blocks, strict=True)]
    magnitudes = np.linalg.norm(table * row_scale[:, None] * column_scale, axis=0)
    return MovingRows(np.vstack([np.zeros((len(columns), len(columns))), *scaled]), magnitudes)


def inertia_axes(inertia: Floats) -> Floats:
    """(r, 3) principal axes about which a (3, 3) tensor has a moment.

    A moment counts as zero within the rounding of a rotated tensor, relative to the entries that the rotation
    mixed. Exact zeros show which were not mixed: each block that they leave has a scale of its own.
    """
    linked = np.linalg.matrix_power((inertia != 0) | np.eye(3, dtype=np.bool_), 2)
    found = []
    for block in sorted({tuple(np.flatnonzero(row)) for row in linked}):
        moments, axes = np.linalg.eigh(inertia[np.ix_(block, block)])
        for axis in axes.T[moments > INERTIA_ROUNDING * moments[-1]]:
            found.append(axis @ np.eye(3)[list(block)])
    return np.reshape(found, (-1, 3))


def _equilibrating(table: Floats) -> tuple[Floats, Floats]:
    """Factors of rows and of columns after which the largest entry of each is about 1."""
    rows, columns = np.ones(table.shape[0]), np.ones(table.shape[1])
    for _ in range(SWEEPS):
        rows = 1 / _largest(table * columns, axis=1)
        columns = 1 / _largest(table * rows[:, None], axis=0)
    return rows, columns


def _largest(table: Floats, axis: int) -> Floats:
    """Largest entries, or 1 where all are zero."""
    largest: Floats = table.max(axis=axis, initial=0.0)
    return np.where(largest > 0, largest, 1.0)
