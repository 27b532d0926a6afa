"""The arm that the calls of several programs compute: accelerations of panda_arm in random states."""

from __future__ import annotations

import numpy as np

import kanegen as kg

WHAT = "forward_dynamics of panda_arm"
"""What is called, as rows say it."""

Arrays = dict[str, np.ndarray]


def library() -> kg.Library:
    """Return the compiled arm."""
    return kg.build(kg.load("models/panda_arm.toml"), ("forward_dynamics",))


def states(count: int | None = None) -> Arrays:
    """Return inputs of one state or of many, by name."""
    shape = (7,) if count is None else (count, 7)
    rng = np.random.default_rng(1)
    return {name: rng.uniform(-1, 1, shape) for name in ("x", "y", "tau")}
