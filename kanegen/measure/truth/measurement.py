"""The errors of a compiled library against exact results, state by state, with conditioning and bounds."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Protocol, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kanegen.errors import ArrayError, KanegenWarning, OptionError
from kanegen.measure.errors import Errors, quotient
from kanegen.measure.truth.balls import arb_mat, ctx
from kanegen.measure.truth.bounds import FACTOR, Fit, bound, fit
from kanegen.measure.truth.certify import EXACT, Truth, exact_outputs, truth
from kanegen.measure.truth.conditioning import (
    Conditioning,
    cancellation,
    conditioning,
    term_magnitudes,
    term_norms,
)
from kanegen.measure.truth.enclosure import Enclosure, enclosure
from kanegen.measure.truth.errors import LARGEST_BACKWARD_ERROR, Residual, Wide, errors
from kanegen.model.arrays import Flags, Floats
from kanegen.model.system import System
from kanegen.program.precision import Precision, precision_named
from kanegen.reference.states import States


@dataclass(frozen=True)
class Measurement(Errors):
    """Errors of one output in B states, with conditioning and bounds; every field is (B,).

    Attributes:
        bits: Mean number of bits lost; see `errors`.
        worst_bits: Largest number of bits lost.
        kappa_s: Scaled condition number of [A], the same for every output; see `conditioning`.
        formation: Cancellation inside [A] and {f}; see `conditioning`.
        chi: Cancellation: of the right-hand side for forward dynamics, else of the output's own sums.
        bound: Bound on the normwise error; see `bounds`. Infinite where nothing is promised.
        backward: Backward error of accelerations in units of N u; see `errors`. 0 for other outputs.
        relative_to_terms: Norm of the error over that of the terms of which the output is the sum; it is
            `normwise` over `chi`, and stays small where the terms cancel.
        largest: Largest error of an entry, in the unit of the entry.
    """

    bits: Floats
    worst_bits: Floats
    kappa_s: Floats
    formation: Floats
    chi: Floats
    bound: Floats
    backward: Floats
    relative_to_terms: Floats
    largest: Floats

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
        wrong: Flags = ~self.failed & ~(self.backward <= LARGEST_BACKWARD_ERROR)
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
        terms: Norms of the terms of all outputs, without units, by name.
        residual: The equations that accelerations must solve; None without forward dynamics.
    """

    outputs: Mapping[str, Enclosure]
    scales: Mapping[str, Floats]
    bodies: int
    conditioning: Conditioning
    cancellation: Mapping[str, float]
    terms: Mapping[str, float]
    residual: Residual | None

    @classmethod
    def of(cls, exact: Truth) -> Self:
        """Return the exact outputs, scales and conditioning from a `Truth`."""
        terms, difficulty = term_norms(exact), conditioning(exact)
        return cls(
            outputs=exact.outputs,
            scales={name: exact.units.of(name) for name in exact.outputs},
            bodies=exact.system.number_of_bodies,
            conditioning=difficulty,
            cancellation=cancellation(exact, terms),
            terms={"forward_dynamics": difficulty.terms, **terms},
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
            float(quotient(np.array(found.absolute), np.array(self.terms[output]))),
            found.largest,
        )


