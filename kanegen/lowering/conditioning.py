"""Conditioning: the solvers for {ydot} that lose no accuracy, and whether iterative refinement is needed.

The loss of accuracy is found before any code is generated, by a search over states with parameters at their
defaults. The inverse of [A], scaled to a diagonal of ones, bounds what any solver loses; where it is large,
the errors of the most accurate solver are measured with 320 bits, without refinement and with it. Ordinary
trees, robots among them, lose less than 130 roundoffs; eight links whose masses grow outward by a factor of
30 lose 10^9, and five of them 10^5. Trees that may lose more than 1024 roundoffs are refined. The generated
code reports what the search has missed and what other parameters change: losses of pivots larger than the
search found, smaller ones where refinement does not help, and where it refines, errors that may exceed 8192
roundoffs, 1e-12 of the solution in double precision and 5e-4 in single.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from kanegen.lowering.compilation import Candidate, Request
from kanegen.lowering.losses import KEPT, Losses, array_inputs, largest_losses
from kanegen.lowering.lower import lower
from kanegen.model.arrays import Floats
from kanegen.model.body import Body
from kanegen.model.coordinates import SPEEDS
from kanegen.model.system import System
from kanegen.options import AUTO
from kanegen.program import precision as precisions
from kanegen.program.constants import MULTIPRECISION
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import Program
from kanegen.program.passes.prune import prune
from kanegen.program.precision import DOUBLE, Precision
from kanegen.recursion import Methods, derive, methods
from kanegen.recursion.outputs import (
    OUTPUTS,
    SOLUTION_BY_STATE,
    SOLUTION_PARTS,
    accurately_solved,
    prerequisites,
    refined_solutions,
)
from kanegen.recursion.pivot_margins import PivotLimits
from kanegen.recursion.refinement import UNREFINED, Refinement
from kanegen.reference import equations as reference
from kanegen.reference.states import ranges

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

INVERSES_OF_FRAMES = ("operational_inertia", "operational_bias")
"""Outputs that invert J [A]^-1 J^T of frames and amplify its errors."""

LEAST_LOST_BY_A_FRAME = 2.0**4
"""Least error, in unit roundoffs, of J [A]^-1 J^T and its inverse for a factor 1 of amplification. In 1 800
states of ur5, panda and kinova near singular poses, both solvers, the largest was 10."""

SLACK = 1.5
"""Factor by which a loss of a pivot must exceed the largest one that the search found to be reported."""

MATRIX_ENTRIES = 2**13
"""Number of states in which the reference forms [A], times the freedoms and the bodies; at least 4 states."""

MEASURED_INSTRUCTIONS = 2**17
"""Number of instructions that are evaluated in 320 bits to measure an error."""

LEAST_MEASURED = 8
"""Least number of states in which an error is measured."""

DEPENDENT_ROWS = 2.0**10
"""Share of a row of constraints alone, in roundoffs, with less than which as pivot it counts as dependent."""

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
    error demands it. Only {ydot} is refined; other results of a solver, such as [A]^-1, have a status where
    they may be inaccurate.
    """
    system, variant = request.system, request.variant
    ways = methods(system, prerequisites(request.outputs, system), variant.solver)
    solved = accurately_solved(ways[0])
    if not solved:
        return tuple(Candidate(way, UNREFINED, str(variant.refinement)) for way in ways)
    solvers = dict.fromkeys(way[solved[0]] for way in ways)
    losses = {solver: largest_losses(system, solver) for solver in solvers}
    is_well = is_well_conditioned(system, next(iter(solvers)))
    refinable = refined_solutions(solved)
    if refinable:
        candidates = _of_solution(request, ways, losses, is_well)
    else:
        accurate = ways if is_well else ways[:1]
        candidates = tuple(Candidate(way, UNREFINED, str(variant.refinement)) for way in accurate)
    candidates = tuple(
        one if is_well and not one.refinement.steps else _through_solver(one) for one in candidates
    )
    candidates = tuple(one for i, one in enumerate(candidates) if one not in candidates[:i])
    share = DEPENDENT_ROWS * precisions.precision_named(variant.precision).roundoff
    candidates = tuple(
        replace(one, refinement=replace(one.refinement, independent_rows=share)) for one in candidates
    )
    if solved == refinable:
        return candidates
    return tuple(_reporting_unrefined(system, one, solved, losses, is_well) for one in candidates)


