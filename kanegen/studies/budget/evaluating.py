"""What a library computes in a sample, by the function whose time has the budget."""

from __future__ import annotations

import hashlib

import numpy as np

from kanegen.library import Library
from kanegen.model.arrays import Floats
from kanegen.studies.tradeoff.judge import Judge, computed
from kanegen.studies.tradeoff.samples import Sample


def errors(judge: Judge, library: Library, sample: Sample, objective: str) -> Floats:
    """(B,) normwise errors of {ydot}; infinite where it is not finite, or not a solution at all."""
    found = judge.errors(library, sample, objective)
    return np.where(found.wrong | ~np.isfinite(found.normwise), np.inf, found.normwise)


def bits(library: Library, sample: Sample, objective: str) -> str:
    """A digest of the results to the last bit; all NaN count as one.

    Numbers longer than a double count as the nearest double and the rest, because their bytes have gaps.
    """
    values = computed(library, sample, objective).copy()
    values[np.isnan(values)] = np.nan
    parts = [values]
    if values.dtype.itemsize > np.dtype(np.float64).itemsize:
        near = values.astype(np.float64)
        parts = [near, (values - near).astype(np.float64)]
    return hashlib.sha256(b"".join(np.ascontiguousarray(part).tobytes() for part in parts)).hexdigest()
