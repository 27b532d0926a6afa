"""Steps of fixed length in NumPy, and sums of the state and its changes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from kanegen.errors import StatusError
from kanegen.library.native.status import NO_CONVERGENCE, TOO_LONG
from kanegen.model.arguments import Floats
from kanegen.simulation.motion import Motion, StateLayout

_MOST_ITERATIONS = 100
"""Iterations of the implicit midpoint method; each gains a factor of about step times the fastest rate."""

Step = Callable[[Motion, float, float, Floats], Floats]
"""Function that returns the change of a state in one step, from motion, time (s), step (s) and state."""


def runge_kutta(motion: Motion, time: float, step: float, state: Floats) -> Floats:
    """Return the change of a state by the classical Runge-Kutta method of order 4, in four evaluations."""
    k1 = motion(time, state)
    k2 = motion(time + step / 2, state + (step / 2) * k1)
    k3 = motion(time + step / 2, state + (step / 2) * k2)
    k4 = motion(time + step, state + step * k3)
    return (step / 6) * (k1 + 2 * (k2 + k3) + k4)


def semi_implicit_euler(motion: Motion, time: float, step: float, state: Floats) -> Floats:
    """Return the change of a state by a method of order 1, in one evaluation.

    The speeds change first, and the coordinates change with the new speeds. Where [A] is constant and forces
    depend on {x} alone, the method is symplectic, and the energy stays near its value. Elsewhere it drifts.
    """
    x, y = motion.state.x(state), motion.state.y(state)
    acceleration, power = motion.accelerations(time, x, y)
    change = step * acceleration
    return motion.state.join(step * motion.rates(time, x, y + change), change, step * power)


class Leapfrog:
    """Method of order 2: a step of the coordinates between two half steps of the speeds, in one evaluation.

    Accelerations that depend on speeds are evaluated with the speeds that the previous accelerations predict.
    The method needs speeds that are rates of coordinates. Where [A] is constant and forces depend on {x}
    alone, it is symplectic and symmetric in time, and the energy stays near its value. Elsewhere it is
    neither, and the energy drifts.
    """

    def __init__(self) -> None:
        """Begin an integration; the first step evaluates the accelerations twice."""
        self._before: tuple[Floats, Floats] | None = None

    def __call__(self, motion: Motion, time: float, step: float, state: Floats) -> Floats:
        """Return the change of a state; the next call must continue from the state that results."""
        x, y = motion.state.x(state), motion.state.y(state)
        before, power_before = self._before or motion.accelerations(time, x, y)
        change = step * (y + (step / 2) * before)
        after, power = motion.accelerations(time + step, x + change, y + step * before)
        self._before = after, power
        return motion.state.join(change, (step / 2) * (before + after), (step / 2) * (power_before + power))


def implicit_midpoint(motion: Motion, time: float, step: float, state: Floats) -> Floats:
    """Return the change of a state by the rate in the middle of the straight line to the next state.

    The method has order 2 and is symmetric in time. It keeps invariants that are quadratic in the state, such
    as lengths of quaternions and the energy of a body that turns about its mass centre (Hairer, Lubich and
    Wanner, Geometric Numerical Integration, sections IV.2 and XI.1). The rate is found by fixed-point
    iteration, until its changes are rounding errors.

    Raises:
        StatusError: If the iteration does not converge, or the first state has no rates.
    """
    roundoff = np.finfo(state.dtype).eps
    rate, before = motion(time + step / 2, state), np.inf
    for _ in range(_MOST_ITERATIONS):
        try:
            found = motion(time + step / 2, state + (step / 2) * rate)
        except StatusError:  # the iteration has left the states that have accelerations
            break
        change, rate = np.abs(step * (found - rate)), found
        size, largest = np.abs(step * rate), change.max()
        is_stagnant = before <= largest <= np.sqrt(roundoff) * size.max()
        if is_stagnant or (change <= 4 * roundoff * (np.abs(state) + size)).all():
            return step * rate
        before = largest
    raise StatusError(f"at t = {time:.9g} s: {NO_CONVERGENCE}: {TOO_LONG}")


class LengthKeeper:
    """Keeps the lengths of homogeneous coordinates within a factor of 2 of their first values.

    Steps change them, and long motions would let them overflow. Factors are powers of two, so that nothing is
    rounded.
    """

    def __init__(self, layout: StateLayout, start: Floats) -> None:
        """Remember the lengths of a first state."""
        self._layout = layout
        self._lengths = layout.lengths(start)

    def __call__(self, total: Sum) -> None:
        """Scale the homogeneous coordinates of a running sum whose lengths have changed by a factor of 2."""
        with np.errstate(all="ignore"):
            ratios = self._layout.lengths(total.state) / self._lengths
            exponents = np.rint(np.log2(ratios))
        if exponents.any() and np.isfinite(exponents).all():
            total.scale(self._layout, np.ldexp(np.ones_like(ratios), -exponents.astype(np.int32)))


class Sum:
    """The running sum of a state and its changes, rounded in every addition.

    Attributes:
        state: The sum so far.
    """

    def __init__(self, state: Floats) -> None:
        """Begin with the first state."""
        self.state = state

    def add(self, change: Floats) -> None:
        """Add the change of one step."""
        self.state = self.state + change

    def scale(self, layout: StateLayout, factors: Floats) -> None:
        """Multiply homogeneous coordinates of the state by powers of two, which rounds nothing."""
        self.state = layout.scaled(self.state, factors)


class CompensatedSum(Sum):
    """The running sum with the rounding error of each addition added to the next change.

    The rounding error is found exactly by six operations, whichever number is larger (Knuth 1998, section
    4.2.2); the sum is Kahan's (1965).
    """

    def __init__(self, state: Floats) -> None:
        """Begin with the first state and no rounding error."""
        super().__init__(state)
        self._lost = np.zeros_like(state)

    def add(self, change: Floats) -> None:
        """Add the change of one step and remember the rounding error."""
        old, change = self.state, change + self._lost
        new = old + change
        part = new - old
        self._lost = (old - (new - part)) + (change - part)
        self.state = new
