"""All 6N freedoms in the order of Eq. (1): the angles of all bodies, then their translations.

Those of a system are free, prescribed or locked; a quaternion stands for three angles. In shapes, `...` is
the batch: nothing, or (B,).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kanegen.model.arrays import SystemArrays
from kanegen.model.coordinates import ANGLES
from kanegen.reference.matrices import Numbers

UNPRESCRIBED = np.zeros((3, 0))
"""Of a system without prescribed freedoms."""


def free_columns(system: SystemArrays) -> NDArray[np.bool_]:
    """(6N,) which speeds of Eq. (1) are free."""
    return np.concatenate([system.free[:, :3].ravel(), system.free[:, 3:].ravel()])


def prescribed_columns(system: SystemArrays) -> NDArray[np.bool_]:
    """(6N,) which are prescribed."""
    return np.concatenate([system.prescribed[:, :3].ravel(), system.prescribed[:, 3:].ravel()])


def column(system: SystemArrays, k: int, index: int) -> int:
    """Where the freedom `index` (0 to 5) of body `k` (from 1) stands."""
    kind, axis = divmod(index, 3)
    return 3 * (kind * len(system.mass) + k - 1) + axis


def coordinate_count(system: SystemArrays) -> int:
    """m, the elements of {x}: of a quaternion four, where there are three freedoms."""
    extra = sum(len(rotation.coordinates) - 3 for rotation in system.rotations)
    return int(free_columns(system).sum()) + extra


def by_body(system: SystemArrays, x: Numbers, prescribed: Numbers) -> tuple[list[Numbers], list[Numbers]]:
    """For each body its (..., 3) angles or (..., 4) quaternion, and its (..., 3) translation."""
    rest, told, parts = x, prescribed, []
    dtype = np.result_type(x.dtype, prescribed.dtype, system.locked.dtype)
    for columns in (slice(0, 3), slice(3, 6)):
        found = []
        for k, rotation in enumerate(system.rotations):
            if columns.start == 0 and rotation.coordinates != ANGLES:
                own, rest = np.split(rest, [len(rotation.coordinates)], axis=-1)
            else:
                free, moved = system.free[k, columns], system.prescribed[k, columns]
                own = np.empty((*x.shape[:-1], 3), dtype)
                own[...] = system.locked[k, columns]
                own[..., free], rest = rest[..., : free.sum()], rest[..., free.sum() :]
                own[..., moved], told = told[..., : moved.sum()], told[..., moved.sum() :]
            found.append(own)
        parts.append(found)
    return parts[0], parts[1]


def full_order(system: SystemArrays, values: Numbers, prescribed: Numbers) -> Numbers:
    """(..., 6N) in the order of Eq. (1), from (..., n) of free and (..., p) of prescribed freedoms."""
    dtype = np.result_type(values.dtype, prescribed.dtype, np.float64)
    full = np.full((*values.shape[:-1], system.free.size), 0.0, dtype)
    full[..., free_columns(system)] = values
    full[..., prescribed_columns(system)] = prescribed
    return full


def rates_by_body(full: Numbers) -> tuple[Numbers, Numbers]:
    """(..., N, 3) rates of turning and (..., N, 3) of translation from (..., 6N)."""
    angles, translations = np.split(full, 2, axis=-1)
    shape = (*full.shape[:-1], -1, 3)
    return angles.reshape(shape), translations.reshape(shape)
