"""Damping and friction of a URDF file: `<dynamics damping= friction=>` as force elements, or what they cost.

They are read on request only, because URDF does not say how friction behaves about standstill, and because
other programs read the same file without them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from kanegen.errors import counted, quoted
from kanegen.model.arrays import SystemArrays
from kanegen.model.body import Body
from kanegen.model.coordinates import FREEDOMS
from kanegen.model.force_elements.element import ForceElement
from kanegen.model.force_elements.elements import JointFriction, JointSpring
from kanegen.model.system import System
from kanegen.readers.reader import FRICTION_SMOOTHING
from kanegen.readers.urdf_tree import MovingLink

MOST_NAMES = 3
"""Largest number of joints that a warning names for each kind."""


def dynamic_elements(moving: Sequence[MovingLink], bodies: Sequence[Body]) -> Iterator[ForceElement]:
    """Yield the force elements of joints with damping or friction.

    Args:
        moving: The moving links.
        bodies: The body of each moving link.
    """
    for link, body in zip(moving, bodies, strict=True):
        dynamics = link.joint.dynamics
        if dynamics.is_none:
            continue
        freedom = f"{body.name}.{FREEDOMS[_freedom(body)]}"
        if dynamics.damping:
            yield JointSpring(freedom, damping=dynamics.damping)
        if dynamics.friction:
            yield JointFriction(freedom, dynamics.friction, FRICTION_SMOOTHING)


def left_out(moving: Sequence[MovingLink], system: System, path: Path) -> str:
    """Return the warning that damping and friction are left out, "" where there is none.

    It says how much they change {ydot}: for the joint where it is most, by its inertia at {x} = {0}, with all
    other joints held.

    Args:
        moving: The moving links.
        system: The system, whose bodies are those of the moving links.
        path: The file.
    """
    found: list[str] = []
    kinds = (("damping", "N m s/rad, N s/m", " per rad/s or m/s"), ("friction", "N m, N", ""))
    for kind, units, per_rate in kinds:
        having = [
            (link.joint.name, k, value)
            for k, link in enumerate(moving)
            if (value := getattr(link.joint.dynamics, kind))
        ]
        if not having:
            continue
        named = ", ".join(f"{value:g} of {quoted(name)}" for name, _, value in having[:MOST_NAMES])
        more = f" and {counted(len(having) - MOST_NAMES, 'other')}" if len(having) > MOST_NAMES else ""
        found.append(f"{kind} ({units}): {named}{more}{_change(having, system, per_rate)}")
    if not found:
        return ""
    return (
        f"{path}: joint damping and friction are left out, which are read on request: joint_dynamics=True or "
        f"--joint-dynamics. {'; '.join(found)}."
    )


def _change(having: Sequence[tuple[str, int, float]], system: System, per_rate: str) -> str:
    """Return in words the largest change of an entry of {ydot}; "" where no joint moves mass or inertia.

    Args:
        having: Name of the joint, index of the body and value for each joint with damping, or with friction.
        system: The system.
        per_rate: The end of the unit.
    """
    arrays = system.values()
    inertias = [inertia_at_zero(arrays, k, _freedom(system.bodies[k])) for _, k, _ in having]
    changes = [
        (abs(value) / inertia, name)
        for (name, _, value), inertia in zip(having, inertias, strict=True)
        if inertia > 0
    ]
    if not changes:
        return ""
    largest, name = max(changes)
    size = f"{largest:.2g} rad/s^2 or m/s^2{per_rate}"
    return f", changing {{ydot}} by up to {size} (at {quoted(name)}, {{x}} = {{0}}, others held)"


def _freedom(body: Body) -> int:
    """Return the index in `FREEDOMS` of the only freedom of a body that moves."""
    return body.joint.moving.index(True)


def inertia_at_zero(arrays: SystemArrays, k: int, index: int) -> float:
    """Return the inertia that a freedom of a body moves at {x} = {0}, all others held (kg m^2, kg).

    Args:
        arrays: The numbers of the tree.
        k: Index of the body, from 0.
        index: Index of the freedom in `FREEDOMS`, the only one of its body that moves.
    """
    axis, total = np.eye(3)[index % 3], 0.0
    placed = {k: (np.eye(3), np.zeros(3))}  # rotation from body to that of k, origin from O_K in K
    for outer in range(k, len(arrays.mass)):
        lower = int(arrays.connection[outer]) - 1
        if outer != k and lower not in placed:
            continue
        if outer != k:
            turn, origin = placed[lower]
            offset = turn @ arrays.joint_position[outer]
            placed[outer] = turn @ arrays.joint_orientation[outer].T, origin + offset
        turn, origin = placed[outer]
        mass, arm = arrays.mass[outer], np.cross(axis, origin + turn @ arrays.mass_center[outer])
        along = turn.T @ axis
        total += mass if index >= 3 else float(along @ arrays.inertia[outer] @ along + mass * arm @ arm)
    return float(total)
