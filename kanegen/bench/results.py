"""What a driver computed, and how far it is from what another computed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kanegen.arrays import Floats

TOLERANCE = 1e-10
"""Largest difference allowed, relative to the largest entry of a state's array."""

EQUATIONS = "equations"
DYNAMICS = "dynamics"
QUANTITIES = (EQUATIONS, DYNAMICS)
"""[A] and {f}, and {ydot}."""


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
"""By task: (B, n + 1, n), [A] with {f} below it, or (B, 1, n), {ydot}."""


def read(path: Path, tasks: Sequence[Task], n: int) -> Results:
    """The results of every task from a driver's file."""
    rows = [n + 1 if task.quantity == EQUATIONS else 1 for task in tasks]
    values = np.fromfile(path).reshape(-1, sum(rows), n)
    parts = np.split(values, np.cumsum(rows)[:-1], axis=1)
    return {task.name: part for task, part in zip(tasks, parts, strict=True)}


def write(path: Path, results: Results) -> None:
    """As a driver does."""
    np.concatenate(list(results.values()), axis=1).tofile(path)


def difference(ours: Floats, theirs: Floats) -> float:
    """Of one task's results: the largest over [A], {f} or {ydot}, relative to the largest entry of each.

    {f} counts as no smaller than a thousandth of [A], or its rounding errors would count where it is zero.
    """
    if ours.shape[1] == 1:
        return _relative(ours, theirs, _size(theirs))
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
