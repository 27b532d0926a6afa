"""Steps of fixed length: how far a state moves in one."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from kanegen.library.simulation.motion import Motion
from kanegen.model.arguments import Floats

Step = Callable[[Motion, float, float, Floats], Floats]
"""The change of a state within a step, from the time, the length of the step and the state."""


def runge_kutta(motion: Motion, time: float, step: float, state: Floats) -> Floats:
    """The classical method of order 4: four evaluations."""
    k1 = motion(time, state)
    k2 = motion(time + step / 2, state + (step / 2) * k1)
    k3 = motion(time + step / 2, state + (step / 2) * k2)
    k4 = motion(time + step, state + step * k3)
    return (step / 6) * (k1 + 2 * (k2 + k3) + k4)


def semi_implicit_euler(motion: Motion, time: float, step: float, state: Floats) -> Floats:
    """Order 1: speeds first, then coordinates with the new speeds; one evaluation."""
    x, y = motion.state.x(state), motion.state.y(state)
    acceleration, power = motion.accelerations(time, x, y)
    change = step * acceleration
    return motion.state.join(step * motion.rates(time, x, y + change), change, step * power)


class Leapfrog:
    """Order 2, half a step of the speeds on either side of one of the coordinates; one evaluation.

    Where accelerations depend on speeds the evaluation takes those that the accelerations before it predict.
    It is for speeds that are rates of coordinates.
    """

    def __init__(self) -> None:
        self._before: tuple[Floats, Floats] | None = None

    def __call__(self, motion: Motion, time: float, step: float, state: Floats) -> Floats:
        """The change of a state; the next call continues from there."""
        x, y = motion.state.x(state), motion.state.y(state)
        before, power_before = self._before or motion.accelerations(time, x, y)
        change = step * (y + (step / 2) * before)
        after, power = motion.accelerations(time + step, x + change, y + step * before)
        self._before = after, power
        return motion.state.join(change, (step / 2) * (before + after), (step / 2) * (power_before + power))


class Sum:
    """The running sum of a state and its changes."""

    def __init__(self, state: Floats) -> None:
        self.state = state

    def add(self, change: Floats) -> None:
        """Rounded once."""
        self.state = self.state + change


class CompensatedSum(Sum):
    """The same, with what every addition rounds off kept and added to the next change.

    What is rounded off is found without error by six operations, whichever number is larger (Knuth 1998,
    section 4.2.2); Kahan (1965) made the sum.
    """

    def __init__(self, state: Floats) -> None:
        super().__init__(state)
        self._lost = np.zeros_like(state)

    def add(self, change: Floats) -> None:
        """Rounded once, and the rounding remembered."""
        old, change = self.state, change + self._lost
        new = old + change
        part = new - old
        self._lost = (old - (new - part)) + (change - part)
        self.state = new
