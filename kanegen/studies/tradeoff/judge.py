"""Certified truth, computed once a state for all variants, and what a result is worth beside it."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kanegen.c.formats import formats
from kanegen.c.minimax import minimax
from kanegen.errors import KanegenWarning, SingularError
from kanegen.library import Library
from kanegen.measure.timing import BATCH, LATENCY
from kanegen.measure.truth.balls import ctx
from kanegen.measure.truth.bounds import FACTOR, bound
from kanegen.measure.truth.cancellation import sizes
from kanegen.measure.truth.certify import truth
from kanegen.measure.truth.conditioning import Conditioning, conditioning
from kanegen.measure.truth.enclosure import Enclosure, enclosure, precision_of
from kanegen.measure.truth.errors import errors
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.options import Variant
from kanegen.program.precision import DOUBLE_DOUBLE
from kanegen.studies.tradeoff.errors import Errors
from kanegen.studies.tradeoff.samples import Sample

OUTPUT = "forward_dynamics"
"""What is studied: {ydot} of x, y and tau."""

Wide = NDArray[np.longdouble]

_RESOLUTION = 6 * float(np.finfo(np.longdouble).eps)
"""What a backward error is known to, a body, which has six freedoms at most."""


@dataclass(frozen=True)
class Exact:
    """One state: the truth, and what is needed to judge a result by it.

    Attributes:
        ydot: The accelerations.
        scale: (n,) factors that take the units away.
        conditioning: Of the problem.
        matrix: (n, n) [A].
        right: (n,) {f} + {tau}.
        matrix_terms: (n, n) magnitudes of the terms that [A] is summed from.
        right_terms: (n,) likewise.
    """

    ydot: Enclosure
    scale: Floats
    conditioning: Conditioning
    matrix: Wide
    right: Wide
    matrix_terms: Floats
    right_terms: Floats


class Judge:
    """Truths of one system; parameters stand at their defaults.

    Args:
        system: The tree.
    """

    def __init__(self, system: System) -> None:
        self.system = system
        self._known: dict[bytes, Exact] = {}
        self._judged: dict[tuple[bytes, ...], Errors] = {}

    def truths(self, sample: Sample) -> list[Exact]:
        """The truth in every state, from memory where it was asked for before.

        Raises:
            SingularError: If [A] is singular in one.
        """
        for row, key in enumerate(sample.bits()):
            if key not in self._known:
                self._known[key] = self._exact(sample, row)
        return [self._known[key] for key in sample.bits()]

    def errors(self, library: Library, sample: Sample, objective: str = LATENCY) -> Errors:
        """The errors of a library built from the system, called for one of `OBJECTIVES`."""
        return self.judged(computed(library, sample, objective), sample, unit(library.source.variant))

    def judged(self, values: NDArray[Any], sample: Sample, unit: float) -> Errors:
        """The errors of results from anywhere; many variants have the same, which are judged once.

        Args:
            values: (B, n) accelerations, or (B, n, 2) as sums of two; NaN where there are none.
            sample: B states.
            unit: Relative error of an operation of the program that computed them.
        """
        key = (values.tobytes(), str(unit).encode(), *sample.bits())
        if key not in self._judged:
            pairs = zip(values, self.truths(sample), strict=True)
            rows = [self._row(value, exact, unit) for value, exact in pairs]
            self._judged[key] = Errors(*np.reshape(rows, (-1, 4)).T)
        return self._judged[key]

    def _row(self, value: NDArray[Any], exact: Exact, unit: float) -> tuple[float, ...]:
        found = errors(value, exact.ydot, exact.scale, unit)
        state, bodies = exact.conditioning, self.system.number_of_bodies
        limit = bound(unit, bodies, state.chi, state.kappa_s, state.formation)
        normalised = FACTOR * found.normwise / limit if np.isfinite(limit) else np.nan
        backward = _left(value, exact) / (bodies * max(unit, _RESOLUTION))
        return found.normwise, found.componentwise, normalised, backward

    def _exact(self, sample: Sample, row: int) -> Exact:
        states = sample.states
        force, torque = (None if load is None else load[row] for load in (states.force, states.torque))
        inputs = (states.x[row], states.y[row], sample.tau[row], force, torque)
        found = truth(self.system, *inputs, outputs=(OUTPUT,), unit_roundoff=DOUBLE_DOUBLE.roundoff)
        terms, equations = sizes(found), found.equations
        with ctx.workprec(found.bits):
            matrix, forcing = _wide(equations.A), _wide(equations.f)[:, 0]
        return Exact(
            ydot=found[OUTPUT],
            scale=found.units.of(OUTPUT),
            conditioning=conditioning(found),
            matrix=matrix,
            right=forcing + sample.tau[row],
            matrix_terms=terms["mass_matrix"],
            right_terms=terms["forcing"] + np.abs(sample.tau[row]),
        )


def computed(library: Library, sample: Sample, objective: str) -> NDArray[Any]:
    """(B, n) {ydot} of a library, NaN where it has none; by its function for one state, or for batches."""
    states, storage = sample.states, formats(library.source.variant).storage
    loads = [load for load in (states.force, states.torque) if load is not None]
    arrays = [storage.stored(array) for array in (states.x, states.y, sample.tau, *loads)]
    with warnings.catch_warnings(action="ignore", category=KanegenWarning):
        if objective == BATCH:
            return library.forward_dynamics(*arrays)
        nothing = storage.stored(np.full(sample.tau.shape[1], np.nan))
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


def _left(value: NDArray[Any], exact: Exact) -> float:
    """The largest row of [A]{ydot} - {f} - {tau}, each over the magnitudes of its terms."""
    parts = precision_of(value, exact.right.shape).parts(value)
    ydot = np.sum([part.astype(np.longdouble) for part in parts], axis=0)
    left = np.abs(exact.matrix @ ydot - exact.right)
    terms = exact.matrix_terms @ np.abs(ydot) + exact.right_terms
    with np.errstate(invalid="ignore", divide="ignore"):
        shares = np.where(left == 0, 0.0, left / terms)
    return float(shares.max())


def _wide(matrix: Any) -> Wide:
    """Balls as numbers of more digits than a double has, where the platform has such."""
    entries = enclosure(matrix, (matrix.nrows(), matrix.ncols()))
    return entries.value.astype(np.longdouble) + entries.residue
