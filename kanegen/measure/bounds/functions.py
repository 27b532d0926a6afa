"""Ranges, slopes and jumps of exp, log, tanh and atan2, and of signs, minima, maxima and conditions.

A slope is the interval of all quotients of a change of the result by a change of one operand, between the
exact and the computed operand. A jump is what the result can change where rounding errors of an operand
decide a sign, a condition, or the side of the half-line y = 0, x < 0 at which the angle of a point jumps.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kanegen.measure.bounds.intervals import Intervals, point, up_sum
from kanegen.model.arrays import Floats
from kanegen.program.ir import CHOICES, TRANSCENDENTAL, Op

FUNCTIONS = (*CHOICES, *TRANSCENDENTAL)
"""The operations that are functions here."""

_NUMPY = 2.0**-47
"""More than the relative errors of NumPy's functions, which are a few units in the last place."""

_LEAST = 5e-324
"""The smallest double."""

_TURN = 6.2831853071795871
"""More than 2 pi."""

_HALF_TURN = 3.1415926535897936
"""More than pi."""

_UNIT = Intervals(np.zeros(()), np.ones(()))


def range_of(op: Op, operands: Sequence[Intervals]) -> Intervals:
    """Return the range of a function over the ranges of its operands; without bound where it is undefined."""
    a = operands[0]
    match op:
        case Op.SIGN:
            return Intervals(np.sign(a.low), np.sign(a.high))
        case Op.MIN:
            return Intervals(np.minimum(a.low, operands[1].low), np.minimum(a.high, operands[1].high))
        case Op.MAX:
            return Intervals(np.maximum(a.low, operands[1].low), np.maximum(a.high, operands[1].high))
        case Op.SELECT:
            return _chosen(a, operands[1], operands[2])
        case Op.LOG:
            found = _increasing(np.log, Intervals(np.maximum(a.low, _LEAST), np.maximum(a.high, _LEAST)))
            positive = a.low > 0
            return Intervals(np.where(positive, found.low, -np.inf), np.where(positive, found.high, np.inf))
        case Op.ATAN2:
            return _angles(a, operands[1])
    return _increasing({Op.EXP: np.exp, Op.TANH: np.tanh}[op], a)


def slopes(op: Op, computed: Sequence[Intervals]) -> list[Intervals | None]:
    """Return the slope by each operand, over ranges that hold exact and computed operands; None is 0."""
    a = computed[0]
    match op:
        case Op.SIGN:
            return [None]
        case Op.MIN:
            return _weights(-a, -computed[1])
        case Op.MAX:
            return _weights(a, computed[1])
        case Op.SELECT:
            return [None, _weight(a.low > 0, a.high <= 0), _weight(a.high <= 0, a.low > 0)]
        case Op.EXP:
            return [range_of(op, [a])]
        case Op.LOG:
            return [a.reciprocal()]
        case Op.TANH:
            return [_UNIT]
    around = point((1 + _NUMPY) / _distance(a, computed[1])).symmetric()
    return [around, around]


def jump_of(op: Op, computed: Sequence[Intervals], errors: Sequence[Floats]) -> Floats:
    """Return a bound of the jump of a result.

    Args:
        op: The function.
        computed: Ranges that hold the exact and the computed operands.
        errors: Bounds of the errors of the operands; 0 and the smallest double mean that there is none.
    """
    a = computed[0]
    changes = (a.low <= 0) & (a.high >= 0) & (errors[0] > _LEAST)
    match op:
        case Op.SIGN:
            return np.where(changes, 2.0, 0.0)
        case Op.SELECT:
            both = computed[1].hull(computed[2])
            return np.where(changes & (a.high > 0), up_sum([(both - both).magnitude]), 0.0)
        case Op.ATAN2:
            return np.where(changes & (computed[1].low < 0), _TURN, 0.0)
    return np.zeros(())


def _increasing(function: Callable[..., Any], a: Intervals) -> Intervals:
    """Return the range of an increasing function of NumPy."""
    low, high = function(a.low), function(a.high)
    return Intervals(low - (np.abs(low) * _NUMPY + _LEAST), high + (np.abs(high) * _NUMPY + _LEAST))


def _chosen(condition: Intervals, a: Intervals, b: Intervals) -> Intervals:
    """Return the range of a choice, that of both branches where the condition may hold or not."""
    either, first, second = a.hull(b), condition.low > 0, condition.high <= 0
    return Intervals(
        np.where(first, a.low, np.where(second, b.low, either.low)),
        np.where(first, a.high, np.where(second, b.high, either.high)),
    )


def _weights(a: Intervals, b: Intervals) -> list[Intervals | None]:
    """Return the slopes of the larger of two numbers."""
    return [_weight(a.low > b.high, a.high < b.low), _weight(a.high < b.low, a.low > b.high)]


def _weight(certain: NDArray[np.bool_], excluded: NDArray[np.bool_]) -> Intervals:
    """Return the slope by an operand that is the result, is not the result, or may be it."""
    return Intervals(np.where(certain, 1.0, 0.0), np.where(excluded, 0.0, 1.0))


def _angles(y: Intervals, x: Intervals) -> Intervals:
    """Return the range of the angles of points; that of a box is between those of its corners."""
    corners = [np.arctan2(a + 0.0, b + 0.0) for a in (y.low, y.high) for b in (x.low, x.high)]
    low, high = np.minimum.reduce(corners), np.maximum.reduce(corners)
    plain = (y.low > 0) | (y.high < 0) | (x.low > 0)
    return Intervals(
        np.where(plain, low - (np.abs(low) * _NUMPY + _LEAST), -_HALF_TURN),
        np.where(plain, high + (np.abs(high) * _NUMPY + _LEAST), _HALF_TURN),
    )


def _distance(y: Intervals, x: Intervals) -> Floats:
    """Return a lower bound of the distance of points from the origin."""
    least = [np.maximum(0.0, np.maximum(side.low, -side.high)) for side in (y, x)]
    found: Floats = np.maximum(*least)
    return found
