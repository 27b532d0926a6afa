"""Minimax polynomials for sine and cosine up to pi/4.

    sin r = r (1 + z S(z)),   cos r = 1 + z C(z),   z = r^2

The leading 1 is exact, and so are sines and cosines of small angles. S minimises the largest relative error
of the sine, C the largest error of the cosine, by the exchange algorithm of Remez on a dense grid. The
arithmetic has 40 digits, so the coefficients, rounded once, are the same on every machine.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import mpmath
from mpmath import mpf

from kanegen.program.precision import Precision

GRID = 200
"""Number of grid points at which errors are evaluated."""

ROUNDS = 20
"""Largest number of exchanges of grid points; the points of largest error stop moving after a few."""

_CONTEXT = mpmath.mp.clone()
_CONTEXT.dps = 40

_Function = Callable[[mpf], mpf]


@dataclass(frozen=True)
class Minimax:
    """Polynomials of degrees d and d + 1 for sine and cosine.

    Attributes:
        sine: Coefficients of S, lowest first.
        cosine: Coefficients of C, lowest first.
        sine_error: Largest |polynomial - sin r| for |r| <= pi/4, roundoff aside.
        cosine_error: Largest |polynomial - cos r| for |r| <= pi/4, roundoff aside.
    """

    sine: tuple[float, ...]
    cosine: tuple[float, ...]
    sine_error: float
    cosine_error: float

    @property
    def error(self) -> float:
        """The larger of the two errors."""
        return max(self.sine_error, self.cosine_error)


@functools.cache
def minimax(degree: int, precision: Precision) -> Minimax:
    """Return the polynomials for a sine of odd `degree`, 3 or more, rounded to `precision`."""
    places = _places()
    sine = _remez(places, _sine, lambda z: z / _sinc(z), (degree - 1) // 2)
    cosine = _remez(places, _cosine, lambda z: z, (degree + 1) // 2)
    s, c = (tuple(float(precision.dtype.type(a)) for a in found) for found in (sine, cosine))
    return Minimax(
        s,
        c,
        _largest(places, lambda z: _CONTEXT.sqrt(z) * z * (_value(s, z) - _sine(z))),
        _largest(places, lambda z: z * (_value(c, z) - _cosine(z))),
    )


def _places() -> list[mpf]:
    """Return grid points z from near 0 to (pi/4)^2, denser at both ends like the extrema of the error."""
    angles = [_CONTEXT.pi * i / GRID for i in range(1, GRID + 1)]
    return [(_CONTEXT.pi / 4) ** 2 * (1 - _CONTEXT.cos(angle)) / 2 for angle in angles]


def _sinc(z: mpf) -> mpf:
    r = _CONTEXT.sqrt(z)
    return _CONTEXT.sin(r) / r


def _sine(z: mpf) -> mpf:
    """Return (sin r / r - 1)/z, the function that S approximates."""
    return (_sinc(z) - 1) / z


def _cosine(z: mpf) -> mpf:
    """Return (cos r - 1)/z, the function that C approximates."""
    return (_CONTEXT.cos(_CONTEXT.sqrt(z)) - 1) / z


def _value(coefficients: Sequence[mpf | float], z: mpf) -> mpf:
    return _CONTEXT.polyval(list(reversed(coefficients)), z)


def _largest(places: list[mpf], error: _Function) -> float:
    return float(max(abs(error(z)) for z in places))


def _remez(places: list[mpf], function: _Function, weight: _Function, count: int) -> list[mpf]:
    """Return `count` coefficients, lowest first, that minimise max |weight (polynomial - function)|."""
    values, weights = [function(z) for z in places], [weight(z) for z in places]
    chosen = [(len(places) - 1) * k // count for k in range(count + 1)]
    for _ in range(ROUNDS):
        rows = [
            [places[i] ** k for k in range(count)] + [(-1) ** sign / weights[i]]
            for sign, i in enumerate(chosen)
        ]
        solution = _CONTEXT.lu_solve(_CONTEXT.matrix(rows), _CONTEXT.matrix([values[i] for i in chosen]))
        found = list(solution)[:count]
        errors = [w * (_value(found, z) - v) for z, v, w in zip(places, values, weights, strict=True)]
        before, chosen = chosen, _exchanged(errors, count + 1)
        if chosen == before:
            break
    return found


def _exchanged(errors: list[mpf], count: int) -> list[int]:
    """Return `count` neighbouring grid points of alternating sign where the error between is largest."""
    peaks = [0]
    for i, error in enumerate(errors):
        if (error > 0) != (errors[peaks[-1]] > 0):
            peaks.append(i)
        elif abs(error) > abs(errors[peaks[-1]]):
            peaks[-1] = i
    while len(peaks) > count:
        peaks.pop(0 if abs(errors[peaks[0]]) < abs(errors[peaks[-1]]) else -1)
    return peaks
