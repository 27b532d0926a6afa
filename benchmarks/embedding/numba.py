"""Numba: calls by address inside of a compiled loop."""

from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks.embedding import arm
from benchmarks.embedding.alone import in_c
from benchmarks.embedding.row import Row, in_turns, turn_of
from kanegen.extras import module

LENGTH = 1000
"""Calls inside of a compiled loop."""


def measure() -> list[Row]:
    """Measure accelerations of panda_arm.

    Raises:
        MissingError: If Numba is not installed.
    """
    numba = module("numba", extra="numba")
    panda, one = arm.library(), arm.states()
    forward_dynamics = panda.c_function("forward_dynamics")

    @numba.njit  # type: ignore[untyped-decorator]
    def loop(x: Any, y: Any, tau: Any, found: Any) -> int:
        failed = 0
        for _ in range(LENGTH):
            failed += forward_dynamics(x.ctypes, y.ctypes, tau.ctypes, found.ctypes)
        return failed

    alone = in_c(panda.source, "forward_dynamics", one)
    given = (*one.values(), np.empty(7))
    turns = in_turns(alone, lambda: turn_of(lambda: loop(*given)) / LENGTH)
    return [Row("Numba", f"in a compiled loop, {arm.WHAT}", *turns, f"Numba {numba.__version__}")]
