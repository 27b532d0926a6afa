"""Trees and evaluations for tests of iterative refinement."""

from __future__ import annotations

from functools import cache

import numpy as np

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.options import Variant
from kanegen.program.evaluate import evaluate
from kanegen.program.precision import Precision
from kanegen.reference import equations as reference
from kanegen.reference.states import States, random_states
from tests.support import systems

FORWARD = ("forward_dynamics",)
SOLVERS = ("articulated bodies", "factorisation")


@cache
def rods(ratio: float, bodies: int = 8) -> kg.System:
    """Return a planar chain of slender rods of 1 m, each heavier than the one before by `ratio`."""
    mass = np.array([ratio**k for k in range(bodies)])
    along = np.array([1.0, 0.0, 0.0])
    return kg.System.from_arrays(
        connection=range(bodies),
        mass=mass,
        inertia=[m * np.diag([1 / 512, 1 / 12, 1 / 12]) for m in mass],
        mass_center=np.tile(0.5 * along, (bodies, 1)),
        joint_position=np.outer(np.arange(bodies) > 0, along),
        free=systems.flags(bodies, ["theta3"]),
        gravity=(0.0, -9.81, 0.0),
        name="rods",
    )


def sample(system: kg.System, count: int, seed: int, precision: Precision) -> tuple[States, np.ndarray]:
    """Return random states and generalized forces, rounded to the precision."""
    states = random_states(system, count, seed)
    diagonal = np.diagonal(reference.mass_matrix(system, states.x), axis1=1, axis2=2)
    tau = np.random.default_rng(seed).uniform(-3, 3, states.x.shape) * diagonal
    return states.rounded(precision), tau.astype(precision.dtype).astype(float)


@cache
def mixed(seed: int) -> kg.System:
    """Return a random tree with all kinds of joints and with loads."""
    rng = np.random.default_rng(seed)
    free = systems.random_free(rng, 4, 0.3)
    free[1], free[2] = True, [True] * 3 + [False] * 3
    return systems.random_system(rng, 4, free=free, loads=True)


def computed(
    system: kg.System, states: States, tau: np.ndarray, outputs: tuple[str, ...] = FORWARD, **choices: object
) -> np.ndarray:
    """Return the outputs of all states, (..., B, n), operation by operation as C computes them."""
    functions = compile_module(system, outputs, variant=Variant(**choices)).module.functions
    given = {"x": states.x, "y": states.y, "tau": tau, "force": states.force, "torque": states.torque}
    given |= states.inputs
    flat = {name: list(v.reshape(len(states), -1).T) for name, v in given.items() if v is not None}
    program = functions.get("evaluate") or functions[outputs[0]]
    found = evaluate(program, flat, np).values()
    rows = [[np.broadcast_to(row, len(states)) for row in output] for output in found]
    return np.squeeze(np.swapaxes(rows, 1, 2))