class MeasuredLibrary(Protocol):
    """The functions of a library that `measure` calls; batches have a leading axis B."""

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs that the library computes."""

    @property
    def precision(self) -> str:
        """Name of the precision of its arithmetic, one of `precision.PRECISIONS`."""

    @property
    def storage(self) -> str:
        """Name of the precision of its arrays, one of `precision.PRECISIONS`."""

    @property
    def parameters(self) -> dict[str, float]:
        """Values of the run-time parameters by name."""

    def mass_matrix(self, x: Floats) -> NDArray[Any]:
        """Return (B, n, n) [A] from (B, m) x."""

    def forcing(self, x: Floats, y: Floats, force: Any = None, torque: Any = None) -> NDArray[Any]:
        """Return (B, n) {f} from (B, m) x, (B, n) y and (B, N, 3) loads."""

    def inverse_dynamics(
        self, x: Floats, y: Floats, ydot: Floats, force: Any = None, torque: Any = None
    ) -> NDArray[Any]:
        """Return (B, n) generalized forces from (B, n) ydot and the arguments of `forcing`."""

    def forward_dynamics(
        self, x: Floats, y: Floats, tau: Any = None, force: Any = None, torque: Any = None
    ) -> NDArray[Any]:
        """Return (B, n) accelerations, NaN where [A] is singular, from tau and the arguments of `forcing`."""


def measure(
    system: System,
    library: MeasuredLibrary,
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
        tau: (B, n) generalized forces (N m, N); default none.
        ydot: (B, n) generalized accelerations (rad/s^2, m/s^2); without them inverse dynamics is left out.
        outputs: Names among the outputs of the library; default all that have an exact result.

    Raises:
        ArrayError, OptionError, SingularError: As `truth`.

    Example:
        >>> library = kg.build(system, ("forward_dynamics",))
        >>> found = truth.measure(system, library, random_states(system, 10))["forward_dynamics"]
        >>> found.max, found.within_bound
    """
    precision, storage = precision_named(library.precision), precision_named(library.storage)
    names = measurable_outputs(library.outputs, outputs, ydot is not None)
    coarser = min(precision, storage, key=lambda precision: precision.significand_bits)
    states = states.rounded(coarser)
    forces = _rounded_rows(tau, states.y, coarser, "tau")
    accelerations = _rounded_rows(ydot, states.y, coarser, "ydot")
    found = {name: _results(library, name, states, forces, accelerations) for name in names}
    rows: dict[str, list[tuple[float, ...]]] = {name: [] for name in names}
    storage_roundoff = storage.roundoff if storage.roundoff > precision.roundoff else 0.0
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
            rows[name].append(state.measured(name, found[name][b], precision.roundoff, storage_roundoff))
    return {name: Measurement.from_rows(table) for name, table in rows.items()}


def measurable_outputs(
    available: tuple[str, ...], outputs: Iterable[str] | None, has_ydot: bool
) -> tuple[str, ...]:
    """Return the names of the outputs to measure.

    Args:
        available: Names of the outputs that the library has.
        outputs: Names that are asked for; None for all that can be measured.
        has_ydot: Whether there are accelerations, which inverse dynamics needs.

    Raises:
        ArrayError: If inverse dynamics is asked for by name without accelerations.
        OptionError: If an output is not available, or there is nothing to measure.
    """
    if outputs is None:
        usable = [name for name in available if name in EXACT and (has_ydot or name != "inverse_dynamics")]
        if not usable:
            raise OptionError(f"nothing to measure: of {', '.join(available)} no exact result is known.")
        return tuple(usable)
    names = exact_outputs(outputs, has_ydot)
    for name in names:
        if name not in available:
            raise OptionError(f"the library has no {name!r}. It has {', '.join(available)}.")
    return names


def _rounded_rows(value: ArrayLike | None, y: Floats, precision: Precision, label: str) -> Floats:
    """Return `value` (B, n) as numbers that `precision` can hold; zeros for None.

    Raises:
        ArrayError: If `value` does not have the shape of `y`; the message calls it `label`.
    """
    array = np.zeros(y.shape) if value is None else np.asarray(value)
    if array.shape != y.shape:
        raise ArrayError(f"{label}: expected shape {y.shape}, got {array.shape}.")
    return array.astype(precision.dtype).astype(np.float64)


def _results(library: MeasuredLibrary, name: str, states: States, tau: Floats, ydot: Floats) -> NDArray[Any]:
    """Return the (B, ...) results of a library for the output `name`; NaN where it has none."""
    storage = precision_named(library.storage)
    x, y, tau, ydot = (storage.from_doubles(values) for values in (states.x, states.y, tau, ydot))
    loads = {
        argument: None if load is None else storage.from_doubles(load)
        for argument, load in (("force", states.force), ("torque", states.torque))
    }
    if name == "mass_matrix":
        return library.mass_matrix(x)
    if name == "forcing":
        return library.forcing(x, y, **loads)
    if name == "inverse_dynamics":
        return library.inverse_dynamics(x, y, ydot, **loads)
    with warnings.catch_warnings(action="ignore", category=KanegenWarning):
        return library.forward_dynamics(x, y, tau=tau, **loads)


def _residual(exact: Truth) -> Residual:
    """Return [A], {f} + {tau} and the magnitudes of their terms."""
    terms, tau = term_magnitudes(exact), exact.state.tau
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
