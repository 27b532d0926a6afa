"""A small sweep that several tests run: a double pendulum in 48 rows, in chunks of 8, one of which fails."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import kanegen as kg
from tests.support.paths import MODELS

AXES: dict[Any, Any] = {
    "m2": [0.5, 1.0, -1.0],
    "x.q1": {"uniform": [-2.0, 2.0]},
    "x.q2": "x.q1/2 + 0.1*l1",
    "tau.q2": "0.3*m2*sin(2*t)",
}
RESULTS = ("end.x", "max.y.q2", "drift.energy", "path.x.q1")


def pendulum() -> kg.System:
    return kg.load(MODELS / "double_pendulum.toml")


def job(duration: float = 0.4, **changes: Any) -> kg.RolloutJob:
    usual: dict[str, Any] = {"step": 0.01, "results": RESULTS, "bands": "x.q1", "every": 4}
    return kg.RolloutJob(duration, **{**usual, **changes})


def swept(executor: Any = None, **options: Any) -> kg.SweepResult:
    return kg.sweep(pendulum(), AXES, job(), executor, samples=16, **{"chunk_rows": 8, **options})


def digests(folder: Path) -> dict[str, str]:
    """Return the digest of every file in a folder by its path."""
    files = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}
