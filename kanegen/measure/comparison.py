"""A compiled library against the reference, over random states, with a bound that has a reason.

With E the difference of an output from the reference, S the sum of the magnitudes of the terms that make up
the reference (`magnitudes`), and D = diag(S_A)^(1/2), which takes the units from rows and columns:

- normwise error: ||D^-1 E D^-1|| / ||D^-1 A D^-1|| (Frobenius) for [A], ||D^-1 E|| / ||D^-1 f|| for {f}.
  Where the output is zero but for rounding, the norm of S takes the place of its own.
- componentwise error: the largest |E_i| / S_i. An entry never exceeds its S_i, and one that has become small
  by cancellation has no digits of its own, so its terms are the yardstick that no program can beat.
- bound on the componentwise error: see `magnitudes.rounding_bound`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from kanegen.errors import ArrayError, OptionError
from kanegen.measure.errors import Errors, quotient, scaled_norm
from kanegen.measure.report import Accuracy, Evaluation, Report
from kanegen.model.arrays import Flags, Floats, SystemArrays
from kanegen.model.system import System
from kanegen.program.precision import DOUBLE, Precision
from kanegen.reference import equations as reference
from kanegen.reference.kinematics import kinematics
from kanegen.reference.magnitudes import (
    element_magnitude,
    forcing_magnitude,
    mass_matrix_magnitude,
    reaches,
    rounding_bound,
)
from kanegen.reference.states import States, random_states

__all__ = ["Accuracy", "ComparedLibrary", "Evaluation", "Report", "compare"]

BOUND_REASON = (
    "The bound is 8 (N + 8) 2^-{digits} for N bodies, relative to the magnitudes of an entry's terms: "
    "rounding grows at most linearly along the tree, and the constants are calibrated."
)

OUTPUTS = ("mass_matrix", "forcing")
"""What there is a reference for."""

BATCH_NUMBERS = 2**24
"""How many numbers a batch of states may hold at once."""


@dataclass(frozen=True)
class ReferenceErrors(Errors):
    """Errors of one output against the reference in B states.

    Attributes:
        cancellation: (B,) norm of the terms' magnitudes over the norm of their sum.
        finite: (B,) flags of the states with a finite result.
        entry: (B,) index of the entry with the largest componentwise error.
        value: (B,) this entry as the library computed it.
        reference: (B,) this entry as the reference computed it.
    """

    cancellation: Floats
    finite: Flags
    entry: NDArray[np.int64]
    value: Floats
    reference: Floats


class ComparedLibrary(Protocol):
    """What `compare` needs of a library; batches have a leading axis B."""

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of what it computes."""

    @property
    def mass_matrix(self) -> Callable[..., NDArray[Any]]:
        """(B, n, n) from (B, n), and from `States.given` by name."""

    @property
    def forcing(self) -> Callable[..., NDArray[Any]]:
        """(B, n) from (B, n), (B, n), (B, N, 3) and (B, N, 3) by name, and from `States.given`."""


def compare(
    system: System,
    library: ComparedLibrary,
    states: int = 1000,
    seed: int = 0,
    precision: Precision = DOUBLE,
    storage: Precision | None = None,
) -> Report:
    """The outputs of `library` against the reference; parameters stand at their defaults.

    Args:
        system: What the library was generated from.
        library: It.
        states: How many random states.
        seed: Of the random states.
        precision: Of the library's arithmetic; the bound is for it, or for the reference's.
        storage: Of its arrays, if it is another. The states are rounded to the coarser of both.

    Raises:
        OptionError: If there is no state, the seed is negative, or no output has a reference.
        ArrayError: If an output has the wrong shape.
    """
    for name, value, least in (("states", states, 1), ("seed", seed, 0)):
        if not isinstance(value, int | np.integer) or value < least:
            raise OptionError(f"{name} is {value!r}; it must be a whole number, at least {least}.")
    outputs = [name for name in OUTPUTS if name in library.outputs]
    if not outputs:
        raise OptionError(f"the library has none of the outputs {', '.join(OUTPUTS)}: nothing to compare.")
    arrays = system.values()
    held = storage or precision
    sample = random_states(arrays, states, seed).rounded(_coarser(precision, held))
    limit = rounding_bound(system.number_of_bodies, precision, held)
    parts = _batches(sample, system.number_of_bodies)
    batches = [_batch_errors(arrays, library, outputs, part, limit, held) for part in parts]
    accuracies = (
        _accuracy(system, sample, name, _joined([batch[name] for batch in batches]), limit)
        for name in outputs
    )
    return Report(system.name, states, seed, tuple(accuracies), _reason(precision, held))


