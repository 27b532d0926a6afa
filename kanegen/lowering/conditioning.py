"""Conditioning: the solvers for {ydot} that lose no accuracy, and whether iterative refinement is needed.

The loss of accuracy is found before any code is generated, by a search over states with parameters at their
defaults. The inverse of [A], scaled to a diagonal of ones, bounds what any solver loses; where it is large,
first corrections measure what articulated bodies lose. Ordinary trees, robots among them, lose less than 130
roundoffs; eight links whose masses grow outward by a factor of 30 lose 10^9, and five of them 10^5. Trees
that may lose more than 1024 roundoffs are refined. The generated code reports what the search has missed and
what other parameters change: losses of pivots larger than the search found, and where it refines, errors
that may exceed 8192 roundoffs, 1e-12 of the solution in double precision and 5e-4 in single.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kanegen.lowering.compilation import Candidate, Request
from kanegen.lowering.losses import Losses, array_inputs, largest_losses
from kanegen.lowering.lower import lower_definitions
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.options import AUTO
from kanegen.program import precision as precisions
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import Array
from kanegen.program.passes.prune import prune
from kanegen.program.precision import DOUBLE, Precision
from kanegen.recursion import derive_correction_size, methods
from kanegen.recursion.outputs import input_arrays, prerequisites
from kanegen.recursion.refinement import UNREFINED, Refinement
from kanegen.reference import equations as reference
from kanegen.reference.states import States, ranges

LARGEST_ACCEPTED_ERROR = 2.0**13
"""Largest error, in unit roundoffs, of a result without a status."""

LARGEST_UNREFINED_ERROR = 2.0**10
"""Largest error, in unit roundoffs, in the states of the search, of a result that is not refined."""

LARGEST_FORMATION_LOSS = 2.0**12
"""Largest loss of a pivot with which every solver is accurate if [A] is well conditioned."""

UNTESTED_LOSS = 2.0**6
"""Loss of a pivot that is never reported: few roundoffs of a solution are lost by it."""

REPORTED_LOSS = 2.0**8
"""Largest unreported loss of a pivot where a solution is not refined although it should be."""

SLACK = 1.5
"""Factor by which a loss of a pivot must exceed the largest one that the search found to be reported."""

MATRIX_ENTRIES = 2**13
"""Number of states in which the reference forms [A], times the freedoms and the bodies; at least 4 states."""

CONTRACTION = 64.0
"""Largest ratio between the error after a step of refinement and the product of the errors before it and of
the first solution, entry by entry. In 88 000 states of chains with growing masses, in both precisions, the
largest was 20."""

WEIGHTLESS = 1e-12
"""Share of the Earth's gravity that replaces it as a scale of accelerations where there is no gravity."""

STANDSTILL = 2.0**-48
"""Acceleration below which a solution counts as zero, as a share of what gravity causes. Its square is far
from underflow in single precision."""


def condition(request: Request) -> tuple[Candidate, ...]:
    """Return the candidates, ways to derive the outputs, that lose no accuracy.

    Where [A] is ill-conditioned there is one candidate with the most accurate solver, refined if the measured
    error demands it.
    """
    system, variant = request.system, request.variant
    ways = methods(system, prerequisites(request.outputs), variant.solver)
    if "forward_dynamics" not in ways[0]:
        return tuple(Candidate(way, UNREFINED, str(variant.refinement)) for way in ways)
    precision = precisions.precision_named(variant.precision)
    if variant.refinement not in (AUTO, 0):
        refinement = refined(system, int(variant.refinement), precision)
        return tuple(Candidate(way, refinement, str(variant.refinement)) for way in ways)
    losses = [largest_losses(system, way["forward_dynamics"]) for way in ways]
    asked = "" if variant.refinement == AUTO else "0"
    if is_well_conditioned(system, losses[0]):
        reason = asked or "0 (auto: [A] is well conditioned in every state tried)"
        return tuple(
            Candidate(way, unrefined(found, accurate=True), reason)
            for way, found in zip(ways, losses, strict=True)
        )
    lost = measured_error(system, ways[0]["forward_dynamics"], losses[0].states) / DOUBLE.roundoff
    is_accurate = lost <= LARGEST_UNREFINED_ERROR
    if asked:
        return tuple(
            Candidate(way, unrefined(found, accurate=is_accurate and way is ways[0]), asked)
            for way, found in zip(ways, losses, strict=True)
        )
    if is_accurate:
        reason = f"0 (auto: it would repair about {_power_of_ten(lost)} roundoffs)"
        return (Candidate(ways[0], unrefined(losses[0], accurate=True), reason),)
    reason = f"1 (auto: it repairs about {_power_of_ten(lost)} roundoffs)"
    return (Candidate(ways[0], refined(system, 1, precision), reason),)