def _of_solution(
    request: Request, ways: Sequence[Methods], losses: Mapping[str, Losses], is_well: bool
) -> tuple[Candidate, ...]:
    """Return the candidates for {ydot}.

    Args:
        request: The request.
        ways: The ways to derive its outputs; the first has the most accurate solver.
        losses: Losses of the pivots by solver.
        is_well: Whether [A] is well conditioned.
    """
    system, variant = request.system, request.variant
    precision = precisions.precision_named(variant.precision)
    asked = None if variant.refinement == AUTO else int(variant.refinement)
    output, *_ = refined_solutions(ways[0])
    solvers = [way[output] for way in ways]
    found = [losses[solver] for solver in solvers]
    if is_well:
        why = "0 (auto: [A] is well conditioned in every state tried)" if asked is None else str(asked)
        return tuple(
            Candidate(way, refined(system, asked, precision) if asked else reporting(UNREFINED, own), why)
            for way, own in zip(ways, found, strict=True)
        )
    if asked is not None:
        return tuple(
            Candidate(way, _measured(system, solver, asked, own, precision)[0], str(asked))
            for way, solver, own in zip(ways, solvers, found, strict=True)
        )
    refinement, lost = _measured(system, solvers[0], 0, found[0], precision)
    if lost <= LARGEST_UNREFINED_ERROR:
        reason = f"0 (auto: it would repair about {_power_of_ten(lost)} roundoffs)"
        return (Candidate(ways[0], refinement, reason),)
    refinement, _ = _measured(system, solvers[0], 1, found[0], precision)
    reason = f"1 (auto: it repairs about {_power_of_ten(lost)} roundoffs)"
    return (Candidate(ways[0], refinement, reason),)


def _through_solver(candidate: Candidate) -> Candidate:
    """Return a candidate whose derivatives of {ydot} are those of its solver, which alone is accurate."""
    parts = SOLUTION_PARTS, SOLUTION_BY_STATE
    methods = {name: way for name, way in candidate.methods.items() if name not in parts}
    return replace(candidate, methods=methods)


def _reporting_unrefined(
    system: System, candidate: Candidate, solved: Sequence[str], losses: Mapping[str, Losses], is_well: bool
) -> Candidate:
    """Return a candidate that reports where results that are not refined may be inaccurate.

    Args:
        system: The tree.
        candidate: The candidate.
        solved: Names of the outputs that its solver gives.
        losses: Losses of the pivots by solver.
        is_well: Whether [A] is well conditioned.
    """
    solver = candidate.methods[solved[0]]
    own, refinement = losses[solver], candidate.refinement
    accurate = is_well or measured_inverse_error(system, solver) <= LARGEST_UNREFINED_ERROR
    refinement = replace(refinement, unrefined=pivot_limits(own, accurate=accurate))
    if any(name in INVERSES_OF_FRAMES for name in solved):
        lost = measured_inverse_error(system, solver, "operational_inertia_inverse")
        amplification = LARGEST_ACCEPTED_ERROR / max(LEAST_LOST_BY_A_FRAME, lost)
        refinement = replace(refinement, amplification=max(amplification, 1.0))
    return replace(candidate, refinement=refinement)


def _measured(
    system: System, solver: str, steps: int, losses: Losses, precision: Precision
) -> tuple[Refinement, float]:
    """Return a refinement that reports what it leaves inaccurate, and the error of its results in roundoffs.

    Args:
        system: The tree.
        solver: Name of the solver.
        steps: Number of steps of refinement.
        losses: Losses of the pivots of its solver.
        precision: Arithmetic of the code.
    """
    refinement = refined(system, steps, precision)
    lost = measured_error(system, solver, refinement)
    if steps and lost <= LARGEST_UNREFINED_ERROR:
        return refinement, lost
    return reporting(refinement, losses, accurate=lost <= LARGEST_UNREFINED_ERROR), lost


