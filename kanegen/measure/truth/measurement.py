"""The errors of a compiled library against exact results, state by state, beside what bounds them."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Protocol, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kanegen.errors import ArrayError, KanegenWarning
from kanegen.measure.errors import Errors
from kanegen.measure.truth.balls import arb_mat, ctx
from kanegen.measure.truth.bounds import FACTOR, Fit, bound, fit
from kanegen.measure.truth.certify import Truth, measurable_outputs, truth
from kanegen.measure.truth.conditioning import Conditioning, cancellation, conditioning, sizes
from kanegen.measure.truth.enclosure import Enclosure, enclosure
from kanegen.measure.truth.errors import GATE, Residual, Wide, errors
from kanegen.model.arrays import Flags, Floats
from kanegen.model.system import System
from kanegen.program.precision import Precision, precision_named
from kanegen.reference.states import States


@dataclass(frozen=True)
class Measurement(Errors):
    """Errors of one output in B states, and what bounds them; every field is (B,).

    Attributes:
        bits: Mean number of bits lost; see `errors`.
        worst_bits: Largest number of bits lost.
        kappa_s: Scaled condition number of [A], the same for every output; see `conditioning`.
        formation: Cancellation inside [A] and {f}; see `conditioning`.
        chi: Cancellation: of the right-hand side for forward dynamics, else of the output's own sums.
        bound: Bound on the normwise error; see `bounds`. Infinite where nothing is promised.
        backward: Backward error of accelerations in units of N u; see `errors`. 0 for other outputs.
    """

    bits: Floats
    worst_bits: Floats
    kappa_s: Floats
    formation: Floats
    chi: Floats
    bound: Floats
    backward: Floats

    @classmethod
    def from_rows(cls, rows: Sequence[tuple[float, ...]]) -> Self:
        """Return the measurement whose fields in each state are those of `ExactState.measured`."""
        return cls(*np.reshape(rows, (-1, len(fields(cls)))).T)

    @property
    def within_bound(self) -> bool:
        """Whether no state exceeds its bound."""
        return bool(np.all(self.normwise <= self.bound))

    @property
    def bound_share(self) -> float:
        """Largest normwise error over its bound without the factor `FACTOR`; NaN if nothing is promised.

        The bound holds where this is at most `FACTOR`.
        """
        promised = np.isfinite(self.bound)
        shares = FACTOR * self.normwise[promised] / self.bound[promised]
        return float(shares.max()) if shares.size else np.nan

    @property
    def wrong(self) -> Flags:
        """(B,) flags of the states whose result does not solve the equations, rounding included."""
        wrong: Flags = ~self.failed & ~(self.backward <= GATE)
        return wrong

    @property
    def fit(self) -> Fit:
        """The fit of the bound to the errors.

        Raises:
            OptionError: If the bound promises nothing in any state.
        """
        return fit(self.normwise, self.bound)


@dataclass(frozen=True)
class ExactState:
    """The exact outputs of one state, and all that is needed to evaluate results by them.

    Attributes:
        outputs: Exact outputs by name.
        scales: Factors that take the units away, by output, each of the output's shape.
        bodies: N.
        conditioning: Conditioning of forward dynamics.
        cancellation: chi of the outputs that are sums, by name.
        residual: The equations that accelerations must solve; None without forward dynamics.
    """

    outputs: Mapping[str, Enclosure]
    scales: Mapping[str, Floats]
    bodies: int
    conditioning: Conditioning
    cancellation: Mapping[str, float]
    residual: Residual | None

    @classmethod
    def of(cls, exact: Truth) -> Self:
        """Return what a truth says about results of its state."""
        return cls(
            outputs=exact.outputs,
            scales={name: exact.units.of(name) for name in exact.outputs},
            bodies=exact.system.number_of_bodies,
            conditioning=conditioning(exact),
            cancellation=cancellation(exact),
            residual=_residual(exact) if "forward_dynamics" in exact.outputs else None,
        )

    def measured(
        self, output: str, value: NDArray[Any], unit_roundoff: float, storage_roundoff: float = 0.0
    ) -> tuple[float, ...]:
        """Return the fields of `Measurement` for one result of this state.

        Args:
            output: Name of the output.
            value: The result: floats of any precision, or sums of two along a last axis.
            unit_roundoff: Unit roundoff of the program that computed it.
            storage_roundoff: Roundoff of its array, added to the bound.
        """
        found, state = (
            errors(value, self.outputs[output], self.scales[output], unit_roundoff),
            self.conditioning,
        )
        if output in self.cancellation:
            chi, backward = self.cancellation[output], 0.0
            limit = bound(unit_roundoff, self.bodies, chi)
        else:
            chi, backward = state.chi, 0.0
            limit = bound(unit_roundoff, self.bodies, chi, state.kappa_s, state.formation)
            if self.residual is not None:
                backward = self.residual.backward_error(value, unit_roundoff)
        return (
            *(found.normwise, found.componentwise, found.bits, found.worst_bits),
            *(state.kappa_s, state.formation, chi, limit + storage_roundoff, backward),
        )


def measure(
    system: System,
    library: JudgedLibrary,
    states: States,
    tau: ArrayLike | None = None,
    ydot: ArrayLike | None = None,
    outputs: Iterable[str] | None = None,
) -> dict[str, Measurement]:
    """Return the errors of `library`, built from `system`, against exact results, by name of the output.

    States are rounded to the precision of the library first. The numbers of the model are not: their
    rounding is an error of the library.

    Args:
        system: The tree; parameters stand at the values of the library.
        library: The library that is measured.
        states: B states.
        tau: (B, n) generalized forces; default none.
        ydot: (B, n) accelerations; without them inverse dynamics is left out.
        outputs: Names among the outputs of the library; default all that have an exact result.

    Raises:
        ArrayError, OptionError, SingularError: As `truth`.
    """
    precision, held = precision_named(library.precision), precision_named(library.storage)
    names = measurable_outputs(library.outputs, outputs, ydot is not None)
    coarser = min(precision, held, key=lambda precision: precision.significand_bits)
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
        state = ExactState.of(exact)
        for name in names:
            rows[name].append(state.measured(name, found[name][b], precision.roundoff, stored))
    return {name: Measurement.from_rows(table) for name, table in rows.items()}


def _residual(exact: Truth) -> Residual:
    """Return [A], {f} + {tau} and the magnitudes of their terms."""
    terms, tau = sizes(exact), exact.state.tau
    with ctx.workprec(exact.bits):
        matrix, forcing = _wide(exact.equations.A), _wide(exact.equations.f)[:, 0]
    return Residual(
        matrix=matrix,
        right=forcing + tau,
        matrix_terms=terms["mass_matrix"],
        right_terms=terms["forcing"] + np.abs(tau),
        bodies=exact.system.number_of_bodies,
    )


def _wide(matrix: arb_mat) -> Wide:
    """Return the midpoints of balls with more digits than a double has, where the platform has them."""
    entries = enclosure(matrix, (matrix.nrows(), matrix.ncols()))
    return entries.value.astype(np.longdouble) + entries.residue


class JudgedLibrary(Protocol):
    """The functions of a library; batches have a leading axis B."""

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of what it computes."""

    @property
    def precision(self) -> str:
        """Its arithmetic, a name of `precision.PRECISIONS`."""

    @property
    def storage(self) -> str:
        """The precision of its arrays, likewise."""

    @property
    def parameters(self) -> dict[str, float]:
        """Values of the run-time parameters."""

    def mass_matrix(self, x: Floats) -> NDArray[Any]:
        """(B, n, n) from (B, n)."""

    def forcing(self, x: Floats, y: Floats, force: Any = None, torque: Any = None) -> NDArray[Any]:
        """(B, n) from (B, n), (B, n), (B, N, 3) and (B, N, 3)."""

    def inverse_dynamics(
        self, x: Floats, y: Floats, ydot: Floats, force: Any = None, torque: Any = None
    ) -> NDArray[Any]:
        """(B, n)."""

    def forward_dynamics(
        self, x: Floats, y: Floats, tau: Any = None, force: Any = None, torque: Any = None
    ) -> NDArray[Any]:
        """(B, n), NaN where [A] is singular."""


