"""Integration in steps of fixed length."""

from __future__ import annotations

import math

import numpy as np

from kanegen.errors import SingularError
from kanegen.library.simulation.motion import Motion
from kanegen.library.simulation.steps import CompensatedSum, Step, Sum
from kanegen.model.arguments import Floats
from kanegen.model.arrays import Floats as Doubles

SLACK = 1e-9
"""A step may be this much longer than asked, so that rounding does not add one to an interval."""


def integrate(
    motion: Motion, start: Floats, times: Doubles, method: Step, step: float, compensated: bool
) -> Floats:
    """(T, *state) at every time; each interval is cut into equal steps of at most `step`.

    Raises:
        SingularError: If the state stops being finite.
    """
    total = (CompensatedSum if compensated else Sum)(start)
    found = [start]
    for begin, end in zip(times[:-1].tolist(), times[1:].tolist(), strict=True):
        count = max(1, math.ceil((end - begin) / step * (1 - SLACK)))
        length = (end - begin) / count
        for i in range(count):
            total.add(method(motion, begin + i * length, length, total.state))
        if not np.isfinite(total.state).all():
            raise SingularError(
                f"at t = {end:.9g} s: the state is not finite. Take a smaller step than {step!r} s."
            )
        found.append(total.state)
    return np.stack(found)
