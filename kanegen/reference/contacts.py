"""Accelerations and loads under contacts, from the whole matrix of the equations for both.

With the Jacobian J of the held directions, made of the partial velocities of the notes,

    [ A  -J^T ] [ ydot   ]   [ f + tau           ]
    [ J    mu ] [ lambda ] = [ -d/dt(J) y        ]

in which mu is the diagonal of dampings. Nothing is eliminated by hand, and no sparsity is used.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike

from kanegen.model.arguments import LoadInputs
from kanegen.model.arrays import FrameArrays, SystemArrays
from kanegen.model.contact import Contact
from kanegen.model.numbers import map_numbers, value_of
from kanegen.model.system import System
from kanegen.reference import equations
from kanegen.reference.arguments import arguments
from kanegen.reference.frames import frame_motions
from kanegen.reference.matrices import Numbers


@dataclass(frozen=True)
class ContactMotion:
    """The motion of a system whose contacts hold.

    Attributes:
        ydot: (..., n) generalized accelerations (rad/s^2, m/s^2).
        forces: (..., m) loads by row, as the output `contact_forces` has them (N m, N).
        jacobian: (..., m, n) partial velocities along the rows by {y}.
        bias: (..., m) accelerations along the rows for {ydot} = 0 (rad/s^2, m/s^2).
    """

    ydot: Numbers
    forces: Numbers
    jacobian: Numbers
    bias: Numbers


def contact_motion(
    system: System,
    x: ArrayLike,
    y: ArrayLike,
    tau: ArrayLike | None = None,
    force: ArrayLike | None = None,
    torque: ArrayLike | None = None,
    prescribed: ArrayLike | None = None,
    **loads: Unpack[LoadInputs],
) -> ContactMotion:
    """Return accelerations and loads of a system whose contacts hold.

    Args:
        system: The tree with its contacts; parameters stand at their defaults.
        x: (m,) or (B, m) coordinates (rad, m, 1).
        y: (n,) or (B, n) generalized speeds.
        tau: (n,) or (B, n) generalized forces; default none.
        force: Forces on the bodies, as in `equations.forcing`.
        torque: Torques on the bodies, as in `equations.forcing`.
        prescribed: As in `equations.mass_matrix`.
        loads: Loads on points, and the time, by name.

    Raises:
        ArrayError: If an array has another shape.
        LinAlgError: If the held directions depend on each other.

    Example:
        >>> system = kg.load("models/double_pendulum.toml").with_contacts(kg.Contact(point="tip"))
        >>> contact_motion(system, [0.3, 0.4], [1.0, 2.0]).forces
    """
    jacobian, bias = constraint_rows(system, x, y, prescribed)
    matrix = equations.mass_matrix(system, x, prescribed)
    right = equations.forcing(system, x, y, force, torque, prescribed, **loads)
    right = right if tau is None else right + np.asarray(tau)
    damping = np.diag([value_of(row.contact.damping) for row in system.contact_rows])
    lower = np.concatenate([jacobian, np.broadcast_to(damping, (*bias.shape, len(damping)))], axis=-1)
    upper = np.concatenate([matrix, -np.swapaxes(jacobian, -1, -2)], axis=-1)
    whole, known = np.concatenate([upper, lower], axis=-2), np.concatenate([right, -bias], axis=-1)
    found = np.linalg.solve(whole, known[..., None])[..., 0]
    n = matrix.shape[-1]
    return ContactMotion(found[..., :n], found[..., n:], jacobian, bias)


def constraint_rows(
    system: System, x: ArrayLike, y: ArrayLike, prescribed: ArrayLike | None = None
) -> tuple[Numbers, Numbers]:
    """Return the (..., m, n) Jacobian of held directions, and their (..., m) accelerations for {ydot} = 0.

    The arguments are those of `contact_motion`.
    """
    arrays = system.values()
    names = [f"contact {place}" for place, _ in enumerate(system.contacts)]
    frames = (held_frame(system, arrays, contact) for contact in system.contacts)
    held = dict(zip(names, frames, strict=True))
    extended = replace(arrays, frames={**arrays.frames, **held})
    passed = arguments(arrays, x, y, None, None, prescribed)
    motion = frame_motions(extended, names, passed.x, passed.y, 0 * passed.y, prescribed)
    chosen = [(place, row.index) for place, one in enumerate(system.contacts) for row in one.rows()]
    contacts, indices = np.array(chosen).T
    return motion.jacobians[..., contacts, indices, :], motion.bias[..., contacts, indices]


def held_frame(system: System, arrays: SystemArrays, contact: Contact) -> FrameArrays:
    """Return a frame without turn whose origin is what a contact holds.

    Args:
        system: The tree.
        arrays: Its numbers.
        contact: The contact.
    """
    k, point = system.held(contact)
    position = np.array(map_numbers(point.position, value_of))
    if point.frame:
        position = arrays.frames[point.frame].point(position)
    return FrameArrays(k, position, np.eye(3))
