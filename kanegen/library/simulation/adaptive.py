"""Integration with steps chosen by SciPy, from the extra `study`."""

from __future__ import annotations

import numpy as np

from kanegen.errors import SingularError
from kanegen.extras import module
from kanegen.library.simulation.motion import Motion
from kanegen.model.arguments import Floats
from kanegen.model.arrays import Floats as Doubles

EXTRA = "study"
"""The extra that brings SciPy."""


def integrate(motion: Motion, start: Floats, times: Doubles, method: str, tolerance: float) -> Doubles:
    """(T, state) at every time, by the solver of SciPy called `method`.

    Args:
        motion: The right side.
        start: State at the first time.
        times: Where states are wanted.
        method: Its name there.
        tolerance: Of a step, relative and absolute (rad, m, rad/s, m/s).

    Raises:
        MissingError: If SciPy is not installed.
        SingularError: If the solver gives up.
    """
    solve = module("scipy.integrate", extra=EXTRA).solve_ivp
    found = solve(motion, (times[0], times[-1]), start, method, t_eval=times, rtol=tolerance, atol=tolerance)
    if not found.success:
        raise SingularError(f"at t = {found.t[-1]:.9g} s: {method} gives up. {found.message}")
    states: Doubles = np.ascontiguousarray(found.y.T)
    return states