def companion(value: ArrayLike | None, y: Floats, precision: Precision, what: str) -> Floats:
    """`value` (B, n) as numbers that the library can hold; zeros for None.

    Raises:
        ArrayError: If it does not have the shape of `y`.
    """
    array = np.zeros(y.shape) if value is None else np.asarray(value)
    if array.shape != y.shape:
        raise ArrayError(f"{what}: expected shape {y.shape}, got {array.shape}.")
    return array.astype(precision.dtype).astype(np.float64)


def values(library: JudgedLibrary, name: str, states: States, tau: Floats, ydot: Floats) -> NDArray[Any]:
    """(B, ...) what the library computes as output `name`; NaN where it refuses."""
    held = precision_named(library.storage)
    x, y, tau, ydot = (held.from_doubles(given) for given in (states.x, states.y, tau, ydot))
    given = {"force": states.force, "torque": states.torque}
    loads = {what: None if load is None else held.from_doubles(load) for what, load in given.items()}
    if name == "mass_matrix":
        return library.mass_matrix(x)
    if name == "forcing":
        return library.forcing(x, y, **loads)
    if name == "inverse_dynamics":
        return library.inverse_dynamics(x, y, ydot, **loads)
    with warnings.catch_warnings(action="ignore", category=KanegenWarning):
        return library.forward_dynamics(x, y, tau=tau, **loads)
