"""Joints that are changed at some freedoms, by the names of these: prescribed motion, limits."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from kanegen.errors import ModelError, quoted
from kanegen.model import validation
from kanegen.model.body import Body
from kanegen.model.description import SystemDescription

EXAMPLE = '{"elbow": {"position": (-1.5, 1.5), "speed": 2.0}}'


def bodies_with_prescribed(system: SystemDescription, names: Any) -> tuple[Body, ...]:
    """Return the bodies of a system with some freedoms prescribed; see `System.with_prescribed`.

    Raises:
        ModelError: If there is no such freedom, it is locked or coupled, or its joint needs it free.
    """
    bodies = list(system.bodies)
    for name in (names,) if isinstance(names, str) else validation.sequence(names, None, "prescribed"):
        freedom = system.freedom(name, "prescribed")
        k, index = freedom.body - 1, freedom.index
        if not bodies[k].joint.moving[index]:
            raise ModelError(f"prescribed: {quoted(name)} is locked; free it, then prescribe it.")
        if bodies[k].joint.coupled[index]:
            raise ModelError(f"prescribed: {quoted(name)} is coupled. A freedom is one or the other.")
        try:
            bodies[k] = replace(bodies[k], joint=bodies[k].joint.with_prescribed(index))
        except ModelError as error:
            raise ModelError(f"prescribed: {quoted(name)}: {error}") from None
    return tuple(bodies)


def bodies_with_limits(system: SystemDescription, limits: Any) -> tuple[Body, ...]:
    """Return the bodies of a system with other limits of some freedoms; see `System.with_limits`.

    Raises:
        ModelError: If there is no such freedom, it is locked, or a limit is not usable.
    """
    bodies = list(system.bodies)
    for name, table in validation.table(limits, "limits", EXAMPLE).items():
        freedom = system.freedom(name, "limits")
        k, joint = freedom.body - 1, bodies[freedom.body - 1].joint
        try:
            joint = replace(joint, limits=joint.limits.with_freedom(freedom.index, table))
        except ModelError as error:
            raise ModelError(f"{quoted(name)}: {error}") from None
        bodies[k] = replace(bodies[k], joint=joint)
    return tuple(bodies)