def is_well_conditioned(system: System, losses: Losses) -> bool:
    """Return whether no solver loses much in the states of the search.

    With a diagonal of ones, the largest diagonal entry of the inverse of [A] bounds the error of an
    elimination in roundoffs (Higham 2002, section 10.1).
    """
    if not (losses.largest <= LARGEST_FORMATION_LOSS).all():
        return False
    # [A] is singular at gimbal lock, where no solver fails; force elements, which name rates, are not in [A].
    regular = replace(system, force_elements=()).with_speeds("angular_velocity")
    size, states = system.number_of_bodies * len(system.freedoms), losses.states
    count = min(len(states), max(4, MATRIX_ENTRIES // size))
    chosen = np.linspace(0, len(states) - 1, count).astype(int)
    matrix = reference.mass_matrix(regular, states.x[chosen], states.prescribed[chosen])
    return bool(_amplification(matrix) <= LARGEST_UNREFINED_ERROR)


def unrefined(losses: Losses, *, accurate: bool) -> Refinement:
    """Return no refinement, with a report of losses of pivots beyond those of the search.

    Args:
        losses: The losses that the search found.
        accurate: Whether the solver is accurate where it found them.
    """
    least = np.maximum(SLACK * losses.largest, UNTESTED_LOSS)
    with np.errstate(over="ignore"):
        limits = np.exp2(np.ceil(np.log2(np.minimum(least, 2.0**100))))
    limits = limits if accurate else np.minimum(limits, REPORTED_LOSS)
    return replace(
        UNREFINED, losses=tuple(limits.tolist()), bounded=tuple((losses.bounds <= limits).tolist())
    )


def refined(system: System, steps: int, precision: Precision) -> Refinement:
    """Return a refinement that reports results whose errors may exceed `LARGEST_ACCEPTED_ERROR`."""
    if steps == 0:
        return UNREFINED
    remaining = LARGEST_ACCEPTED_ERROR * precision.roundoff / CONTRACTION**steps
    return Refinement(steps, remaining ** (1 / (steps + 1)), _accelerations(system))


def measured_error(system: System, solver: str, states: States) -> float:
    """Return the largest ratio of the first correction of {ydot} to the solution; infinity if undefined."""
    form = derive_correction_size(system, solver)
    array = Array("correction_size", (1 + len(system.freedoms),), "", "")
    program = lower_definitions(
        input_arrays(system), form.definitions, {array: form.outputs["correction_size"]}
    )
    program = prune(program)
    with np.errstate(all="ignore"):
        size, *corrections = evaluate(program, array_inputs(system, program, states), np)["correction_size"]
        largest = np.max(np.broadcast_arrays(size, *corrections)[1:], axis=0)
        share = np.sqrt(np.where(largest == 0, 0.0, largest / size))
    return float(np.max(np.where(np.isnan(share), np.inf, share)))


def _amplification(matrix: Floats) -> float:
    """Return the largest diagonal entry of the inverses of (B, n, n) matrices [A] with diagonals of ones."""
    scale = 1 / np.sqrt(np.diagonal(matrix, axis1=1, axis2=2))
    scaled = matrix * scale[:, :, None] * scale[:, None, :]
    if not np.isfinite(scaled).all():
        return np.inf
    values, vectors = np.linalg.eigh(scaled)
    values = np.where(values > 0, values, 0.0)
    with np.errstate(all="ignore"):
        entries = np.sum(vectors**2 / values[:, None, :], axis=2)
    return float(np.max(np.where(np.isnan(entries), np.inf, entries)))


def _accelerations(system: System) -> tuple[float, ...]:
    """Return the acceleration below which a solution counts as zero, by freedom (rad/s^2, m/s^2)."""
    largest = ranges(system)
    weight = system.values().gravity
    share = 1.0 if weight.any() else WEIGHTLESS
    found = STANDSTILL * share * largest.y * largest.y / largest.size
    return tuple(found.tolist())


def _power_of_ten(value: float) -> str:
    """Return the power of ten nearest to `value`, in words."""
    if value == 0:
        return "no"
    return f"1e{round(np.log10(value)):+03d}" if np.isfinite(value) else "any number of"
