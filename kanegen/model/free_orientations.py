"""Joints with three free angles in other coordinates or with other speeds, which keep their motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from kanegen.errors import ModelError, quoted, warn
from kanegen.model.body import Body
from kanegen.model.description import SystemDescription
from kanegen.model.joint import Joint
from kanegen.model.limits import without_angles


def with_free_orientations(system: SystemDescription, change: Callable[[Joint], Joint]) -> tuple[Body, ...]:
    """Return the bodies of a system with `change` applied to every joint that has three free angles.

    A joint with an angle that a coupled freedom follows stays as it is. Limits of the angles of a joint that
    becomes another one have no meaning any more.

    Raises:
        ModelError: If a joint has armature that would belong to other speeds.

    Warns:
        KanegenWarning: If there are such limits, which are left out.
    """
    bodies, without = list(system.bodies), []
    followed = {freedom.body for freedom in system.in_couplings if freedom.is_angle}
    for k, body in enumerate(system.bodies):
        joint = body.joint
        if not joint.has_free_orientation or k + 1 in followed:
            continue
        unlimited = replace(joint, limits=without_angles(joint.limits))
        changed = change(unlimited)
        if changed == unlimited:
            continue
        if any(joint.armature[:3]) and changed.speed_kinds != joint.speed_kinds:
            raise ModelError(
                f"body {quoted(body.name)}: the speeds of its angles cannot be changed, because their "
                "motors have armature, which would belong to others. Leave it out first."
            )
        without += [body.name] if changed.limits != joint.limits else []
        bodies[k] = replace(body, joint=changed)
    if without:
        warn(f"limits of angles are left out, which are other freedoms now: {', '.join(without)}.")
    return tuple(bodies)
