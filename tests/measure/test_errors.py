"""Quantiles of errors over states."""

from __future__ import annotations

import math

import numpy as np

from kanegen.measure.errors import Errors, quantile


def some_errors(*normwise: float) -> Errors:
    """Return errors whose normwise and componentwise parts are the same."""
    values = np.array(normwise)
    return Errors(values, values)


def test_quantile_of_errors_is_one_of_them() -> None:
    errors = np.array([3.0, 1.0, math.nan, 2.0])
    assert quantile(errors, 1.0) == math.inf
    assert quantile(errors, 0.75) == 3.0
    assert quantile(errors, 0.5) == 2.0


def test_quantiles_are_errors_of_states_and_count_failures() -> None:
    errors = some_errors(*range(1, 100), np.inf)
    assert (errors.median, errors.p99, errors.max, errors.worst) == (50, 99, np.inf, 99)
    assert errors.failed.sum() == 1
    assert errors[[0, 1]].max == 2
