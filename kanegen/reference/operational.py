"""The inverse of [A] and the operational inertia of frames, with dense matrices (Khatib 1987).

A wrench {w} on a frame with Jacobian J adds J [A]^-1 J^T {w} to its acceleration {a}. With [Lambda] the
inverse of that matrix, [Lambda] {a} + {bias} = {w}, where {bias} = -[Lambda] {a_0} and {a_0} is the
acceleration of the frame for {w} = {0}.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.reference.equations import forcing, mass_matrix
from kanegen.reference.frames import frame_motions
from kanegen.reference.matrices import transposed
from kanegen.reference.regularity import equilibration
from kanegen.reference.states import random_states

STATES = 3
"""Number of random states in which directions are counted; almost all states have the same number."""

NEGLIGIBLE = 1e-9
"""Largest singular value that counts as zero, of a Jacobian whose largest entries are about 1."""


@dataclass(frozen=True)
class OperationalInertia:
    """Operational inertias of k frames; of six components the first three are angular, all are inertial.

    Attributes:
        inverse: (..., k, 6, 6) J [A]^-1 J^T (1/(kg m^2), 1/(kg m), 1/kg).
        inertia: (..., k, 6, 6) [Lambda], its inverse (kg m^2, kg m, kg).
        bias: (..., k, 6) the wrench for which the frame does not accelerate (N m, N).
    """

    inverse: Floats
    inertia: Floats
    bias: Floats


def mass_matrix_inverse(system: System, x: ArrayLike, prescribed: ArrayLike | None = None) -> Floats:
    """Return the (..., n, n) inverse of [A].

    Args:
        system: The tree; parameters stand at their defaults.
        x: (m,) or (B, m) coordinates (rad, m, 1).
        prescribed: (3, p) or (B, 3, p) motion of the prescribed freedoms.

    Example:
        >>> mass_matrix_inverse(kg.load("models/double_pendulum.toml"), [0.3, 0.4])
    """
    return np.linalg.inv(np.asarray(mass_matrix(system, x, prescribed)))


def operational_inertia(
    system: System,
    names: Sequence[str],
    x: ArrayLike,
    y: ArrayLike,
    tau: ArrayLike,
    prescribed: ArrayLike | None = None,
    **loads: Any,
) -> OperationalInertia:
    """Return the operational inertias and biases of some frames, which must move in six directions.

    Args:
        system: The tree; parameters stand at their defaults.
        names: Names of the frames.
        x: (m,) or (B, m) coordinates (rad, m, 1).
        y: (n,) or (B, n) generalized speeds.
        tau: (n,) or (B, n) generalized forces.
        prescribed: (3, p) or (B, 3, p) motion of the prescribed freedoms.
        loads: Further inputs of `forcing`.

    Example:
        >>> operational_inertia(system, ["tool0"], x, y, np.zeros(6)).inertia
    """
    a: Floats = np.asarray(mass_matrix(system, x, prescribed))
    f: Floats = np.asarray(forcing(system, x, y, prescribed=prescribed, **loads))
    ydot = np.linalg.solve(a, np.asarray(f + np.asarray(tau, dtype=float))[..., None])[..., 0]
    found = frame_motions(system, names, x, y, ydot, prescribed)
    jacobians: Floats = np.asarray(found.jacobians)
    inverse = jacobians @ np.linalg.solve(a[..., None, :, :], transposed(jacobians))
    inertia = np.linalg.inv(inverse)
    return OperationalInertia(inverse, inertia, -(inertia @ found.accelerations[..., None])[..., 0])


def frame_without_six(system: System) -> tuple[str, int] | None:
    """Return the first selected frame that accelerates in fewer than six directions in every state.

    Parameters stand at their defaults.

    Args:
        system: The tree.

    Returns:
        The name of the frame and the number of its directions; None if all frames have six.

    Example:
        >>> frame_without_six(kg.load("models/scara.toml").with_poses(["tool"]))
        ('tool', 4)
    """
    few = [frame.name for frame in system.pose_frames if _moving_freedoms(system, frame.body) < 6]
    names = few[:1] or system.pose_names
    arrays = system.values()
    states = random_states(arrays, STATES)
    still = np.zeros_like(states.y)
    jacobians = frame_motions(arrays, names, states.x, still, still, states.prescribed).jacobians
    for i, name in enumerate(names):
        rank = max(_rank(jacobian) for jacobian in jacobians[:, i])
        if rank < 6:
            return name, rank
    return None


def _moving_freedoms(system: System, body: int) -> int:
    """Return the number of free and coupled freedoms on the path of a body, at least its directions."""
    moving = {*system.freedoms, *(one.freedom for one in system.coupled)}
    found = 0
    while body:
        found += sum(freedom.body == body for freedom in moving)
        body = system.connection[body - 1]
    return found


def _rank(jacobian: Floats) -> int:
    """Return the rank of a (6, n) Jacobian, whatever the units of lengths."""
    rows, columns = equilibration(np.abs(jacobian))
    values = np.linalg.svd(rows[:, None] * jacobian * columns, compute_uv=False)
    return int(np.sum(values > NEGLIGIBLE))