def _batches(sample: States, bodies: int) -> Iterator[States]:
    size = max(1, BATCH_NUMBERS // (3 * (6 * bodies) ** 2))  # [A], its magnitude, and the bodies' matrices
    for start in range(0, len(sample), size):
        yield sample.part(start, start + size)


def _batch_errors(
    arrays: SystemArrays,
    library: ComparedLibrary,
    outputs: list[str],
    states: States,
    limit: float,
    storage: Precision,
) -> dict[str, ReferenceErrors]:
    x, y, force, torque = states.x, states.y, states.force, states.torque
    given_x, given_y = storage.from_doubles(x), storage.from_doubles(y)
    given_force, given_torque = (None if f is None else storage.from_doubles(f) for f in (force, torque))
    given = {name: storage.from_doubles(values) for name, values in states.given.items()}
    told = states.motion
    bodies = kinematics(arrays, x, y, told)
    reach = reaches(arrays, bodies, y, told)
    matrix_size = mass_matrix_magnitude(arrays, reach)
    diagonal = np.einsum("bii->bi", matrix_size)
    scale = 1 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    errors = {}
    if "mass_matrix" in outputs:
        truth = reference.mass_matrix(arrays, x, told)
        scales = scale[:, :, None] * scale[:, None, :]
        value = storage.to_doubles(library.mass_matrix(given_x, **given))
        errors["mass_matrix"] = reference_errors(value, truth, matrix_size, scales, limit)
    if "forcing" in outputs:
        truth = reference.forcing(arrays, x, y, force, torque, **states.given)
        size = forcing_magnitude(arrays, reach, force, torque)
        size = size + element_magnitude(arrays, bodies, x, y, **states.given)
        found = library.forcing(given_x, given_y, force=given_force, torque=given_torque, **given)
        value = storage.to_doubles(found)
        errors["forcing"] = reference_errors(value, truth, size, scale, limit)
    return errors


def reference_errors(
    value: NDArray[Any], truth: Floats, size: Floats, scale: Floats, limit: float
) -> ReferenceErrors:
    """Compare results with those of the reference; what is not finite counts as an infinite error.

    Args:
        value: (B, ...) results of a library.
        truth: (B, ...) results of the reference.
        size: (B, ...) magnitudes of the terms of `truth`.
        scale: (B, ...) factors that take the units away.
        limit: Norm of a `truth` that is nothing but rounding, relative to the norm of `size`.

    Raises:
        ArrayError: If `value` has another shape than `truth`.
    """
    if np.shape(value) != truth.shape:
        raise ArrayError(f"the library returned shape {np.shape(value)}; expected {truth.shape}.")
    value, truth, size, scale = (array.reshape(len(truth), -1) for array in (value, truth, size, scale))
    finite = np.isfinite(value) & np.isfinite(truth)
    difference = np.full(truth.shape, np.inf)
    np.abs(np.subtract(value, truth, where=finite, out=difference), out=difference)
    ratio = quotient(difference, size)
    rows, entry = np.arange(len(truth)), ratio.argmax(axis=1)
    norm, size_norm = scaled_norm(truth, scale), scaled_norm(size, scale)
    compared = np.where(norm > limit * size_norm, norm, size_norm)
    return ReferenceErrors(
        normwise=quotient(scaled_norm(difference, scale), compared),
        componentwise=ratio[rows, entry],
        cancellation=quotient(size_norm, norm),
        finite=np.all(finite, axis=1),
        entry=entry,
        value=value[rows, entry],
        reference=truth[rows, entry],
    )


def _joined(batches: list[ReferenceErrors]) -> ReferenceErrors:
    """Return the errors of several batches as those of one."""
    names = [field.name for field in fields(ReferenceErrors)]
    return ReferenceErrors(
        **{name: np.concatenate([getattr(part, name) for part in batches]) for name in names}
    )


def _coarser(a: Precision, b: Precision) -> Precision:
    return min(a, b, key=lambda precision: precision.significand_bits)


def _reason(precision: Precision, storage: Precision) -> str:
    """Where the bound comes from."""
    reason = BOUND_REASON.format(digits=_coarser(precision, DOUBLE).significand_bits)
    if storage.roundoff > precision.roundoff:
        reason += f" Results are rounded once more, by 2^-{storage.significand_bits}."
    return reason


def _accuracy(system: System, sample: States, output: str, errors: ReferenceErrors, bound: float) -> Accuracy:
    worst = int(errors.componentwise.argmax())
    names = system.speed_names
    shape = (len(names),) * (2 if output == "mass_matrix" else 1)
    entry = [names[i] for i in np.unravel_index(int(errors.entry[worst]), shape)]
    return Accuracy(
        output=output,
        normwise=float(errors.normwise.max()),
        normwise_median=float(np.median(errors.normwise)),
        componentwise=float(errors.componentwise.max()),
        componentwise_median=float(np.median(errors.componentwise)),
        cancellation=float(errors.cancellation.max()),
        bound=bound,
        not_finite=int(np.count_nonzero(~errors.finite)),
        worst=Evaluation(
            state=worst,
            entry=f"[{', '.join(entry)}]",
            value=float(errors.value[worst]),
            reference=float(errors.reference[worst]),
            x=_row(sample.x[worst]),
            y=_row(sample.y[worst]),
            force=None if sample.force is None else tuple(_row(row) for row in sample.force[worst]),
            torque=None if sample.torque is None else tuple(_row(row) for row in sample.torque[worst]),
            given={name: values[worst].tolist() for name, values in sample.given.items()},
        ),
    )


def _row(values: Floats) -> tuple[float, ...]:
    return tuple(float(value) for value in values)
