"""What a driver computed, and how far it is from what another computed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kanegen.model.arrays import Floats

TOLERANCE = 1e-10
"""Largest difference allowed, relative to the largest entry of a state's array."""

EQUATIONS = "equations"
DYNAMICS = "dynamics"
DERIVATIVES = "derivatives"
QUANTITIES = (EQUATIONS, DYNAMICS, DERIVATIVES)
"""[A] and {f}, {ydot}, and the derivatives of {ydot} by {x}, {y} and {tau}."""


@dataclass(frozen=True)
class Task:
    """One way of a driver to compute a quantity.

    Attributes:
        name: Of the driver's own.
        quantity: One of `QUANTITIES`.
        batch: Whether many states are computed by one call.
    """

    name: str
    quantity: str
    batch: bool = False


Results = dict[str, Floats]
"""By task: (B, n + 1, n), [A] with {f} below it; (B, 1, n), {ydot}; (B, 3 n, n), (n, 3 n) derivatives."""


def read(path: Path, tasks: Sequence[Task], n: int) -> Results:
    """The results of every task from a driver's file."""
    of = {EQUATIONS: n + 1, DYNAMICS: 1, DERIVATIVES: 3 * n}
    rows = [of[task.quantity] for task in tasks]
    values = np.fromfile(path).reshape(-1, sum(rows), n)
    parts = np.split(values, np.cumsum(rows)[:-1], axis=1)
    return {task.name: part for task, part in zip(tasks, parts, strict=True)}


def write(path: Path, results: Results) -> None:
    """As a driver does."""
    np.concatenate(list(results.values()), axis=1).tofile(path)


def difference(ours: Floats, theirs: Floats) -> float:
    """Of one task's results: the largest over [A], {f}, {ydot} or derivatives, relative to its largest entry.

    {f} counts as no smaller than a thousandth of [A], or its rounding errors would count where it is zero.
    """
    if ours.shape[1] == 1:
        return _relative(ours, theirs, _size(theirs))
    n = ours.shape[2]
    if ours.shape[1] == 3 * n:
        mine, right = (values.reshape(-1, n, 3, n) for values in (ours, theirs))
        return max(_relative(mine[:, :, k], right[:, :, k], _size(right[:, :, k])) for k in range(3))
    matrix, vector = theirs[:, :-1], theirs[:, -1:]
    least = np.maximum(_size(vector), 1e-3 * _size(matrix))
    return max(_relative(ours[:, :-1], matrix, _size(matrix)), _relative(ours[:, -1:], vector, least))


def _size(values: Floats) -> Floats:
    """(B,) the largest entry of each state."""
    size: Floats = np.abs(values).max(axis=(1, 2))
    return size


def _relative(ours: Floats, theirs: Floats, size: Floats) -> float:
    worst = float((_size(ours - theirs) / size).max())
    return np.inf if np.isnan(worst) else worst
