"""Exact results of one system, computed once for each state, and the errors of variants beside them.

The exact results are enclosures by `measure.truth`. They are the expensive part of a study, so they are kept:
all variants of a system are measured in the same states.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kanegen.c.formats import formats
from kanegen.c.minimax import minimax
from kanegen.errors import KanegenWarning, SingularError
from kanegen.library import Library
from kanegen.measure.timing import BATCH, LATENCY
from kanegen.measure.truth.certify import truth
from kanegen.measure.truth.measurement import ExactState, Measurement
from kanegen.model.system import System
from kanegen.options import Variant
from kanegen.program.precision import DOUBLE_DOUBLE
from kanegen.studies.tradeoff.domain import Sample

OUTPUT = "forward_dynamics"
"""The output that is studied: {ydot} of x, y and tau."""


class ExactResults:
    """Exact accelerations {ydot} of one system in all states that were asked for.

    Args:
        system: The system; its parameters stand at their defaults.
    """

    def __init__(self, system: System) -> None:
        self.system = system
        self._states: dict[bytes, ExactState] = {}
        self._measurements: dict[tuple[bytes, ...], Measurement] = {}

    def states(self, sample: Sample) -> list[ExactState]:
        """Return the exact result in every state of a sample, computed on the first request.

        Raises:
            SingularError: If [A] is singular in a state.
        """
        for row, key in enumerate(sample.bits()):
            if key not in self._states:
                self._states[key] = self._exact_state(sample, row)
        return [self._states[key] for key in sample.bits()]

    def errors(self, library: Library, sample: Sample, objective: str = LATENCY) -> Measurement:
        """Return the errors of a library that was built from the system.

        Args:
            library: The library.
            sample: The states.
            objective: The way to call the library, one of `OBJECTIVES`.
        """
        values = compute_accelerations(library, sample, objective)
        return self.measure(values, sample, unit_roundoff(library.source.variant))

    def measure(self, values: NDArray[Any], sample: Sample, roundoff: float) -> Measurement:
        """Return the errors of accelerations from any source; equal accelerations are measured once.

        Args:
            values: (B, n) accelerations, or (B, n, 2) as sums of two numbers; NaN where there is no result.
            sample: The B states.
            roundoff: Relative error of one operation of the program that computed the accelerations.
        """
        key = (values.tobytes(), str(roundoff).encode(), *sample.bits())
        if key not in self._measurements:
            pairs = zip(values, self.states(sample), strict=True)
            self._measurements[key] = Measurement.from_rows(
                [exact.measured(OUTPUT, value, roundoff) for value, exact in pairs]
            )
        return self._measurements[key]

    def _exact_state(self, sample: Sample, row: int) -> ExactState:
        """Compute the exact result in one state of a sample."""
        force, torque = (None if load is None else load[row] for load in (sample.force, sample.torque))
        inputs = (sample.x[row], sample.y[row], sample.tau[row], force, torque)
        return ExactState.of(
            truth(self.system, *inputs, outputs=(OUTPUT,), unit_roundoff=DOUBLE_DOUBLE.roundoff)
        )


def compute_accelerations(library: Library, sample: Sample, objective: str) -> NDArray[Any]:
    """Return the (B, n) accelerations {ydot} of a library in a sample; NaN where it has no result.

    Args:
        library: The library.
        sample: The B states.
        objective: `BATCH` for one call with all states, `LATENCY` for a call for each state.
    """
    storage = formats(library.source.variant).storage
    loads = [load for load in (sample.force, sample.torque) if load is not None]
    arrays = [storage.from_doubles(array) for array in (sample.x, sample.y, sample.tau, *loads)]
    with warnings.catch_warnings(action="ignore", category=KanegenWarning):
        if objective == BATCH:
            return library.forward_dynamics(*arrays)
        nothing = storage.from_doubles(np.full(sample.tau.shape[1], np.nan))
        return np.array([_accelerations_of_one(library, row, nothing) for row in zip(*arrays, strict=True)])


def _accelerations_of_one(library: Library, row: tuple[Any, ...], nothing: NDArray[Any]) -> NDArray[Any]:
    """Return the (n,) accelerations in one state; `nothing` if [A] is singular there."""
    try:
        return library.forward_dynamics(*row)
    except SingularError:
        return nothing


def unit_roundoff(variant: Variant) -> float:
    """Return the relative error of one operation of a variant.

    This is its unit roundoff or, where that is larger, the error of its sine and cosine.
    """
    used = formats(variant)
    roundoff = max(used.arithmetic.roundoff, used.storage.roundoff)
    kind, _, degree = variant.sincos.partition("-")
    return max(roundoff, minimax(int(degree), used.arithmetic).error) if kind == "polynomial" else roundoff
