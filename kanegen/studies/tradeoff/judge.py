"""Certified truth, computed once a state for all variants, and what a result is worth beside it."""

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
from kanegen.studies.tradeoff.samples import Sample

OUTPUT = "forward_dynamics"
"""What is studied: {ydot} of x, y and tau."""


class Judge:
    """Truths of one system; parameters stand at their defaults.

    Args:
        system: The tree.
    """

    def __init__(self, system: System) -> None:
        self.system = system
        self._known: dict[bytes, ExactState] = {}
        self._judged: dict[tuple[bytes, ...], Measurement] = {}

    def truths(self, sample: Sample) -> list[ExactState]:
        """The truth in every state, from memory where it was asked for before.

        Raises:
            SingularError: If [A] is singular in one.
        """
        for row, key in enumerate(sample.bits()):
            if key not in self._known:
                self._known[key] = self._exact(sample, row)
        return [self._known[key] for key in sample.bits()]

    def errors(self, library: Library, sample: Sample, objective: str = LATENCY) -> Measurement:
        """The errors of a library built from the system, called for one of `OBJECTIVES`."""
        return self.judged(computed(library, sample, objective), sample, unit(library.source.variant))

    def judged(self, values: NDArray[Any], sample: Sample, unit: float) -> Measurement:
        """The errors of results from anywhere; many variants have the same, which are judged once.

        Args:
            values: (B, n) accelerations, or (B, n, 2) as sums of two; NaN where there are none.
            sample: B states.
            unit: Relative error of an operation of the program that computed them.
        """
        key = (values.tobytes(), str(unit).encode(), *sample.bits())
        if key not in self._judged:
            pairs = zip(values, self.truths(sample), strict=True)
            self._judged[key] = Measurement.from_rows(
                [exact.measured(OUTPUT, value, unit) for value, exact in pairs]
            )
        return self._judged[key]

    def _exact(self, sample: Sample, row: int) -> ExactState:
        force, torque = (None if load is None else load[row] for load in (sample.force, sample.torque))
        inputs = (sample.x[row], sample.y[row], sample.tau[row], force, torque)
        return ExactState.of(
            truth(self.system, *inputs, outputs=(OUTPUT,), unit_roundoff=DOUBLE_DOUBLE.roundoff)
        )


def computed(library: Library, sample: Sample, objective: str) -> NDArray[Any]:
    """(B, n) {ydot} of a library, NaN where it has none; by its function for one state, or for batches."""
    storage = formats(library.source.variant).storage
    loads = [load for load in (sample.force, sample.torque) if load is not None]
    arrays = [storage.from_doubles(array) for array in (sample.x, sample.y, sample.tau, *loads)]
    with warnings.catch_warnings(action="ignore", category=KanegenWarning):
        if objective == BATCH:
            return library.forward_dynamics(*arrays)
        nothing = storage.from_doubles(np.full(sample.tau.shape[1], np.nan))
        return np.array([_alone(library, row, nothing) for row in zip(*arrays, strict=True)])


def _alone(library: Library, row: tuple[Any, ...], nothing: NDArray[Any]) -> NDArray[Any]:
    """(n,) of one state; `nothing` where the library refuses it."""
    try:
        return library.forward_dynamics(*row)
    except SingularError:
        return nothing


def unit(variant: Variant) -> float:
    """The relative error of an operation: a rounding, or that of the sine and cosine where it is larger."""
    held = formats(variant)
    roundoff = max(held.arithmetic.roundoff, held.storage.roundoff)
    kind, _, degree = variant.sincos.partition("-")
    return max(roundoff, minimax(int(degree), held.arithmetic).error) if kind == "polynomial" else roundoff
