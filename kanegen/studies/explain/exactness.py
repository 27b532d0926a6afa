"""The changes that exact right angles make to a model: its bodies, its results and its operations."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from kanegen import compiler
from kanegen.model.arrays import Floats, SystemArrays
from kanegen.model.system import System
from kanegen.options import Progress, quiet
from kanegen.recursion.outputs import EQUATIONS, solving
from kanegen.reference import equations as reference
from kanegen.reference.regularity import massless_motions
from kanegen.reference.states import States, random_states

STATES = 64
"""Number of random states in which results are compared."""

COUNTED = (EQUATIONS, ("forward_dynamics",))
"""The groups of outputs whose operations are counted; the outputs of a group are computed together."""


@dataclass(frozen=True)
class BodyChange:
    """The change of a body by exact right angles.

    Attributes:
        body: Name of the body.
        turned: Largest change of its locked angles and of the orientation of its joint frame (rad).
        shifted: Largest shift of its joint and of its mass centre (m), which links welded to it cause.
        inertia: Largest change of an entry of its inertia, relative to the largest entry.
    """

    body: str
    turned: float
    shifted: float
    inertia: float


@dataclass(frozen=True)
class Exactness:
    """The changes of a model by exact right angles.

    Attributes:
        bodies: The bodies that change.
        results: Largest change of [A], {f} and {ydot} in random states, relative to their norms; {ydot} is
            left out where [A] is singular in every state.
        operations: Numbers of operations as written and with exact right angles, by group of outputs.
    """

    bodies: tuple[BodyChange, ...]
    results: dict[str, float]
    operations: dict[str, tuple[int, int]]

    @property
    def turned(self) -> float:
        """The largest change of an orientation of any body (rad)."""
        return max(body.turned for body in self.bodies)

    def as_dict(self) -> dict[str, Any]:
        """Return all fields as plain data for JSON."""
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
    """Compare a system with the same system with exact right angles.

    Args:
        written: The system as written.
        exact: The system with exact right angles.
        progress: Function that receives the name of each stage.
        states: Number of random states.
        seed: Seed of the random states.

    Returns:
        The changes; None if the two systems are equal.
    """
    if written == exact:
        return None
    is_regular = not (massless_motions(written) or massless_motions(exact))
    operations = {
        " + ".join(names): (_operations(written, names, progress), _operations(exact, names, progress))
        for names in COUNTED
        if is_regular or not solving(names)
    }
    progress("comparing")
    before, after = written.values(), exact.values()
    names = [body.name for body in written.bodies]
    return Exactness(
        tuple(_body_changes(names, before, after)),
        _results(before, after, random_states(before, states, seed, written.limits), is_regular=is_regular),
        operations,
    )


def _operations(system: System, names: tuple[str, ...], progress: Progress) -> int:
    """Return the number of operations of one evaluation."""
    operations = compiler.compile_module(system, names, progress).operations
    return sum(operations.values()) - operations["prepare"]


def _body_changes(names: list[str], before: SystemArrays, after: SystemArrays) -> Iterator[BodyChange]:
    """Yield the bodies that change; the Frobenius norm of a small turn is sqrt(2) times its angle."""
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
            yield BodyChange(name, *row)


def _results(
    before: SystemArrays, after: SystemArrays, sample: States, *, is_regular: bool
) -> dict[str, float]:
    """Return the changes of D^-1 [A] D^-1, D^-1 {f} and D {ydot}, without units by D = diag([A])^(1/2)."""
    state, loads, given = (sample.x, sample.y), (sample.force, sample.torque), sample.inputs
    a, other_a = (reference.mass_matrix(arrays, sample.x, sample.prescribed) for arrays in (before, after))
    f, other_f = (reference.forcing(arrays, *state, *loads, **given) for arrays in (before, after))
    d = np.sqrt(np.einsum("bii->bi", a))
    d = np.where(d > 0, d, 1.0)
    found = {
        "mass_matrix": _change(a, other_a, 1 / (d[:, :, None] * d[:, None, :])),
        "forcing": _change(f, other_f, 1 / d),
    }
    if not is_regular:
        return found
    ydot = np.linalg.solve(a, f[..., None])[..., 0]
    other_ydot = np.linalg.solve(other_a, other_f[..., None])[..., 0]
    return {**found, "ydot": _change(ydot, other_ydot, d)}


def _change(value: Floats, other: Floats, scale: Floats) -> float:
    """Return the largest ratio, over all states, of the norm of the change to the norm of the value."""
    states = len(value)
    difference = np.linalg.norm(((other - value) * scale).reshape(states, -1), axis=1)
    size = np.linalg.norm((value * scale).reshape(states, -1), axis=1)
    return float(np.divide(difference, size, out=difference, where=size > 0).max())
