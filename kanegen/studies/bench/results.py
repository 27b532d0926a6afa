"""The results of a driver, read from its file, and their difference from those of another driver."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kanegen.model.arrays import Floats

TOLERANCE = 1e-10
"""Largest difference between results that agree, relative to the largest entry of the array of a state."""

EQUATIONS = "equations"
"""The quantity [A] and {f}."""

DYNAMICS = "dynamics"
"""The quantity {ydot}."""

DERIVATIVES = "derivatives"
"""The quantity of the derivatives of {ydot} by {x}, {y} and {tau}."""

INVERSE_DERIVATIVES = "inverse derivatives"
"""The quantity of the derivatives of inverse dynamics by {x}, {y} and {ydot}, of which the last is [A].

What a state has as {tau} is {ydot} here.
"""

LOWER = "lower equations"
"""The quantity [A] as its lower triangle and {f}, a part of what peers compute for `EQUATIONS`."""

QUANTITIES = (EQUATIONS, LOWER, DYNAMICS, DERIVATIVES, INVERSE_DERIVATIVES)
"""All quantities that are compared and timed."""

BY_DIFFERENCES = 1e-3
"""Largest difference between derivatives and differences of a peer that has no derivatives."""


@dataclass(frozen=True)
class Task:
    """A task of a driver: one method of computing a quantity.

    Attributes:
        name: Name of the task, unique within its driver.
        quantity: One of `QUANTITIES`, or an output of kanegen.
        batch: Whether one call computes many states.
        shape: Rows and columns of the array of an output; None for `QUANTITIES`, whose shapes are known.
        tolerance: Largest difference from the standard with which the results agree.
    """

    name: str
    quantity: str
    batch: bool = False
    shape: tuple[int, int] | None = None
    tolerance: float = TOLERANCE

    def shape_for(self, n: int) -> tuple[int, int]:
        """Return the rows and columns of the result of one state, for n freedoms."""
        derivatives = (3 * n, n)
        of = {
            EQUATIONS: (n + 1, n),
            LOWER: (n + 1, n),
            DYNAMICS: (1, n),
            DERIVATIVES: derivatives,
            INVERSE_DERIVATIVES: derivatives,
        }
        return self.shape or of[self.quantity]


def of_peers(quantity: str) -> str:
    """Return the quantity of peers with which one of kanegen is compared."""
    return EQUATIONS if quantity == LOWER else quantity


Results = dict[str, Floats]
"""Results of B states by name of the task.

The shape is (B, n + 1, n) for [A] with {f} below it, (B, 1, n) for {ydot}, and (B, 3 n, n) for both kinds of
derivatives, (n, 3, n) for each state. Outputs of kanegen have the shapes of their tasks.
"""


def read(path: Path, tasks: Sequence[Task], n: int) -> Results:
    """Read the results of all tasks from the file of a driver."""
    shapes = [task.shape_for(n) for task in tasks]
    sizes = [rows * columns for rows, columns in shapes]
    values = np.fromfile(path).reshape(-1, sum(sizes))
    parts = np.split(values, np.cumsum(sizes)[:-1], axis=1)
    return {
        task.name: part.reshape(-1, *shape) for task, part, shape in zip(tasks, parts, shapes, strict=True)
    }


def write(path: Path, results: Results) -> None:
    """Write the results of all tasks into a file, as a driver does."""
    np.concatenate(list(results.values()), axis=1).tofile(path)


def difference(ours: Floats, theirs: Floats, quantity: str) -> float:
    """Return the largest difference between two results of one task, relative to the size of the array.

    The size of an array in a state is its largest entry. {f} counts as no smaller
    than a thousandth of [A], since otherwise its rounding errors would count where it vanishes.
    """
    n = ours.shape[2]
    if quantity in (DERIVATIVES, INVERSE_DERIVATIVES):
        mine, right = (values.reshape(-1, n, 3, n) for values in (ours, theirs))
        return max(_relative(mine[:, :, k], right[:, :, k], _size(right[:, :, k])) for k in range(3))
    if quantity not in (EQUATIONS, LOWER):
        return _relative(ours, theirs, _size(theirs))
    matrix, vector = theirs[:, :-1], theirs[:, -1:]
    least = np.maximum(_size(vector), 1e-3 * _size(matrix))
    return max(_relative(ours[:, :-1], matrix, _size(matrix)), _relative(ours[:, -1:], vector, least))


def _size(values: Floats) -> Floats:
    """Return the largest absolute entry of each state, (B,)."""
    size: Floats = np.abs(values).max(axis=(1, 2))
    return size


def _relative(ours: Floats, theirs: Floats, size: Floats) -> float:
    """Return the largest difference relative to the size in the same state."""
    worst = float((_size(ours - theirs) / size).max())
    return np.inf if np.isnan(worst) else worst
