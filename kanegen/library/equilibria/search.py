"""Zeros of forces from many starts at once: the method of Levenberg and Marquardt, then Newton's."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Function = Callable[[Floats], Floats]

ITERATIONS = 100
"""Largest number of steps from a start."""

LARGEST_STEP = 0.7
"""Largest change of a coordinate in a step (rad, m)."""

SMALLEST = 1e-9
"""Share of the largest singular value below which a direction counts as one without forces."""


def zeros(forces: Function, slopes: Function, x: Floats, scale: Floats, moving: Floats) -> Floats:
    """Return states near zeros of scaled forces, one for each start.

    Args:
        forces: Function that returns (B, n) forces.
        slopes: Function that returns (B, n, m) derivatives of the forces.
        x: (B, m) starts.
        scale: (n,) size of each force that counts as one.
        moving: (m,) 1 for coordinates that may change, 0 for others.
    """
    x, damping = x.copy(), np.full(len(x), 1e-3)
    size = _size(forces(x), scale)
    for _ in range(ITERATIONS):
        J = slopes(x) / scale[:, None] * moving
        r = np.nan_to_num(forces(x) / scale)
        J = np.nan_to_num(J)
        normal = np.einsum("bni,bnj->bij", J, J)
        diagonal = np.einsum("bii->bi", normal)
        weight = damping[:, None] * np.maximum(diagonal, 1e-6 * diagonal.max(axis=1, keepdims=True) + 1e-300)
        normal = normal + np.einsum("bi,ij->bij", weight, np.eye(x.shape[1]))
        step = -np.linalg.solve(normal, np.einsum("bni,bn->bi", J, r)[..., None])[..., 0] * moving
        longest = np.abs(step).max(axis=1, keepdims=True)
        step *= np.minimum(1.0, LARGEST_STEP / np.maximum(longest, 1e-300))
        found = _size(forces(x + step), scale)
        better = found < size
        x, size = np.where(better[:, None], x + step, x), np.where(better, found, size)
        damping = np.clip(np.where(better, damping / 5, damping * 4), 1e-15, 1e8)
        if (size < 1e-14).all() or (damping[size > 1e-14] >= 1e8).all():
            break
    return x


def corrected(forces: Function, slopes: Function, x: Floats, scale: Floats, moving: Floats) -> Floats:
    """Return a state, (m,), after a few of Newton's steps, each as short as can be."""
    for _ in range(8):
        r = forces(x[None])[0] / scale
        J = slopes(x[None])[0] / scale[:, None] * moving
        if not (np.isfinite(r).all() and np.isfinite(J).all()):
            break
        step = -np.linalg.lstsq(J, r, rcond=SMALLEST)[0]
        if np.abs(step).max() > LARGEST_STEP:
            break
        x = x + step
        if np.abs(step).max() <= 1e-15:
            break
    return x


def null_space(J: Floats) -> Floats:
    """Return an orthonormal basis, (m, k), of the directions along which scaled forces stay zero."""
    _, sizes, rows = np.linalg.svd(J)
    rank = int((sizes > SMALLEST * max(float(sizes.max(initial=0.0)), 1e-300)).sum())
    return np.ascontiguousarray(rows[rank:].T)


def _size(forces: Floats, scale: Floats) -> Floats:
    """Return the sizes of scaled forces; infinite where they are undefined."""
    found = np.sqrt(np.sum((forces / scale) ** 2, axis=1))
    return np.where(np.isfinite(found), found, np.inf)
