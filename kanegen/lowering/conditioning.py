"""Conditioning: the solvers for {ydot} that lose no accuracy, and whether iterative refinement is needed.

The loss of accuracy is measured before any code is generated: the solution is computed in doubles in a few
random states, and a first correction estimates its error. Ordinary trees, robots among them, lose less than
130 roundoffs; eight links whose masses grow outward by a factor of 30 lose 10^9, and five of them 10^5. The
limit is 8192 roundoffs, 1e-12 of the solution in double precision and 5e-4 in single: far enough from
ordinary trees that the decision is the same on every machine, whatever the last bits of its sines.
"""

from __future__ import annotations

import numpy as np

from kanegen.lowering.compilation import Candidate, Request
from kanegen.lowering.lower import lower_definitions
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.options import AUTO
from kanegen.program import precision as precisions
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import Array, Program
from kanegen.program.passes.prune import prune
from kanegen.program.precision import DOUBLE, Precision
from kanegen.recursion import derive_correction_size, methods
from kanegen.recursion.outputs import input_arrays, prerequisites
from kanegen.recursion.refinement import UNREFINED, Refinement
from kanegen.reference import equations as reference
from kanegen.reference.states import States, random_states, ranges

STATES = 16
"""Number of states that are tried; half of them are nearly straight, where chains are worst conditioned."""

WELL_CONDITIONED = 1e4
"""Condition number of [A], scaled to a diagonal of ones, below which no solver loses too much."""

LARGEST_ACCEPTED_ERROR = 2.0**13
"""Largest error, in unit roundoffs, of a result without a status; results that may lose more are refined."""

CONTRACTION = 64.0
"""Largest ratio between the error after a step of refinement and the product of the errors before it and of
the first solution, entry by entry. In 88 000 states of chains with growing masses, in both precisions, the
largest was 20."""

WEIGHTLESS = 1e-12
"""Share of the Earth's gravity that replaces it as a scale of accelerations where there is no gravity."""


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
    if variant.refinement != AUTO:
        refinement = refined(system, int(variant.refinement), precision)
        return tuple(Candidate(way, refinement, str(variant.refinement)) for way in ways)
    states = _states(system)
    if _condition_number(system, states.part(0, STATES // 2)) < WELL_CONDITIONED:
        return tuple(Candidate(way, UNREFINED, "0 (auto: [A] is well conditioned)") for way in ways)
    lost = measured_error(system, ways[0]["forward_dynamics"], states) / DOUBLE.roundoff
    if lost <= LARGEST_ACCEPTED_ERROR:
        reason = f"0 (auto: it would repair about {_power_of_ten(lost)} roundoffs)"
        return (Candidate(ways[0], UNREFINED, reason),)
    reason = f"1 (auto: it repairs about {_power_of_ten(lost)} roundoffs)"
    return (Candidate(ways[0], refined(system, 1, precision), reason),)


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
        size, *corrections = evaluate(program, _inputs(system, program, states), np)["correction_size"]
        largest = np.max(np.broadcast_arrays(size, *corrections)[1:], axis=0)
        share = np.sqrt(np.where(largest == 0, 0.0, largest / size))
    return float(np.max(np.where(np.isnan(share), np.inf, share)))


def _states(system: System) -> States:
    """Return random states, the first half of them near the straight configuration {x} = {0}."""
    states = random_states(system, STATES)
    states.x[0] /= 128
    states.x[1 : STATES // 2] /= 4
    return states


def _condition_number(system: System, states: States) -> float:
    """Return the largest condition number of [A], scaled to a diagonal of ones, over the states."""
    matrix = reference.mass_matrix(system, states.x, states.prescribed)
    scale = 1 / np.sqrt(np.diagonal(matrix, axis1=1, axis2=2))
    condition: Floats = np.linalg.cond(matrix * scale[:, :, None] * scale[:, None, :])
    return float(np.max(np.where(np.isnan(condition), np.inf, condition)))


def _inputs(system: System, program: Program, states: States) -> dict[str, list[Floats]]:
    """Return the elements of each input array of the program, (B,) over the states, by name of the array."""
    count = len(states)
    values = {array.name: np.zeros((array.size, count)) for array in program.inputs}
    for parameter, row in zip(system.parameters, values.get("parameters", ()), strict=True):
        row[:] = parameter.value
    sampled = {"x": states.x, "y": states.y, "force": states.force, "torque": states.torque, **states.inputs}
    values |= {name: v.reshape(count, -1).T for name, v in sampled.items() if v is not None}
    return {name: list(rows) for name, rows in values.items()}


def _accelerations(system: System) -> tuple[float, ...]:
    """Return the acceleration that gravity causes, by freedom (rad/s^2, m/s^2)."""
    largest = ranges(system)
    weight = system.values().gravity
    share = 1.0 if weight.any() else WEIGHTLESS
    found = share * largest.y * largest.y / largest.size
    return tuple(found.tolist())


def _power_of_ten(value: float) -> str:
    """Return the power of ten nearest to `value`, in words."""
    if value == 0:
        return "no"
    return f"1e{round(np.log10(value)):+03d}" if np.isfinite(value) else "any number of"
