"""Times at which expressions of the time turn, so that no method steps over a short push unseen."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from kanegen.library import Library
from kanegen.model.arguments import Floats
from kanegen.model.arrays import Floats as Doubles
from kanegen.model.expression import Expression, Parameter
from kanegen.model.nodes import TIME
from kanegen.reference.expressions import evaluate
from kanegen.simulation.signals import state_variables

SAMPLES = 2**16
"""Number of equal intervals of a motion at whose ends expressions of the time are sampled."""

CALLS = 200
"""Smallest number of adaptive steps of a motion on which a function of time and state of the caller acts."""

FINER = 2**4
"""Number of samples of expressions between two samples of functions of the caller, which are slower."""

_SMALL = 1e-11
"""Share of the largest value below which a difference counts as none."""

_PASSING = 16
"""Multiple of the difference that counts as none below which one is close to a zero of a smooth signal."""

_MOVED = (0.0, 0.5)
"""What is added to all variables of the first state, so that a factor that is zero there hides nothing."""


@dataclass(frozen=True)
class Turns:
    """Times at which an adaptive method has to look at what acts.

    Attributes:
        times: (K,) increasing times, s: those at which a signal begins or ceases to change, at which it has
            an extremum or an inflection, and the ends of its jumps, each to the next sample.
        sampling: Interval between two samples, s.
        longest: Largest step, s.
    """

    times: Doubles
    sampling: float = 0.0
    longest: float = np.inf

    def step_from(self, time: float) -> float:
        """Return the largest step (s) from a time, which leads to the next turn at most."""
        place = int(np.searchsorted(self.times, time + 0.5 * self.sampling))
        until = self.times[place] - time if place < len(self.times) else np.inf
        return max(float(min(until, self.longest)), 20.0 * float(np.spacing(abs(time))))

    @property
    def finest(self) -> float:
        """Smallest interval between two turns, s, where those within four samples of another count as one.

        It is infinite where there are no two.
        """
        gaps = np.diff(self.times)
        return float(np.min(gaps[gaps > 3.5 * self.sampling], initial=np.inf))


NO_TURNS = Turns(np.empty(0))
"""Nothing depends on the time alone."""


Sampled = Callable[[Doubles], tuple[Doubles, ...]]
"""Function that returns rows of values at (K,) times (s)."""


@dataclass(frozen=True)
class Acting:
    """What acts from outside, as far as it may turn.

    Attributes:
        expressions: Expressions, with numbers in place of parameters.
        functions: Functions of the caller.
        has_effort: Whether a function of time and state acts. It may remember calls, so it is not sampled.
    """

    expressions: tuple[Expression, ...]
    functions: tuple[Sampled, ...] = ()
    has_effort: bool = False


def turns_of(library: Library, acting: Acting, times: Doubles, x: Floats, y: Floats) -> Turns:
    """Return the turns of what acts on a motion.

    Args:
        library: The library, whose model may have force elements that depend on the time.
        acting: What acts from outside.
        times: (T,) times of the motion, s.
        x: (..., m) first coordinates; those of the first one of several states are taken.
        y: (..., n) first generalized speeds.
    """
    begin, end = float(times[0]), float(times[-1])
    longest = (end - begin) / CALLS if acting.has_effort else np.inf
    of_time = [one for one in (*acting.expressions, *_of_model(library)) if TIME in one.variables]
    if not of_time and not acting.functions:
        return Turns(np.empty(0), longest=longest)
    samples = np.linspace(begin, end, SAMPLES + 1)
    state = state_variables(library, x.reshape(-1, x.shape[-1])[0], y.reshape(-1, y.shape[-1])[0])
    found = np.zeros(len(samples), np.bool_)
    for expression in of_time:
        for moved in _MOVED if len(expression.variables) > 1 else _MOVED[:1]:
            found |= _turning(samples, _values(expression, samples, state, moved))
    for function in acting.functions:
        for values in function(samples[::FINER]):
            found[::FINER] |= _turning(samples[::FINER], np.where(np.isfinite(values), values, 0.0))
    return Turns(samples[found], (end - begin) / SAMPLES, longest)


def _of_model(library: Library) -> list[Expression]:
    """Return the expressions of the force elements of a model, with the library's values of parameters."""
    system = library.source.system
    if system is None or not system.depends_on_time:
        return []
    values = library.parameters

    def number(one: float | Parameter) -> float:
        return values.get(one.name, one.value) if isinstance(one, Parameter) else one

    elements = system.named_force_elements
    return [one.map_numbers(number) for element in elements for one in element.expressions()]


def _values(expression: Expression, times: Doubles, state: Mapping[str, Any], moved: float) -> Doubles:
    """Return the values of an expression at many times in one state; 0 where it has no finite value."""
    variables = {name: np.float64(state.get(name, 0.0)) + moved for name in expression.variables}
    with np.errstate(all="ignore"):
        found = evaluate(expression, variables | {TIME: times}, np.float64)
    values = np.broadcast_to(np.asarray(found, np.float64), times.shape)
    return np.where(np.isfinite(values), values, 0.0)


def _turning(times: Doubles, values: Doubles) -> np.ndarray:
    """Return at which samples the sign of a first or second difference changes, zero being a sign of its own.

    Differences that rounding of the values and of the times makes count as zero.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        values = values / (np.abs(values).max() or 1.0)
    first = np.diff(values)
    roundoff = np.finfo(np.float64).eps * np.abs(times[[0, -1]]).max() / (times[1] - times[0])
    small = _SMALL + 8 * roundoff * np.abs(first).max()
    slopes, bends = (_signs(one, small) for one in (first, np.diff(first)))
    found = np.zeros(len(values), np.bool_)
    found[1:-1] |= slopes[1:] != slopes[:-1]
    found[2:-1] |= bends[1:] != bends[:-1]
    return found


def _signs(differences: Doubles, small: float) -> Doubles:
    """Return the signs of differences, 0 for small ones, unless these pass from one sign to the other.

    Where a smooth signal has an extremum or an inflection, its differences are small on both sides of it; so
    there is one change of the sign, in the middle, and not a change to 0 and another from 0.
    """
    signs = np.where(np.abs(differences) > small, np.sign(differences), 0.0)
    is_zero = np.concatenate([[False], signs == 0, [False]])
    begins, ends = np.flatnonzero(np.diff(is_zero.astype(np.int8))).reshape(-1, 2).T
    inner = (begins > 0) & (ends < len(signs))
    for begin, end in zip(begins[inner].tolist(), ends[inner].tolist(), strict=True):
        sides = differences[[begin - 1, end]]
        if sides[0] * sides[1] < 0 and np.abs(sides).max() < _PASSING * small:
            middle = (begin + end + 1) // 2
            signs[begin:middle], signs[middle:end] = np.sign(sides)
    return signs
