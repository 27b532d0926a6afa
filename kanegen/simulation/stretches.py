"""A motion as stretches of steps: fixed steps in NumPy, and the adaptive solvers of SciPy."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from kanegen.errors import SingularError, StatusError
from kanegen.extras import module
from kanegen.model.arguments import Floats
from kanegen.model.arrays import Floats as Doubles
from kanegen.simulation.integration import CompensatedSum, LengthKeeper, Step, Sum
from kanegen.simulation.motion import Motion

EXTRA = "study"
"""The extra that installs SciPy."""

FOLLOWING_TURNS = ("DOP853", "Radau")
"""Solvers of SciPy whose largest step may change on the way; others get one for the whole motion."""

_SLACK = 1e-9
"""Relative excess of a step over the largest step that is ignored, so that rounding adds no step."""

_PATIENCE = 0.2
"""Time in s after which a stretch ends, so that a motion that is interrupted loses no more."""

_LONGEST = 1024
"""Largest number of states of a stretch."""

Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Marks:
    """Times at which a step ends: those at which states are wanted, and those at which inputs jump.

    Attributes:
        times: (M,) increasing times, s.
        wanted: (M,) whether a state is wanted.
        breaks: (M,) whether an input may jump.
    """

    times: Doubles
    wanted: Flags
    breaks: Flags

    @classmethod
    def of(cls, times: Doubles, breaks: Doubles) -> Marks:
        """Return the marks of wanted times, and of breaks between the first and the last of them."""
        inside = breaks[(breaks > times[0]) & (breaks < times[-1])]
        both: Doubles = np.union1d(times, inside)
        return cls(both, np.isin(both, times), np.isin(both, inside))


@dataclass(frozen=True)
class Stretch:
    """States that follow each other; the first one is the last of the stretch before, or the start.

    Attributes:
        times: (K,) times, s.
        states: (K, ..., k) states.
        wanted: (K,) whether a state is wanted; the first one never is.
    """

    times: Doubles
    states: Floats
    wanted: Flags


class Integrator(Protocol):
    """A method with its step or tolerance, for one motion."""

    def stretches(self, start: Floats, marks: Marks, every: bool) -> Iterator[Stretch]:
        """Yield the motion from a first state.

        Args:
            start: (..., k) state at the first mark.
            marks: Times at which steps end.
            every: Whether all steps are wanted in stretches, not only those that end at marks.
        """

    def advance(self, time: float, state: Floats, until: float) -> Floats:
        """Return the state at a later time (s) within one step that begins at `time`."""


@dataclass(frozen=True)
class FixedSteps:
    """Steps of fixed length: each interval between two marks is cut into equal steps.

    Attributes:
        motion: Right side of the equations of motion.
        method: Function that returns the function of one step, which may remember the step before.
        step: Largest step, s.
        compensated: Whether the rounding errors of the additions to the state are compensated.
    """

    motion: Motion
    method: Callable[[], Step]
    step: float
    compensated: bool = False

    def stretches(self, start: Floats, marks: Marks, every: bool) -> Iterator[Stretch]:
        """Yield the motion from a first state, see `Integrator`."""
        total = (CompensatedSum if self.compensated else Sum)(start)
        rows = _Rows(float(marks.times[0]), start)
        try:
            for row in self._rows(total, marks, every):
                rows.add(*row)
                if rows.are_due:
                    yield rows.stretch()
        except (StatusError, KeyboardInterrupt):
            if rows.count > 1:  # what was computed before
                yield rows.stretch()
            raise
        if rows.count > 1:
            yield rows.stretch()

    def _rows(self, total: Sum, marks: Marks, every: bool) -> Iterator[tuple[float, Floats, bool]]:
        """Yield the time and the state after each step that is stored, and whether it is wanted."""
        layout = self.motion.state
        keep = LengthKeeper(layout, total.state) if layout.homogeneous else None
        method, wanted = self.method(), marks.wanted[1:].tolist()
        for (begin, end), is_wanted in zip(pairwise(marks.times.tolist()), wanted, strict=True):
            self.motion.interval = begin, end
            count = steps_between(begin, end, self.step)
            length = (end - begin) / count
            for i in range(count):
                total.add(method(self.motion, begin + i * length, length, total.state))
                if keep is not None:
                    keep(total)
                if i == count - 1:
                    yield end, total.state, is_wanted
                elif every:
                    yield begin + (i + 1) * length, total.state, False

    def advance(self, time: float, state: Floats, until: float) -> Floats:
        """Return the state at a later time (s) by one step from the state at `time`."""
        self.motion.interval = time, until
        total = Sum(state)
        total.add(self.method()(self.motion, time, until - time, state))
        return total.state


def steps_between(begin: float, end: float, step: float) -> int:
    """Return the number of equal steps between two times (s), none longer than `step` but for rounding."""
    return max(1, math.ceil((end - begin) / step * (1 - _SLACK)))


class _Rows:
    """The states of a stretch that grows."""

    def __init__(self, time: float, state: Floats) -> None:
        """Begin with a first state, which is not wanted."""
        self._begin(time, state)

    def _begin(self, time: float, state: Floats) -> None:
        self._times, self._states, self._wanted = [time], [state], [False]
        self._since = clock.monotonic()

    def add(self, time: float, state: Floats, is_wanted: bool) -> None:
        """Add the next state of the stretch."""
        self._times.append(time)
        self._states.append(state)
        self._wanted.append(is_wanted)

    @property
    def count(self) -> int:
        """How many states there are so far."""
        return len(self._times)

    @property
    def are_due(self) -> bool:
        """Whether the stretch is long enough, in states or in time."""
        return self.count > _LONGEST or (self.count > 1 and clock.monotonic() - self._since > _PATIENCE)

    def stretch(self) -> Stretch:
        """Return the stretch, and begin the next one with its last state."""
        found = Stretch(np.array(self._times), np.stack(self._states), np.array(self._wanted))
        self._begin(self._times[-1], self._states[-1])
        return found


@dataclass(frozen=True)
class AdaptiveSteps:
    """Steps of a solver of SciPy, which chooses them; it begins anew where inputs jump.

    Attributes:
        motion: Right side of the equations of motion.
        method: Name of the solver in SciPy.
        tolerance: Relative and absolute error of a step, 1, rad, m, rad/s and m/s.
    """

    motion: Motion
    method: str
    tolerance: float

    def stretches(self, start: Floats, marks: Marks, every: bool) -> Iterator[Stretch]:
        """Yield the motion from a first state, a stretch for each step; see `Integrator`."""
        ends = [*marks.times[marks.breaks].tolist(), float(marks.times[-1])]
        begin, state = float(marks.times[0]), start
        wanted = marks.times[marks.wanted]
        for end in ends:
            self.motion.interval = begin, end
            for solver in self._solved(begin, state, end):
                inside = wanted[(wanted > solver.t_old) & (wanted <= solver.t)]
                at = np.append(inside, solver.t) if every or not len(inside) else inside
                at = np.unique(at)
                between = solver.dense_output()(at).T if len(inside) else solver.y[None]
                between[at == solver.t] = solver.y
                times = np.concatenate([[begin], at])
                states = np.concatenate([state[None], between])
                yield Stretch(times, states, np.concatenate([[False], np.isin(at, inside)]))
                begin, state = float(at[-1]), between[-1]
            begin, state = end, solver.y
        self.motion.interval = -math.inf, math.inf

    def advance(self, time: float, state: Floats, until: float) -> Floats:
        """Return the state at a later time (s) by steps of the same tolerance."""
        if until <= time:
            return state
        self.motion.interval = time, until
        for solver in self._solved(time, state, until):
            found: Floats = solver.y
        return found

    def _solved(self, begin: float, state: Floats, end: float) -> Iterator[Any]:
        """Yield the solver after each of its steps.

        Raises:
            MissingError: If SciPy is not installed.
            SingularError: If the solver fails.
        """
        kind = getattr(module("scipy.integrate", extra=EXTRA), self.method)
        turns = self.motion.inputs.turns
        options = {} if self.method in FOLLOWING_TURNS else {"max_step": min(turns.finest, turns.longest)}
        solver = kind(self.motion, begin, state, end, rtol=self.tolerance, atol=self.tolerance, **options)
        while solver.status == "running":
            solver.max_step = turns.step_from(solver.t)
            message = solver.step()
            if solver.status == "failed":
                raise SingularError(f"at t = {solver.t:.9g} s: {self.method} gives up. {message}")
            yield solver
