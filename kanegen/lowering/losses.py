"""The largest losses of the pivots of a solver: found by a search over states, and bounded by constants.

The search starts in random states, half of them near the straight configuration {x} = {0}, where chains lose
most. It changes one coordinate after another to values at which a loss, or the product of all losses, is
larger. Every state that it visits counts.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kanegen.lowering.definitions import lower_definitions
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import Array, Program
from kanegen.program.passes.prune import prune
from kanegen.recursion import derive_losses
from kanegen.recursion.outputs import input_arrays
from kanegen.reference.states import States, random_states, ranges

KEPT = 32
"""Number of results that are kept, because all code for a system needs the same."""

STATES = 64
"""Number of states in which the search starts."""

LONGEST_SWEEP = 2**15
"""Number of instructions of a sweep over coordinates; for more, only evenly spread ones are changed."""

TRIED_VALUES = 5
"""Number of values of a coordinate that are tried in every state."""

STEPS = (1.0, 1 / 8)
"""Sizes of the changes of a coordinate in each sweep, as shares of its range."""


@dataclass(frozen=True)
class Losses:
    """Losses of the pivots of a solver, see `recursion.pivot_margins`.

    Attributes:
        largest: (n,) largest losses found; infinity where a pivot was not positive.
        bounds: (n,) bounds of the losses in every state; infinity where there is none.
        states: The states in which the search ended, with its starting states.
    """

    largest: Floats
    bounds: Floats
    states: States


@lru_cache(maxsize=KEPT)
def largest_losses(system: System, solver: str) -> Losses:
    """Return the largest losses of the pivots of a solver, parameters at their defaults.

    The last results are kept, because they are the same for all outputs of a system.
    """
    losses, bounds = _programs(system, solver)
    starts = _starting_states(system)
    found = Losses(np.ones(len(system.freedoms)), _bounds(system, bounds), starts)
    if (found.bounds == 1.0).all():
        return found
    return _climbed(system, losses, found)


def array_inputs(system: System, program: Program, states: States) -> dict[str, list[Floats]]:
    """Return the elements of each input array of a program, (B,) over the states, by name of the array."""
    count = len(states)
    values = {array.name: np.zeros((array.size, count)) for array in program.inputs}
    for parameter, row in zip(system.parameters, values.get("parameters", ()), strict=True):
        row[:] = parameter.value
    sampled = {"x": states.x, "y": states.y, "force": states.force, "torque": states.torque, **states.inputs}
    values |= {name: v.reshape(count, -1).T for name, v in sampled.items() if v is not None}
    return {name: list(rows) for name, rows in values.items()}


def _programs(system: System, solver: str) -> tuple[Program, Program]:
    """Return the programs of the losses and of their bounds."""
    form = derive_losses(system, solver)
    arrays = {Array(name, (len(system.freedoms),), "", ""): found for name, found in form.outputs.items()}
    both = lower_definitions(input_arrays(system), form.definitions, arrays)
    losses, bounds = (prune(replace(both, outputs=(output,))) for output in both.outputs)
    return losses, bounds


def _starting_states(system: System) -> States:
    """Return random states, the first half of them near the straight configuration {x} = {0}."""
    states = random_states(system, STATES)
    states.x[0] /= 128
    states.x[1 : STATES // 2] /= 4
    return states


def _bounds(system: System, program: Program) -> Floats:
    """Return the bounds of the losses, infinity where there is none."""
    values = {array.name: [0.0] * array.size for array in program.inputs}
    values["parameters"] = [parameter.value for parameter in system.parameters]
    with np.errstate(all="ignore"):
        found = np.array(evaluate(program, values, np, np.float64)["bounds"], dtype=float)
    return np.where(found > 0, found, np.inf)


def _climbed(system: System, program: Program, found: Losses) -> Losses:
    """Return the losses after a search."""
    rng, states, size = np.random.default_rng(0), found.states, ranges(system).x
    count, width = states.x.shape
    # Every freedom, and the product of all losses.
    aims: NDArray[np.int64] = np.arange(count, dtype=np.int64) % (1 + len(found.largest))
    current = _evaluated(system, program, states)
    largest = current.max(axis=0)
    x, most = states.x.copy(), max(1, LONGEST_SWEEP // len(program.instructions))
    coordinates = np.unique(np.linspace(0, width - 1, min(width, most)).astype(int))
    for step in STEPS:
        for j in coordinates:
            tried = np.repeat(x[:, None], TRIED_VALUES, axis=1)
            tried[:, :, j] += step * size[j] * rng.uniform(-1, 1, (count, TRIED_VALUES))
            losses = _evaluated(system, program, _repeated(states, tried))
            largest = np.maximum(largest, losses.max(axis=0))
            losses = losses.reshape(count, TRIED_VALUES, -1)
            best = _objective(losses, aims[:, None]).argmax(axis=1)
            better = losses[np.arange(count), best]
            moved = _objective(better, aims) > _objective(current, aims)
            x[moved], current[moved] = tried[np.arange(count), best][moved], better[moved]
    return replace(found, largest=largest, states=_repeated(states, np.stack([states.x, x], axis=1)))


def _evaluated(system: System, program: Program, states: States) -> Floats:
    """Return the (B, n) losses in states; infinity where a pivot is not positive."""
    with np.errstate(all="ignore"):
        rows = evaluate(program, array_inputs(system, program, states), np)["losses"]
    found = np.stack([np.broadcast_to(row, len(states)) for row in rows], axis=-1).astype(float)
    return np.where(found > 0, found, np.inf)


def _objective(losses: Floats, aims: NDArray[np.int64]) -> Floats:
    """Return what the search makes large: the loss of the freedom `aim`, or the logarithm of the product."""
    logarithms = np.log(losses)
    every = np.concatenate([logarithms, logarithms.sum(axis=-1, keepdims=True)], axis=-1)
    chosen = np.broadcast_to(aims, every.shape[:-1])[..., None]
    found: Floats = np.take_along_axis(every, chosen, axis=-1)[..., 0]
    return found


def _repeated(states: States, x: Floats) -> States:
    """Return the states with the (B, k, m) coordinates `x`, everything else repeated k times."""
    return replace(states.repeated(x.shape[1]), x=x.reshape(-1, x.shape[2]))
