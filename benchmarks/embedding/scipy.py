"""SciPy: the right side of the equations of motion, as `solve_ivp` calls it."""

from __future__ import annotations

import numpy as np

from benchmarks.embedding import arm
from benchmarks.embedding.alone import in_c
from benchmarks.embedding.row import Row, in_turns, turn_of
from kanegen.extras import module


def measure() -> list[Row]:
    """Measure the rates of panda_arm.

    Raises:
        MissingError: If SciPy is not installed.
    """
    scipy = module("scipy", extra="study")
    panda, one = arm.library(), arm.states()
    alone = in_c(panda.source, "forward_dynamics", one)
    rhs, state = panda.rhs(tau=one["tau"]), np.concatenate([one["x"], one["y"]])
    turns = in_turns(alone, lambda: turn_of(lambda: rhs(0.0, state)))
    return [Row("SciPy", f"rhs, {arm.WHAT}", *turns, f"SciPy {scipy.__version__}")]
