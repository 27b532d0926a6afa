"""What a driver computed, and how far it is from what another computed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from kanegen.arrays import Floats

TOLERANCE = 1e-10
"""Largest difference allowed, relative to the largest entry of a state's array."""


@dataclass(frozen=True)
class Task:
    """One way of a driver to compute [A] and {f} ("equations") or {ydot} ("dynamics")."""

    name: str
    quantity: Literal["equations", "dynamics"]


Results = dict[str, Floats]
"""By task: (B, n + 1, n), [A] with {f} below it, or (B, 1, n), {ydot}."""


def read(path: Path, tasks: Sequence[Task], n: int) -> Results:
    """The results of every task from a driver's file."""
    rows = [n + 1 if task.quantity == "equations" else 1 for task in tasks]
    values = np.fromfile(path).reshape(-1, sum(rows), n)
    parts = np.split(values, np.cumsum(rows)[:-1], axis=1)
    return {task.name: part for task, part in zip(tasks, parts, strict=True)}


def difference(ours: Floats, theirs: Floats) -> float:
    """Of one task's results: the largest over [A], {f} or {ydot}, relative to the largest entry of each."""
    if ours.shape[1] == 1:
        return _relative(ours, theirs)
    return max(_relative(ours[:, :-1], theirs[:, :-1]), _relative(ours[:, -1:], theirs[:, -1:]))


def _relative(ours: Floats, theirs: Floats) -> float:
    error = np.abs(ours - theirs).max(axis=(1, 2)) / np.abs(theirs).max(axis=(1, 2))
    return float(np.max(np.nan_to_num(error, nan=np.inf)))
