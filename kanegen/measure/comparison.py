"""The comparison of a compiled library with the reference over random states, and its bound.

With E the difference of an output from the reference, S the sum of the magnitudes of the terms that make up
the reference (`reference.magnitudes`), and D = diag(S_A)^(1/2), which takes the units from rows and columns:

- normwise error: ||D^-1 E D^-1|| / ||D^-1 A D^-1|| (Frobenius) for [A], ||D^-1 E|| / ||D^-1 f|| for {f}.
  Where the output is nothing but rounding, the norm of S takes the place of the output's norm.
- componentwise error: the largest |E_i| / S_i. An entry never exceeds its S_i, and an entry that is small
  because large terms cancel has no relative accuracy in any program, so errors are relative to the terms.
- bound on the componentwise error: see `reference.magnitudes.rounding_bound`.
- bound on the normwise error: it follows in every state, as this bound times ||D^-1 S|| over the norm by
  which the error is divided, which is the cancellation of the terms.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kanegen.errors import ArrayError, OptionError, quoted
from kanegen.measure.compared import OUTPUTS, ComparedLibrary, term_magnitudes
from kanegen.measure.errors import Errors, quotient, scaled_norm
from kanegen.measure.evaluation import Evaluation, evaluation
from kanegen.measure.report import Accuracy, Report
from kanegen.measure.undefined import undefined_words
from kanegen.model.arrays import Flags, Floats, SystemArrays
from kanegen.model.system import System
from kanegen.program.precision import DOUBLE, Precision
from kanegen.reference import equations as reference
from kanegen.reference.freedoms import largest_coupled_angle
from kanegen.reference.magnitudes import rounding_bound
from kanegen.reference.special_states import special_states
from kanegen.reference.states import States, joined, random_states

__all__ = ["Accuracy", "ComparedLibrary", "Evaluation", "Report", "compare"]

BOUND_REASON = (
    "The bound on componentwise errors is 8 ({count}) 2^-{digits} for N bodies, relative to the magnitudes "
    "of an entry's terms: rounding grows at most linearly along the tree, and the constants are calibrated. "
    "Normwise errors are relative to the norm of the output itself, which is small where terms cancel. Their "
    "bound is the same times the norm of the terms over that of the output, in the state of the largest one."
)
"""Sentence in which a report says where its bound comes from."""

MOST_STATES = 10**8
"""Largest number of random states of a comparison."""

LARGEST_SEED = 2**128 - 1
"""Largest seed of random states."""

BATCH_NUMBERS = 2**24
"""Largest number of floats that the arrays of one batch of states may hold."""


@dataclass(frozen=True)
class ReferenceErrors(Errors):
    """Errors of one output against the reference in B states.

    Attributes:
        normwise_bound: (B,) bounds on the normwise errors, which follow from that on componentwise errors.
        cancellation: (B,) norm of the terms' magnitudes over the norm of their sum.
        finite: (B,) flags of the states with a finite result.
        undefined: (B,) flags of the states in which neither the library nor the reference is finite.
        entry: (B,) index of the entry with the largest componentwise error.
        value: (B,) this entry as the library computed it.
        reference: (B,) this entry as the reference computed it.
    """

    normwise_bound: Floats
    cancellation: Floats
    finite: Flags
    undefined: Flags
    entry: NDArray[np.int64]
    value: Floats
    reference: Floats


def compare(
    system: System,
    library: ComparedLibrary,
    states: int = 1000,
    seed: int = 0,
    precision: Precision = DOUBLE,
    storage: Precision | None = None,
) -> Report:
    """Compare the outputs of `library` with the reference; parameters stand at their defaults.

    Coordinates and speeds stay within the limits of the system where it has some, and vary over the scale of
    each body elsewhere, see `reference.states.random_states`. Then follow states at rest, the origin, and
    states at kinks of expressions, see `reference.special_states`. Where a force element is undefined, so
    that neither the reference nor the library has a finite {f}, there is nothing to compare; the report
    counts these states.

    Args:
        system: System from which the library was generated.
        library: Library to compare.
        states: Number of random states.
        seed: Seed of the random states.
        precision: Precision of the library's arithmetic, for which the bound holds.
        storage: Precision of the library's arrays, if it is another one. The states are rounded to the
            coarser of both.

    Raises:
        OptionError: If the number of states or the seed is out of range, or no output has a reference.
        ArrayError: If an output has the wrong shape.
    """
    for name, value, least, most in (("states", states, 1, MOST_STATES), ("seed", seed, 0, LARGEST_SEED)):
        is_whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
        if not is_whole or not least <= value <= most:
            raise OptionError(f"{name} is {quoted(value)}; it must be a whole number from {least} to {most}.")
    outputs = [name for name in OUTPUTS if name in library.outputs]
    if not outputs:
        raise OptionError(f"the library has none of the outputs {', '.join(OUTPUTS)}: nothing to compare.")
    arrays, storage = system.values(), storage or precision
    coarser = _coarser(precision, storage)
    sample = random_states(arrays, states, seed, system.limits).rounded(coarser)
    further = special_states(system, sample)
    sample = joined([sample, further.states.rounded(coarser)])
    angle = largest_coupled_angle(arrays, sample.x, sample.prescribed[:, 0])
    limit = rounding_bound(system.number_of_bodies, precision, storage, angle)
    parts = _batches(sample, system.number_of_bodies)
    batches = [_batch_errors(arrays, library, outputs, part, limit, storage) for part in parts]
    errors = {name: _joined([batch[name] for batch in batches]) for name in outputs}
    kept = {name: _compared(system, errors[name], states) for name in outputs}
    accuracies = tuple(
        _accuracy(system, sample, name, errors[name], limit, states, kept[name]) for name in outputs
    )
    left_out = ~kept.get("forcing", np.ones(len(sample), dtype=bool))[:states]
    return Report(
        system=system.name,
        states=states,
        seed=seed,
        accuracies=accuracies,
        reason=_reason(precision, storage, angle),
        limits=system.limits.words,
        special=further.words,
        undefined=undefined_words(system, sample.part(0, states).chosen(left_out), states),
    )


def _compared(system: System, errors: ReferenceErrors, states: int) -> Flags:
    """Return flags of the states that count: without those in which a force element is undefined.

    Both programs must agree that there is no result. A system all of whose elements are defined everywhere,
    or a sample of `states` random states of which none has a result, counts as a whole.
    """
    kept = ~errors.undefined
    if kept[:states].any() and any(element.may_be_undefined for element in system.force_elements):
        return kept
    return np.ones_like(kept)


def reference_errors(
    value: NDArray[Any], truth: Floats, size: Floats, scale: Floats, limit: float
) -> ReferenceErrors:
    """Compare results with those of the reference; a result that is not finite has an infinite error.

    Args:
        value: (B, ...) results of a library.
        truth: (B, ...) results of the reference.
        size: (B, ...) magnitudes of the terms of `truth`.
        scale: (B, ...) factors that take the units away.
        limit: Bound on componentwise errors. A `truth` whose norm is no larger, relative to the norm of
            `size`, is nothing but rounding.

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
        normwise_bound=quotient(limit * size_norm, compared),
        cancellation=quotient(size_norm, norm),
        finite=np.all(finite, axis=1),
        undefined=~np.all(np.isfinite(value), axis=1) & ~np.all(np.isfinite(truth), axis=1),
        entry=entry,
        value=value[rows, entry],
        reference=truth[rows, entry],
    )