@lru_cache(maxsize=KEPT)
def is_well_conditioned(system: System, solver: str) -> bool:
    """Return whether no solver loses much in the states of the search with one of them.

    With a diagonal of ones, the largest diagonal entry of the inverse of [A] bounds the error of an
    elimination in roundoffs (Higham 2002, section 10.1).
    """
    losses = largest_losses(system, solver)
    if not (losses.largest <= LARGEST_FORMATION_LOSS).all():
        return False
    # [A] is singular at gimbal lock, where no solver fails; force elements, which name rates, are not in [A].
    regular = replace(system, force_elements=(), bodies=_with_regular_speeds(system))
    size, states = system.number_of_bodies * len(system.freedoms), losses.states
    count = min(len(states), max(4, MATRIX_ENTRIES // size))
    chosen = np.linspace(0, len(states) - 1, count).astype(int)
    matrix = reference.mass_matrix(regular, states.x[chosen], states.prescribed[chosen])
    return bool(_amplification(matrix) <= LARGEST_UNREFINED_ERROR)


def _with_regular_speeds(system: System) -> tuple[Body, ...]:
    """Return the bodies with angular velocities as speeds where solvers eliminate three angles together.

    They eliminate angles that have armature or drive rotors one by one.
    """
    driving = {one.freedom.body for one in system.mounted_rotors}
    return tuple(
        replace(body, joint=replace(body.joint, speeds=SPEEDS[1]))
        if body.joint.has_free_orientation and not any(body.joint.armature[:3]) and k not in driving
        else body
        for k, body in enumerate(system.bodies, start=1)
    )


def reporting(refinement: Refinement, losses: Losses, *, accurate: bool = True) -> Refinement:
    """Return a refinement, with a report of losses of pivots beyond those of the search.

    Args:
        refinement: The refinement.
        losses: The losses that the search found.
        accurate: Whether results are accurate where it found them.
    """
    return replace(refinement, pivots=pivot_limits(losses, accurate=accurate))


def pivot_limits(losses: Losses, *, accurate: bool) -> PivotLimits:
    """Return the losses of pivots beyond which results are reported, from those that a search found.

    Args:
        losses: The losses that the search found.
        accurate: Whether results are accurate where it found them.
    """
    least = np.maximum(SLACK * losses.largest, UNTESTED_LOSS)
    with np.errstate(over="ignore"):
        limits = np.exp2(np.ceil(np.log2(np.minimum(least, 2.0**100))))
    limits = limits if accurate else np.minimum(limits, REPORTED_LOSS)
    return PivotLimits(tuple(limits.tolist()), tuple((losses.bounds <= limits).tolist()))


def refined(system: System, steps: int, precision: Precision) -> Refinement:
    """Return a refinement that reports results whose errors may exceed `LARGEST_ACCEPTED_ERROR`."""
    if steps == 0:
        return UNREFINED
    remaining = LARGEST_ACCEPTED_ERROR * precision.roundoff / CONTRACTION**steps
    return Refinement(steps, remaining ** (1 / (steps + 1)), _accelerations(system))


@lru_cache(maxsize=KEPT)
def measured_error(system: System, solver: str, refinement: Refinement) -> float:
    """Return the largest error of {ydot} in doubles, in roundoffs; infinity if it is undefined.

    The states are those of the search. The program is evaluated in doubles and in 320 bits, so that the
    rounding of its constants, and what the residuals of a refinement lose, count too. Angles and
    translations are compared by `_accelerations`.
    """
    rounded, exact = _evaluated(system, "forward_dynamics", solver, refinement)
    with np.errstate(all="ignore"):
        scale = np.array(_accelerations(system))
        sizes = np.linalg.norm(exact / scale, axis=1)
        errors = np.linalg.norm((rounded - exact) / scale, axis=1)
        return _largest_share(errors, sizes)


@lru_cache(maxsize=KEPT)
def measured_inverse_error(system: System, solver: str, output: str = "mass_matrix_inverse") -> float:
    """Return the largest error of an entry of [A]^-1 in doubles, in roundoffs; infinity if it is undefined.

    The states are those of the search.
    The error of entry (i, j) is compared with the root of the product of entries (i, i) and (j, j), which
    bounds the entry and has its unit. So it is for J [A]^-1 J^T, the output "operational_inertia_inverse".
    """
    n = OUTPUTS[output].array(system).row
    rounded, exact = (found.reshape(-1, n, n) for found in _evaluated(system, output, solver, UNREFINED))
    with np.errstate(all="ignore"):
        root = np.sqrt(np.diagonal(exact, axis1=1, axis2=2))
        return _largest_share(np.abs(rounded - exact), root[:, :, None] * root[:, None, :])


def _largest_share(errors: Floats, sizes: Floats) -> float:
    """Return the largest ratio of errors and sizes, in roundoffs; infinity if one is undefined."""
    share = np.where(errors == 0, 0.0, errors / sizes) / DOUBLE.roundoff
    return float(np.max(np.where(np.isnan(share), np.inf, share)))


def _evaluated(system: System, output: str, solver: str, refinement: Refinement) -> tuple[Floats, Floats]:
    """Return the (B, size) values of an output in some states of the search, in doubles and in 320 bits.

    Args:
        system: The tree.
        output: Name of the output.
        solver: Name of the solver.
        refinement: The refinement of {ydot}.
    """
    states = largest_losses(system, solver).states
    form = derive(system, {output: solver}, DOUBLE.constants, refinement)
    program = prune(lower(form, (output,), DOUBLE.constants))
    count = min(len(states), max(LEAST_MEASURED, MEASURED_INSTRUCTIONS // len(program.instructions)))
    chosen = np.linspace(0, len(states) - 1, count).astype(int)
    inputs = {
        name: [np.broadcast_to(row, len(states))[chosen] for row in rows]
        for name, rows in array_inputs(system, program, states).items()
    }
    with np.errstate(all="ignore"):
        (rows,) = evaluate(program, inputs, np, np.float64).values()
        rounded = np.stack([np.broadcast_to(row, count) for row in rows], axis=-1)
        exact = np.array([_in_many_bits(program, inputs, b) for b in range(count)])
    return rounded, exact


def _in_many_bits(program: Program, inputs: Mapping[str, Sequence[Floats]], state: int) -> list[float]:
    """Return the output of one state, computed in 320 bits; NaN where it is undefined."""
    number = MULTIPRECISION.mpf
    elements = {name: [number(float(row[state])) for row in rows] for name, rows in inputs.items()}
    try:
        (found,) = evaluate(program, elements, MULTIPRECISION, number).values()
        return [float(value) for value in found]
    except (ZeroDivisionError, TypeError):  # a root of a negative number is complex
        return [np.nan] * len(program.outputs[0].values)


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
