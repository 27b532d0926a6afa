"""The extrapolated midpoint rule of Gragg, Bulirsch and Stoer, in steps of fixed length."""

from __future__ import annotations

from kanegen.model.arguments import Floats
from kanegen.simulation.motion import Motion

SUBSTEPS = (2, 4, 6, 8)
"""Numbers of equal parts of a step; each adds 2 to the order."""

EVALUATIONS = 1 + sum(count - 1 for count in SUBSTEPS)
"""Evaluations of the rates in a step."""

ORDER = 2 * len(SUBSTEPS)


def extrapolation(motion: Motion, time: float, step: float, state: Floats) -> Floats:
    """Return the change of a state by a method of order 8, in 17 evaluations.

    A step is made by the explicit midpoint rule in 2, 4, 6 and 8 equal parts. The errors of these changes are
    even powers of the length of the parts, whose first three are eliminated by extrapolation (Hairer, Norsett
    and Wanner, Solving Ordinary Differential Equations I, section II.9, without smoothing).
    """
    first = motion(time, state)
    row: list[Floats] = []
    for j, count in enumerate(SUBSTEPS):
        length = step / count
        before, change = 0.0 * first, length * first
        for k in range(1, count):
            rates = motion(time + k * length, state + change)
            before, change = change, before + (2 * length) * rates
        above, row = row, [change]
        for k in range(j):
            ratio = (count / SUBSTEPS[j - k - 1]) ** 2
            row.append(row[k] + (row[k] - above[k]) / (ratio - 1))
    return row[-1]
