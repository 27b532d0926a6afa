"""What the C says about a system beside its programs."""

from __future__ import annotations

from kanegen.c import ModelFacts
from kanegen.model.sequences import NOTES
from kanegen.model.system import System
from kanegen.recursion.legend import legend


def facts(system: System) -> ModelFacts:
    """Names, units and sizes, in the order in which the C has them."""
    return ModelFacts(
        name=system.name,
        freedom_names=system.freedom_names,
        freedom_units=tuple(freedom.unit for freedom in system.freedoms),
        body_names=tuple(body.name for body in system.bodies),
        loaded=tuple(body.loads for body in system.bodies),
        parameters=tuple((parameter.name, parameter.value) for parameter in system.parameters),
        legend=legend(system),
        freedom_bodies=tuple(system.bodies[freedom.body - 1].name for freedom in system.freedoms),
        planar=_planar(system),
        sequences=_sequences(system),
        speed_names=system.speed_names,
        points=tuple((point.name, system.bodies[k - 1].name) for k, point in system.points),
        loaded_points=tuple(point.loads for _, point in system.points),
        force_elements=tuple(element.words for element in system.force_elements),
        poses=system.pose_names,
        reactions=tuple(zip(system.reaction_names, (f.effort for f in system.reacting), strict=True)),
        coordinate_names=system.coordinate_names,
        coordinate_units=tuple(coordinate.unit for coordinate in system.coordinates),
        prescribed=tuple(
            (name, freedom.unit)
            for name, freedom in zip(system.prescribed_names, system.prescribed, strict=True)
        ),
    )


def _sequences(system: System) -> tuple[tuple[str, str], ...]:
    """`ModelFacts.sequences`."""
    turning = [body for body in system.bodies if any(body.joint.free[:3])]
    return tuple((b.name, b.joint.sequence) for b in turning if b.joint.sequence != NOTES)


def _planar(system: System) -> tuple[tuple[int, str], ...]:
    """`ModelFacts.planar`: cos(theta2) for three different axes, sin(theta2) where first and third agree."""
    found = []
    for k, body in enumerate(system.bodies, start=1):
        if body.joint.turns_freely and not body.joint.spins:
            found.append((system.coordinate_place(k, 1), "sin" if body.joint.ends_alike else "cos"))
    return tuple(found)
