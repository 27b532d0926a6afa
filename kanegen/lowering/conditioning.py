"""Whether forward dynamics needs refinement, found by trying it before any code is written.

What the model costs in accuracy is measured where it will be lost: the solution is computed in doubles at a
few random states, and a first correction tells its error. Ordinary trees, robots among them, lose less than
130 roundoffs; eight links whose masses grow outward by a factor of 30 lose 10^9, and five of them 10^5. The
limit lies at 8192, which is 1e-12 of the solution in double precision and 5e-4 in single: so far from what
is ordinary that no machine decides otherwise by the last bits of its sines.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kanegen.lowering.lower import lower
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.options import AUTO, Variant
from kanegen.program import precision as precisions
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import Array, Program
from kanegen.program.passes.prune import prune
from kanegen.program.precision import DOUBLE, Precision
from kanegen.recursion import Methods, measuring_form
from kanegen.recursion.outputs import input_arrays
from kanegen.recursion.refinement import UNREFINED, Refinement
from kanegen.reference import equations as reference
from kanegen.reference.states import States, random_states, ranges

STATES = 16
"""How many are tried; half of them are nearly straight, where chains are worst."""

WELL_CONDITIONED = 1e4
"""Condition number of [A], scaled to a diagonal of ones, below which no solver loses too much."""

PROMISED = 2.0**13
"""Error of a result that has no status, in unit roundoffs; what may lose more in some state is refined."""

CONTRACTION = 64.0
"""A step leaves at most so many times the product of the errors before it and of the first solution, entry by
entry. In 88 000 states of chains with growing masses, in both precisions, 20 were enough."""

TINY = 1e-12
"""Share of the Earth's gravity that counts as nothing where there is none."""


@dataclass(frozen=True)
class Decision:
    """A way to derive the outputs.

    Attributes:
        methods: How each is derived.
        refinement: Of forward dynamics.
        words: The choice, and how it came about.
    """

    methods: Methods
    refinement: Refinement
    words: str


def decisions(system: System, ways: Sequence[Methods], variant: Variant) -> tuple[Decision, ...]:
    """The ways that lose no accuracy.

    Where [A] is ill-conditioned that is the first alone, the most accurate one, refined if it needs that.

    Args:
        system: The tree.
        ways: From `recursion.methods`.
        variant: Says how to refine; "auto" where the model needs it.
    """
    if "forward_dynamics" not in ways[0]:
        return tuple(Decision(way, UNREFINED, str(variant.refinement)) for way in ways)
    precision = precisions.precision_named(variant.precision)
    if variant.refinement != AUTO:
        refinement = refined(system, int(variant.refinement), precision)
        return tuple(Decision(way, refinement, str(variant.refinement)) for way in ways)
    states = _states(system)
    if _condition(system, states.part(0, STATES // 2)) < WELL_CONDITIONED:
        return tuple(Decision(way, UNREFINED, "0 (auto: [A] is well conditioned)") for way in ways)
    lost = error(system, ways[0]["forward_dynamics"], states) / DOUBLE.roundoff
    if lost <= PROMISED:
        words = f"0 (auto: it would repair about {_power(lost)} roundoffs)"
        return (Decision(ways[0], UNREFINED, words),)
    words = f"1 (auto: it repairs about {_power(lost)} roundoffs)"
    return (Decision(ways[0], refined(system, 1, precision), words),)


def refined(system: System, steps: int, precision: Precision) -> Refinement:
    """Refinement in so many steps, which calls inaccurate what may be off by `PROMISED` roundoffs."""
    if steps == 0:
        return UNREFINED
    remaining = PROMISED * precision.roundoff / CONTRACTION**steps
    return Refinement(steps, remaining ** (1 / (steps + 1)), _accelerations(system))


def error(system: System, solver: str, states: States) -> float:
    """The largest first correction of {ydot} over the solution, in doubles; infinite where there is none."""
    form = measuring_form(system, solver)
    array = Array("sizes", (1 + len(system.freedoms),), "", "")
    program = prune(lower(input_arrays(system), form.definitions, {array: form.outputs["sizes"]}))
    with np.errstate(all="ignore"):
        size, *corrections = evaluate(program, _inputs(system, program, states), np)["sizes"]
        largest = np.max(np.broadcast_arrays(size, *corrections)[1:], axis=0)
        share = np.sqrt(np.where(largest == 0, 0.0, largest / size))
    return float(np.max(np.where(np.isnan(share), np.inf, share)))


def _states(system: System) -> States:
    states = random_states(system, STATES)
    states.x[0] /= 128
    states.x[1 : STATES // 2] /= 4
    return states


def _condition(system: System, states: States) -> float:
    matrix = reference.mass_matrix(system, states.x, states.motion)
    scale = 1 / np.sqrt(np.diagonal(matrix, axis1=1, axis2=2))
    condition: Floats = np.linalg.cond(matrix * scale[:, :, None] * scale[:, None, :])
    return float(np.max(np.where(np.isnan(condition), np.inf, condition)))


def _inputs(system: System, program: Program, states: States) -> dict[str, list[Floats]]:
    """By array its elements, each in all states."""
    count = len(states)
    values = {array.name: np.zeros((array.size, count)) for array in program.inputs}
    for parameter, row in zip(system.parameters, values.get("parameters", ()), strict=True):
        row[:] = parameter.value
    given = {"x": states.x, "y": states.y, "force": states.force, "torque": states.torque, **states.given}
    values |= {name: v.reshape(count, -1).T for name, v in given.items() if v is not None}
    return {name: list(rows) for name, rows in values.items()}


def _accelerations(system: System) -> tuple[float, ...]:
    """By freedom what gravity causes."""
    largest = ranges(system)
    weight = system.values().gravity
    share = 1.0 if weight.any() else TINY
    found = share * largest.y * largest.y / largest.size
    return tuple(found.tolist())


def _power(found: float) -> str:
    """The nearest power of ten."""
    return f"1e{round(np.log10(found)):+03d}" if np.isfinite(found) else "any number of"
