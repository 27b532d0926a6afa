"""Proven bounds on the errors of accelerations, state by state, from the output `error_bound`."""

from __future__ import annotations

import functools
import math
import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kanegen import compiler
from kanegen.errors import KanegenError, KanegenWarning
from kanegen.library import Library
from kanegen.measure.errors import quotient, scaled_norm
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.studies.tradeoff.domain import Sample
from kanegen.studies.tradeoff.exact_results import OUTPUT, ExactResults


def entry_bounds(system: System, sample: Sample, values: NDArray[Any]) -> Floats:
    """Return (B, n) proven bounds on the errors of accelerations; infinite where there is none.

    Args:
        system: The system of the accelerations, whose parameters stand at their defaults.
        sample: The B states.
        values: (B, n) accelerations {ydot} from any program. If they have more digits than doubles, there is
            no bound.
    """
    library = _bounding_library(system)
    if library is None or values.ndim > 2 or values.dtype.itemsize > np.dtype(np.float64).itemsize:
        return np.full(sample.tau.shape, math.inf)
    loads = [load for load in (sample.force, sample.torque) if load is not None]
    with warnings.catch_warnings(action="ignore", category=KanegenWarning):
        found = library.error_bound(sample.x, sample.y, values.astype(np.float64), sample.tau, *loads)
    bounds = found.astype(np.float64)
    return np.where(np.isnan(bounds), math.inf, bounds)


def normwise_bounds(
    exact: ExactResults, sample: Sample, values: NDArray[Any], relative_to_terms: bool = False
) -> Floats:
    """Return (B,) proven bounds on the normwise errors of accelerations; infinite where there is none.

    Args:
        exact: Exact results of the system of the accelerations.
        sample: The B states.
        values: (B, n) accelerations {ydot} from any program.
        relative_to_terms: Whether the errors are relative to the terms of {ydot}, else to {ydot}.
    """
    bounds, states = entry_bounds(exact.system, sample, values), exact.states(sample)
    scales = np.array([state.scales[OUTPUT] for state in states])
    if relative_to_terms:
        size = np.array([state.terms[OUTPUT] for state in states])
    else:
        size = scaled_norm(np.array([state.outputs[OUTPUT].value for state in states]), scales)
    return quotient(scaled_norm(bounds, scales), size)


@functools.lru_cache(maxsize=4)
def _bounding_library(system: System) -> Library | None:
    """Return the library of the output `error_bound` in double precision; None if the system has none."""
    try:
        return compiler.build(system, ("error_bound",), on_status="ignore")
    except KanegenError:
        return None
