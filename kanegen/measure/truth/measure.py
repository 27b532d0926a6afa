"""The errors of a compiled library against exact results, state by state, beside what bounds them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kanegen.measure.truth.bounds import Fit, bound, fit
from kanegen.measure.truth.cancellation import cancellation
from kanegen.measure.truth.certify import Truth, truth
from kanegen.measure.truth.conditioning import conditioning
from kanegen.measure.truth.errors import errors
from kanegen.measure.truth.judged import JudgedLibrary, companion, values
from kanegen.measure.truth.outputs import measurable_outputs
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.program.precision import named
from kanegen.reference.states import States


@dataclass(frozen=True)
class Measurement:
    """One output in B states; every field is (B,).

    Attributes:
        normwise: See `errors`.
        componentwise: Likewise.
        bits: Likewise, the mean over the entries.
        worst_bits: The worst entry's.
        kappa_s: See `conditioning`; of [A], so the same for every output.
        formation: Likewise.
        chi: Cancellation: of the right-hand side for forward dynamics, else of the output's own sums.
        bound: On `normwise`; see `bounds`. Infinite where nothing is promised.
    """

    normwise: Floats
    componentwise: Floats
    bits: Floats
    worst_bits: Floats
    kappa_s: Floats
    formation: Floats
    chi: Floats
    bound: Floats

    @property
    def within_bound(self) -> bool:
        """Whether no state exceeds its bound."""
        return bool(np.all(self.normwise <= self.bound))

    @property
    def fit(self) -> Fit:
        """How the bound fits.

        Raises:
            OptionError: If it promises nothing in any state.
        """
        return fit(self.normwise, self.bound)


def measure(
    system: System,
    library: JudgedLibrary,
    states: States,
    tau: ArrayLike | None = None,
    ydot: ArrayLike | None = None,
    outputs: Iterable[str] | None = None,
) -> dict[str, Measurement]:
    """The errors of `library`, built from `system`, against exact results.

    States are rounded to the precision of the library first. The numbers of the model are not: their
    rounding is an error of the library.

    Args:
        system: The tree; parameters stand at the values of the library.
        library: What to judge.
        states: B of them.
        tau: (B, n) generalized forces; default none.
        ydot: (B, n) accelerations; without them inverse dynamics is left out.
        outputs: Names among the outputs of the library; default all that have an exact result.

    Returns:
        By name of the output.

    Raises:
        ArrayError, OptionError, SingularError: As `truth`.
    """
    precision, held = named(library.precision), named(library.storage)
    names = measurable_outputs(library.outputs, outputs, ydot is not None)
    coarser = min(precision, held, key=lambda precision: precision.digits)
    states = states.rounded(coarser)
    forces = companion(tau, states.y, coarser, "tau")
    accelerations = companion(ydot, states.y, coarser, "ydot")
    found = {name: values(library, name, states, forces, accelerations) for name in names}
    rows: dict[str, list[tuple[float, ...]]] = {name: [] for name in names}
    stored = held.roundoff if held.roundoff > precision.roundoff else 0.0
    for b in range(len(states)):
        exact = truth(
            system,
            states.x[b],
            states.y[b],
            forces[b],
            None if states.force is None else states.force[b],
            None if states.torque is None else states.torque[b],
            library.parameters,
            names,
            precision.roundoff,
            accelerations[b],
        )
        state = {name: value[b] for name, value in found.items()}
        for name, row in _rows(exact, state, precision.roundoff, stored).items():
            rows[name].append(row)
    count = len(fields(Measurement))
    return {name: Measurement(*np.reshape(table, (-1, count)).T) for name, table in rows.items()}


def _rows(
    exact: Truth, state: Mapping[str, NDArray[Any]], unit_roundoff: float, stored: float
) -> dict[str, tuple[float, ...]]:
    """For every output of one state the fields of `Measurement`; `stored` is the roundoff of its array."""
    condition, sums = conditioning(exact), cancellation(exact)
    bodies = exact.system.number_of_bodies
    rows: dict[str, tuple[float, ...]] = {}
    for name, value in state.items():
        found = errors(value, exact[name], exact.units.of(name), unit_roundoff)
        if name in sums:
            chi = sums[name]
            limit = bound(unit_roundoff, bodies, chi)
        else:
            chi = condition.chi
            limit = bound(unit_roundoff, bodies, chi, condition.kappa_s, condition.formation)
        lost = (found.normwise, found.componentwise, found.bits, found.worst_bits)
        rows[name] = (*lost, condition.kappa_s, condition.formation, chi, limit + stored)
    return rows
