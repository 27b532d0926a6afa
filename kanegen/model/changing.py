"""Other systems that come of one."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Self

from kanegen.choices import did_you_mean, require_one
from kanegen.errors import ModelError
from kanegen.model import selection as reported
from kanegen.model.body import Body
from kanegen.model.force_elements.element import ForceElement
from kanegen.model.freedoms import ORIENTATIONS, SPEEDS
from kanegen.model.joint import Joint
from kanegen.model.numbers import Number, Parameter, map_numbers
from kanegen.model.point import Point
from kanegen.model.right_angles import checked
from kanegen.model.sequences import NOTES
from kanegen.model.system_names import Named


@dataclass(frozen=True)
class Changing(Named):
    """The same tree with something else about it."""

    def with_points(self, points: Mapping[str, tuple[str | int, Any]]) -> Self:
        """The same system with further points.

        Args:
            points: By name the body, its name or number from 1, and (3,) the position from its origin, in
                body components (m).

        Raises:
            ModelError: If there is no such body, a name is taken or unusable, or a position is none.
        """
        bodies = list(self.bodies)
        for name, (body, position) in points.items():
            k = reported.body_number(bodies, body, f"point {name!r}") - 1
            bodies[k] = replace(bodies[k], points=(*bodies[k].points, Point(name, position)))
        return replace(self, bodies=tuple(bodies))

    def with_force_elements(self, *elements: ForceElement) -> Self:
        """The same system with further force elements.

        Raises:
            ModelError: If a name stands for nothing, or an element makes no sense where it acts.
        """
        return replace(self, force_elements=(*self.force_elements, *elements))

    def with_poses(self, bodies: Iterable[str | int] | None) -> Self:
        """The same system with other bodies in `body_poses`.

        Args:
            bodies: Names, or numbers from 1, in the order of the rows; None for all.

        Raises:
            ModelError: If one does not exist or is there twice, or there is none.
        """
        return replace(self, poses=reported.poses(self.bodies, bodies))

    def with_reactions(self, directions: Iterable[str] | None) -> Self:
        """The same system with other directions in `reaction_loads`.

        Args:
            directions: Names of locked freedoms such as `<body>.theta2`, in the order of the loads; None for
                all.

        Raises:
            ModelError: If one is free, does not exist or is there twice, or there is none.
        """
        return replace(self, reactions=reported.reactions(self.bodies, directions))

    def with_prescribed(self, names: Iterable[str] | str) -> Self:
        """The same system, where the motion of some freedoms is an input; they leave {x}, {y}, [A] and {f}.

        Args:
            names: Of free freedoms, one or several: `freedom_names`, or `<body>.theta1` ... `<body>.s3`.

        Raises:
            ModelError: If there is no such freedom, it is locked, or a joint cannot do without it.
        """
        every = {self._freedom_name(freedom): freedom for freedom in self._ordered(lambda joint: (True,) * 6)}
        bodies = list(self.bodies)
        for name in (names,) if isinstance(names, str) else names:
            if name not in every:
                free = [known for known, freedom in every.items() if freedom in self.places]
                raise ModelError(f"prescribed: there is no freedom {name!r}. {did_you_mean(name, free)}")
            k, index = every[name].body - 1, every[name].index
            if not bodies[k].joint.moving[index]:
                raise ModelError(f"prescribed: {name!r} is locked; free it, then prescribe it.")
            try:
                bodies[k] = replace(bodies[k], joint=bodies[k].joint.prescribing(index))
            except ModelError as error:
                raise ModelError(f"prescribed: {name!r}: {error}") from None
        return replace(self, bodies=tuple(bodies))

    def with_speeds(self, speeds: str) -> Self:
        """The same system with other generalized speeds at every joint that has three free angles.

        Args:
            speeds: One of `body.SPEEDS`: "angle_rates", or "angular_velocity" for the components of
                `omega_hat'_K`, Eq. (8), with which [A] is regular everywhere. Other joints stay as they are,
                and so do those with a quaternion, which has no angles.

        Raises:
            OptionError: If there are no such speeds.
        """
        require_one("speeds", speeds, SPEEDS)
        return self._turning(lambda joint: replace(joint, speeds=speeds))

    def with_coordinates(self, coordinates: str) -> Self:
        """The same system with other coordinates at every joint that has three free angles.

        Args:
            coordinates: One of `body.ORIENTATIONS`: "angles", in the sequence 1-2-3 where there were none, or
                "quaternion", with which neither [A] nor {xdot} is singular in any orientation. Other joints
                stay as they are. The speeds of a joint that had a quaternion stay its angular velocity.

        Raises:
            OptionError: If there are no such coordinates.
        """
        require_one("coordinates", coordinates, ORIENTATIONS)

        def change(joint: Joint) -> Joint:
            sequence = NOTES if coordinates == "quaternion" else joint.sequence
            return replace(joint, coordinates=coordinates, sequence=sequence)

        return self._turning(change)

    def with_right_angles(self, tolerance: float) -> Self:
        """The same system with exact right angles, where constant orientations miss them by little.

        Args:
            tolerance: How far (rad) an orientation or a locked angle may be from a right angle to be taken
                for it; 0 changes nothing. Parameters stay as they are.

        Raises:
            OptionError: If it makes no sense, see `right_angles.checked`.
        """
        limit = checked(tolerance)

        def exact(body: Body) -> Body:
            joint = body.joint.with_right_angles(limit)
            return body if joint == body.joint else replace(body, joint=joint)

        return replace(self, bodies=tuple(map(exact, self.bodies)))

    def _turning(self, change: Callable[[Joint], Joint]) -> Self:
        """The same system with `change` applied to every joint that has three free angles."""
        bodies = (
            replace(body, joint=change(body.joint)) if body.joint.turns_freely else body
            for body in self.bodies
        )
        return replace(self, bodies=tuple(bodies))

    def with_parameters(self, values: Mapping[str, float]) -> Self:
        """The same system with other default values of its parameters.

        Raises:
            ModelError: If a name is unknown or a value makes the model unusable.
        """
        known = [parameter.name for parameter in self.parameters]
        for name in values:
            if name not in known:
                raise ModelError(f"unknown parameter {name!r}. {did_you_mean(name, known)}")

        def change(value: Number) -> Number:
            if isinstance(value, Parameter) and value.name in values:
                return Parameter(value.name, values[value.name])
            return value

        return self.changed(change)

    def changed(self, change: Callable[[Number], Number]) -> Self:
        """The same system with `change` applied to every number."""
        bodies = tuple(body.changed(change) for body in self.bodies)
        elements = tuple(element.changed(change) for element in self.force_elements)
        return replace(
            self, bodies=bodies, gravity=map_numbers(self.gravity, change), force_elements=elements
        )