def _batches(sample: States, bodies: int) -> Iterator[States]:
    """Cut states into batches whose [A], its magnitudes and the bodies' matrices fit `BATCH_NUMBERS`."""
    size = max(1, BATCH_NUMBERS // (3 * (6 * bodies) ** 2))
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
    """Return the errors of a library's outputs in one batch of states, by output."""
    x, y, force, torque = states.x, states.y, states.force, states.torque
    stored_x, stored_y = storage.from_doubles(x), storage.from_doubles(y)
    inputs = {name: storage.from_doubles(values) for name, values in states.inputs.items()}
    sizes = term_magnitudes(arrays, states)
    diagonal = np.einsum("bii->bi", sizes["mass_matrix"])
    scale = 1 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    errors = {}
    if "mass_matrix" in outputs:
        truth = reference.mass_matrix(arrays, x, states.prescribed)
        scales = scale[:, :, None] * scale[:, None, :]
        value = storage.to_doubles(library.mass_matrix(stored_x, **inputs))
        errors["mass_matrix"] = reference_errors(value, truth, sizes["mass_matrix"], scales, limit)
    if "forcing" in outputs:
        truth = reference.forcing(arrays, x, y, force, torque, **states.inputs)
        loads = {"force": force, "torque": torque}
        stored = {name: None if load is None else storage.from_doubles(load) for name, load in loads.items()}
        value = storage.to_doubles(library.forcing(stored_x, stored_y, **stored, **inputs))
        errors["forcing"] = reference_errors(value, truth, sizes["forcing"], scale, limit)
    return errors


def _joined(batches: list[ReferenceErrors]) -> ReferenceErrors:
    """Return the errors of several batches as those of one."""
    names = [field.name for field in fields(ReferenceErrors)]
    return ReferenceErrors(
        **{name: np.concatenate([getattr(part, name) for part in batches]) for name in names}
    )


def _coarser(a: Precision, b: Precision) -> Precision:
    """Return the precision with fewer digits."""
    return min(a, b, key=lambda precision: precision.significand_bits)


def _reason(precision: Precision, storage: Precision, angle: float) -> str:
    """Return the sentences that say where the bound comes from."""
    count = f"N + 8 + {angle:.3g}" if angle else "N + 8"
    reason = BOUND_REASON.format(count=count, digits=_coarser(precision, DOUBLE).significand_bits)
    if angle:
        reason += (
            f" Terms of coupled angles add up to {angle:.3g} rad, and have rounding errors in proportion."
        )
    if storage.roundoff > precision.roundoff:
        reason += f" Results are rounded once more, by 2^-{storage.significand_bits}."
    return reason


def _accuracy(
    system: System,
    sample: States,
    output: str,
    errors: ReferenceErrors,
    bound: float,
    states: int,
    kept: Flags,
) -> Accuracy:
    """Return the summary of an output's errors over the states that are kept, with its worst entry.

    Medians, and the cancellation, are those of the random states, which are the first `states`.
    """
    random, every = np.flatnonzero(kept[:states]), np.flatnonzero(kept)
    worst = int(every[errors.componentwise[every].argmax()])
    largest = int(every[errors.normwise[every].argmax()])
    names = system.speed_names
    shape = (len(names),) * (2 if output == "mass_matrix" else 1)
    return Accuracy(
        output=output,
        normwise=float(errors.normwise[every].max()),
        normwise_median=float(np.median(errors.normwise[random])),
        normwise_bound=float(errors.normwise_bound[largest]),
        componentwise=float(errors.componentwise[every].max()),
        componentwise_median=float(np.median(errors.componentwise[random])),
        cancellation=float(errors.cancellation[random].max()),
        bound=bound,
        not_finite=int(np.count_nonzero(~errors.finite[every])),
        worst=evaluation(
            names,
            sample,
            state=worst,
            entry=[int(i) for i in np.unravel_index(int(errors.entry[worst]), shape)],
            value=float(errors.value[worst]),
            reference=float(errors.reference[worst]),
        ),
    )
