"""Which motions move mass or inertia: [A] = [P]^T [M] [P] without the sizes of [M].

[P] holds the partial velocities of the mass centres and the partial angular velocities, [M] the masses and
inertias. Whether [A] is singular depends only on the rows of [P] where [M] is not zero, not on how much
there is, so mass ratios cannot blur the answer. Scaling rows and columns does not change it either.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kanegen.model.arrays import Floats, SystemArrays
from kanegen.model.validation import INERTIA_ROUNDING
from kanegen.reference.freedoms import UNPRESCRIBED, free_columns
from kanegen.reference.kinematics import kinematics
from kanegen.reference.magnitudes import reaches

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
