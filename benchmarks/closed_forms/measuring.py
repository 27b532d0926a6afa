"""Operations, values and CPU times of the closed forms of one system."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from sympy import Expr, Float, Matrix
from sympy.core.cache import clear_cache

from benchmarks.closed_forms.cases import Case, Entries

STATES = 5
"""Number of random states in which forms are compared."""

AGREEMENT = 1e-12
"""Largest difference of equal forms, relative to the largest entry: roundings of a hundred operations."""


@dataclass(frozen=True)
class Result:
    """The three forms of one system.

    Attributes:
        case: The system.
        kanegen: Operations of kanegen in [A] and {f}.
        kanes_method: Operations of KanesMethod after `simplify`.
        textbook: Operations of the textbook.
        seconds: CPU time of kanegen (s).
        kanes_seconds: CPU time of KanesMethod with `simplify` (s).
        difference: Largest difference of the forms, relative to the largest entry.
    """

    case: Case
    kanegen: tuple[int, int]
    kanes_method: tuple[int, int]
    textbook: tuple[int, int]
    seconds: float
    kanes_seconds: float
    difference: float

    @property
    def agrees(self) -> bool:
        """Whether the three forms have the same values."""
        return self.difference <= AGREEMENT


def measured(case: Case, rounds: int) -> Result:
    """Return operations, CPU times (the smallest of some rounds) and the largest difference."""
    seconds, form = _timed(case.closed_form, rounds)
    kanes_seconds, by_kane = _timed(case.by_kanes_method, rounds)
    own, book = Entries(Matrix(form.A), Matrix(form.f)), case.of_textbook()
    return Result(
        case,
        own.operations,
        by_kane.operations,
        book.operations,
        seconds,
        kanes_seconds,
        max(difference(own, other) for other in (by_kane, book)),
    )


def difference(one: Entries, other: Entries) -> float:
    """Return the largest difference of two forms in random states, relative to the largest entry.

    Coordinates are between 0.05 and 0.2: springs of the quarter car have the direction of {x} = {0} there.
    """
    rng = np.random.default_rng(0)
    symbols = sorted(
        one.A.free_symbols | one.f.free_symbols | other.A.free_symbols | other.f.free_symbols, key=str
    )
    worst = 0.0
    for _ in range(STATES):
        values = {
            symbol: Float(value)
            for symbol, value in zip(symbols, rng.uniform(0.05, 0.2, len(symbols)), strict=True)
        }
        for a, b in ((one.A, other.A), (one.f, other.f)):
            found, expected = _numbers(a, values), _numbers(b, values)
            worst = max(worst, float(np.abs(found - expected).max() / max(np.abs(expected).max(), 1e-300)))
    return worst


def _numbers(matrix: Matrix, values: dict[Expr, Expr]) -> Any:
    """Return the values of a matrix, computed in 20 digits."""
    return np.array(matrix.xreplace(values).evalf(20), dtype=float)


def _timed(work: Callable[[], Any], rounds: int) -> tuple[float, Any]:
    """Return the smallest CPU time of some rounds (s), each without SymPy's cache, and the last result."""
    times, result = [], None
    for _ in range(rounds):
        clear_cache()
        start = time.process_time()
        result = work()
        times.append(time.process_time() - start)
    return min(times), result
