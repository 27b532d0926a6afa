"""What everything in a system is called."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from kanegen.model import selection as reported
from kanegen.model.coordinates import Freedom
from kanegen.model.description import Description
from kanegen.model.freedoms import FREEDOMS


@dataclass(frozen=True)
class Named(Description):
    """Names of freedoms, coordinates, speeds and points, and of what outputs are about."""

    @cached_property
    def freedom_names(self) -> tuple[str, ...]:
        """n unique names of the freedoms: the joint's name, or `<body>.theta1` ... `<body>.s3`.

        Where a quaternion turns the body, they are `<body>.omega1`, `omega2`, `omega3`.
        """
        names = zip(self.freedoms, self.speed_names, strict=True)
        return tuple(
            name if self.bodies[freedom.body - 1].joint.is_quaternion else self._freedom_name(freedom)
            for freedom, name in names
        )

    @cached_property
    def coordinate_names(self) -> tuple[str, ...]:
        """Unique names in the order of {x}: of the freedoms, or `<body>.e0` ... `<body>.e3`."""
        return tuple(
            self._freedom_name(Freedom(coordinate.body, coordinate.index))
            if coordinate.index < len(FREEDOMS)
            else f"{self.bodies[coordinate.body - 1].name}.{coordinate.name}"
            for coordinate in self.coordinates
        )

    @cached_property
    def speed_names(self) -> tuple[str, ...]:
        """n unique names in the order of {y}: of the coordinate whose rate it is, or of the component.

        The components of a relative angular velocity, Eq. (8), are `<body>.omega1`, `omega2`, `omega3`.
        """
        return tuple(
            f"{self.bodies[freedom.body - 1].name}.omega{freedom.axis + 1}"
            if self.spins(freedom)
            else self._freedom_name(freedom)
            for freedom in self.freedoms
        )

    @cached_property
    def prescribed_names(self) -> tuple[str, ...]:
        """Their names, made as `freedom_names`: the order of the columns of the input `prescribed`."""
        return tuple(self._freedom_name(freedom) for freedom in self.prescribed)

    def _freedom_name(self, freedom: Freedom) -> str:
        body = self.bodies[freedom.body - 1]
        if body.joint.name and body.joint.moving[freedom.index] and sum(body.joint.moving) == 1:
            return body.joint.name
        return f"{body.name}.{FREEDOMS[freedom.index]}"

    @cached_property
    def point_names(self) -> tuple[str, ...]:
        """Their names, in this order: that of the rows of outputs that are about points."""
        return tuple(point.name for _, point in self.points)

    @cached_property
    def pose_names(self) -> tuple[str, ...]:
        """Names of the bodies of `body_poses`, in the order of its rows."""
        return tuple(body.name for body in self.bodies) if self.poses is None else self.poses

    @cached_property
    def posed(self) -> tuple[int, ...]:
        """Their numbers, from 1."""
        numbers_of = {body.name: k for k, body in enumerate(self.bodies, start=1)}
        return tuple(numbers_of[name] for name in self.pose_names)

    @cached_property
    def reaction_names(self) -> tuple[str, ...]:
        """Names of the locked directions of `reaction_loads`, in its order; by default that of {y}."""
        return tuple(reported.locked(self.bodies)) if self.reactions is None else self.reactions

    @cached_property
    def reacting(self) -> tuple[Freedom, ...]:
        """The same as freedoms."""
        known = reported.locked(self.bodies)
        return tuple(Freedom(*known[name]) for name in self.reaction_names)
