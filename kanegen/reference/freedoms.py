"""All 6N freedoms in the order of Eq. (1): the angles of all bodies, then their translations.

A freedom of a system is free, prescribed, coupled or locked; a quaternion stands for three angles. In shapes,
`...` is the batch: nothing, or (B,).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kanegen.model.arrays import SystemArrays
from kanegen.model.coordinates import ANGLES, Freedom
from kanegen.reference.matrices import Numbers

UNPRESCRIBED = np.zeros((3, 0))
"""(3, 0) motion of the prescribed freedoms of a system that has none."""


def free_columns(system: SystemArrays) -> NDArray[np.bool_]:
    """Return (6N,) flags of the speeds of Eq. (1) that are free."""
    return np.concatenate([system.free[:, :3].ravel(), system.free[:, 3:].ravel()])


def prescribed_columns(system: SystemArrays) -> NDArray[np.bool_]:
    """Return (6N,) flags of the speeds of Eq. (1) that are prescribed."""
    return np.concatenate([system.prescribed[:, :3].ravel(), system.prescribed[:, 3:].ravel()])


def column(system: SystemArrays, k: int, index: int) -> int:
    """Return the index among all 6N of the freedom `index` (0 to 5) of body `k` (from 1)."""
    kind, axis = divmod(index, 3)
    return 3 * (kind * len(system.mass) + k - 1) + axis


def coordinate_count(system: SystemArrays) -> int:
    """Return the number m of elements of {x}; a quaternion has four of them for three freedoms."""
    extra = sum(len(rotation.coordinates) - 3 for rotation in system.rotations)
    return int(free_columns(system).sum()) + extra


def orientations_and_translations(
    system: SystemArrays, x: Numbers, prescribed: Numbers
) -> tuple[list[Numbers], list[Numbers]]:
    """Return the orientation and the translation of every body.

    Args:
        system: The numbers of the tree.
        x: (..., m) coordinates (rad, m, 1).
        prescribed: (..., p) values of the prescribed freedoms (rad, m).

    Returns:
        For each body its (..., 3) angles or (..., 4) quaternion, and for each body its (..., 3) translation.
    """
    rest, rest_prescribed, parts = x, prescribed, []
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
                own[..., moved] = rest_prescribed[..., : moved.sum()]
                rest_prescribed = rest_prescribed[..., moved.sum() :]
            found.append(own)
        parts.append(found)
    of_kind = {True: parts[0], False: parts[1]}
    for one in system.coupled:
        value = of_kind[one.freedom.is_angle][one.freedom.body - 1]
        value[..., one.freedom.axis] = one.offset + sum(
            factor * of_kind[other.is_angle][other.body - 1][..., other.axis] for other, factor in one.terms
        )
    return parts[0], parts[1]


def largest_coupled_angle(system: SystemArrays, x: Numbers, prescribed: Numbers) -> float:
    """Return the largest sum of the magnitudes of the terms of a coupled angle in some states (rad).

    Args:
        system: The numbers of the tree.
        x: (B, m) coordinates.
        prescribed: (B, p) values of the prescribed freedoms.
    """
    known = orientations_and_translations(system, x, prescribed)
    sizes: dict[Freedom, Numbers] = {}
    for one in system.coupled:
        terms = [
            abs(factor) * sizes.get(other, abs(known[other.index // 3][other.body - 1][..., other.axis]))
            for other, factor in one.terms
        ]
        sizes[one.freedom] = sum(terms, start=abs(one.offset) + np.zeros(len(x)))
    return max((float(size.max()) for freedom, size in sizes.items() if freedom.is_angle), default=0.0)


def full_order(system: SystemArrays, values: Numbers, prescribed: Numbers) -> Numbers:
    """Return (..., 6N) values in the order of Eq. (1), 0 for locked freedoms.

    Args:
        system: The numbers of the tree.
        values: (..., n) values of the free freedoms.
        prescribed: (..., p) values of the prescribed freedoms.
    """
    dtype = np.result_type(values.dtype, prescribed.dtype, np.float64)
    full = np.full((*values.shape[:-1], system.free.size), 0.0, dtype)
    full[..., free_columns(system)] = values
    full[..., prescribed_columns(system)] = prescribed
    for one in system.coupled:
        place = column(system, one.freedom.body, one.freedom.index)
        full[..., place] = sum(
            factor * full[..., column(system, other.body, other.index)] for other, factor in one.terms
        )
    return full


def gathered(
    system: SystemArrays, values: Numbers, columns: NDArray[np.bool_], *, sizes: bool = False
) -> Numbers:
    """Return those of (..., 6N) forces or partial velocities that belong to `columns`.

    What belongs to a coupled freedom adds to the freedoms that it follows, times its factors.

    Args:
        system: The numbers of the tree.
        values: One value for each freedom, in the order of Eq. (1).
        columns: (6N,) flags of the free or of the prescribed freedoms.
        sizes: Whether the values are magnitudes, which never cancel.
    """
    if not system.coupled:
        return values[..., columns]
    total = values.copy()
    for one in reversed(system.coupled):
        own = total[..., column(system, one.freedom.body, one.freedom.index)]
        for other, factor in one.terms:
            share = abs(factor) if sizes else factor
            total[..., column(system, other.body, other.index)] += share * own
    return total[..., columns]


def rates_of_bodies(full: Numbers) -> tuple[Numbers, Numbers]:
    """Return the (..., N, 3) angular and the (..., N, 3) translational part of (..., 6N) speeds."""
    angles, translations = np.split(full, 2, axis=-1)
    shape = (*full.shape[:-1], -1, 3)
    return angles.reshape(shape), translations.reshape(shape)
