"""What exact right angles change: the model, the results and the operations."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from kanegen import compiler
from kanegen.model.arrays import Floats, SystemArrays
from kanegen.model.system import System
from kanegen.options import Progress, quiet
from kanegen.recursion.outputs import EQUATIONS
from kanegen.reference import equations as reference
from kanegen.reference.states import random_states

STATES = 64
"""Random states in which results are compared."""

COUNTED = (EQUATIONS, ("forward_dynamics",))
"""Outputs, each tuple together, whose operations are counted."""


@dataclass(frozen=True)
class Changed:
    """A body that is not quite the same.

    Attributes:
        body: Its name.
        turned: How far its constant angles, or the frame of its joint, are turned at most (rad).
        shifted: How far its joint or its mass centre is shifted at most (m); links welded to it do that.
        inertia: The largest change of an entry, over the largest entry.
    """

    body: str
    turned: float
    shifted: float
    inertia: float


@dataclass(frozen=True)
class Exactness:
    """A model with exact right angles beside the model as written.

    Attributes:
        bodies: Those that differ.
        results: The largest change of [A], {f} and {ydot} in random states, relative to their norms.
        operations: As written and exact, by the outputs that are computed together.
    """

    bodies: tuple[Changed, ...]
    results: dict[str, float]
    operations: dict[str, tuple[int, int]]

    @property
    def turned(self) -> float:
        """The largest angle (rad)."""
        return max(body.turned for body in self.bodies)

    def as_dict(self) -> dict[str, Any]:
        """Everything as plain data."""
        return {
            "bodies": [asdict(body) for body in self.bodies],
            "results": self.results,
            "operations": {
                name: {"as_written": written, "exact": exact}
                for name, (written, exact) in self.operations.items()
            },
        }


def exactness(
    written: System, exact: System, progress: Progress = quiet, states: int = STATES, seed: int = 0
) -> Exactness | None:
    """What making right angles exact has changed; None where the two systems are equal.

    Args:
        written: The system as its file, or its maker, has it.
        exact: The same with exact right angles.
        progress: Told the name of each stage.
        states: How many random states.
        seed: Of the states.

    Raises:
        SingularError: If [A] is singular in every state.
    """
    if written == exact:
        return None
    operations = {
        " + ".join(names): (_operations(written, names, progress), _operations(exact, names, progress))
        for names in COUNTED
    }
    progress("comparing")
    before, after = written.values(), exact.values()
    names = [body.name for body in written.bodies]
    return Exactness(tuple(_changed(names, before, after)), _results(before, after, states, seed), operations)


def _operations(system: System, names: tuple[str, ...], progress: Progress) -> int:
    operations = compiler.compile_module(system, names, progress).operations
    return sum(operations.values()) - operations["prepare"]


def _changed(names: list[str], before: SystemArrays, after: SystemArrays) -> Iterator[Changed]:
    """The bodies that differ; a turn by a small angle moves a matrix by sqrt(2) of it (Frobenius)."""
    frames = np.linalg.norm(after.joint_orientation - before.joint_orientation, axis=(1, 2)) / np.sqrt(2)
    angles = np.abs(after.locked - before.locked).max(axis=1)
    joints = np.linalg.norm(after.joint_position - before.joint_position, axis=1)
    centers = np.linalg.norm(after.mass_center - before.mass_center, axis=1)
    inertias = np.abs(after.inertia - before.inertia).max(axis=(1, 2))
    sizes = np.abs(before.inertia).max(axis=(1, 2))
    inertias = np.divide(inertias, sizes, out=inertias, where=sizes > 0)
    turned, shifted = np.maximum(frames, angles), np.maximum(joints, centers)
    for name, *row in zip(names, turned.tolist(), shifted.tolist(), inertias.tolist(), strict=True):
        if any(row):
            yield Changed(name, *row)


def _results(before: SystemArrays, after: SystemArrays, states: int, seed: int) -> dict[str, float]:
    """With D = diag([A])^(1/2), which takes the units away, of D^-1 [A] D^-1, D^-1 {f} and D {ydot}."""
    sample = random_states(before, states, seed)
    state, loads, given = (sample.x, sample.y), (sample.force, sample.torque), sample.inputs
    a, other_a = (reference.mass_matrix(arrays, sample.x, sample.prescribed) for arrays in (before, after))
    f, other_f = (reference.forcing(arrays, *state, *loads, **given) for arrays in (before, after))
    d = np.sqrt(np.einsum("bii->bi", a))
    ydot = np.linalg.solve(a, f[..., None])[..., 0]
    other_ydot = np.linalg.solve(other_a, other_f[..., None])[..., 0]
    return {
        "mass_matrix": _change(a, other_a, 1 / (d[:, :, None] * d[:, None, :])),
        "forcing": _change(f, other_f, 1 / d),
        "ydot": _change(ydot, other_ydot, d),
    }


def _change(value: Floats, other: Floats, scale: Floats) -> float:
    """The largest norm of a difference over that of the value, state by state; 0 where both are 0."""
    states = len(value)
    difference = np.linalg.norm(((other - value) * scale).reshape(states, -1), axis=1)
    size = np.linalg.norm((value * scale).reshape(states, -1), axis=1)
    return float(np.divide(difference, size, out=difference, where=size > 0).max())
