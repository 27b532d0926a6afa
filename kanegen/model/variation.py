"""`SystemVariations`: the same system with other points, loads, contacts, freedoms or limits."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

from kanegen.choices import require_one
from kanegen.model import locking, output_rows, validation
from kanegen.model.attaching import EXAMPLE, bodies_with_loads, bodies_with_points, new_frame
from kanegen.model.body import Body
from kanegen.model.contact import Contact, chosen_contacts
from kanegen.model.coordinates import NOTES, ORIENTATIONS, SPEEDS
from kanegen.model.coupling import Coupling
from kanegen.model.force_elements.element import ForceElement
from kanegen.model.free_orientations import with_free_orientations
from kanegen.model.joint import Joint
from kanegen.model.joint_changes import bodies_with_limits, bodies_with_prescribed
from kanegen.model.parametrisation import SystemParametrisation
from kanegen.model.reaction import reaction_rows
from kanegen.model.right_angles import checked_tolerance
from kanegen.model.rotor import Rotor


@dataclass(frozen=True)
class SystemVariations(SystemParametrisation):
    """The methods of a `System` that return the same system with something changed."""

    def with_points(self, points: Mapping[str, tuple[str | int, Any]]) -> Self:
        """Return the same system with further points.

        Args:
            points: Frame or body, and (3,) position from its origin, in its components (m), by name of the
                point. A frame goes by its name, a body by its name or number from 1.

        Raises:
            ModelError: If there is no such frame, it is fixed to the ground, a name is taken or unusable, or
                a position is not three numbers.

        Example:
            system.with_points({"tip": ("hand", (0, 0, 0.1))})
        """
        return replace(self, bodies=bodies_with_points(self, points))

    def with_frames(self, frames: Mapping[str, Sequence[Any]]) -> Self:
        """Return the same system with further frames, fixed in bodies or in the ground.

        Args:
            frames: Frame or body, (3,) position of the origin in its components (m), and, if it is turned,
                the orientation, by name of the new frame. The orientation takes components of the frame
                or body to those of the new frame: a (3, 3) rotation, or three 1-2-3 angles (rad). A frame
                goes by its name, a body by its name or number from 1, the inertial frame by "ground". A new
                frame with the name of its own body becomes the frame of this body for its user.

        Raises:
            ModelError: If there is no such frame, a name is taken or unusable, or a position or orientation
                is no such thing.

        Example:
            system.with_frames({"tool": ("hand", (0, 0, 0.1)), "camera": ("tool", (0, 0, 0), (0.2, 0, 0))})
        """
        found = self
        for name, value in validation.table(frames, "frames", EXAMPLE).items():
            found = replace(found, frames=(*found.frames, new_frame(found, name, value)))
        return found

    def with_loads(self, names: Iterable[str | int] | str) -> Self:
        """Return the same system with further loads as inputs, on points, bodies and frames.

        The load on a point is a force there and a moment, in inertial components unless the point has a
        `load_frame`; that on a body is a force at its mass centre and a torque, in components of the frame
        of the body. A further frame gets a point of its own name at its origin, which takes a force and a
        moment in components of the frame.

        Args:
            names: Names of points, bodies and frames, or numbers of bodies from 1, one or several. A name
                means a point if there is one, else a body, else a frame.

        Raises:
            ModelError: If there is nothing of a name, it is fixed to the ground, or none is named.

        Example:
            system.with_loads(["trunk", "tool"])
        """
        return replace(self, bodies=bodies_with_loads(self, names))

    def with_force_elements(self, *elements: ForceElement) -> Self:
        """Return the same system with further force elements.

        Raises:
            ModelError: If a name in an element is unknown, or an element cannot act on the named freedom or
                points.

        Example:
            system.with_force_elements(kg.JointSpring("elbow.theta3", stiffness=40.0))
        """
        return replace(self, force_elements=(*self.force_elements, *elements))

    def with_poses(self, frames: Iterable[str | int] | None) -> Self:
        """Return the same system with another selection of frames in `body_poses`.

        Args:
            frames: Names of frames and bodies, or numbers of bodies from 1, in the order of the rows; None
                for all bodies.

        Raises:
            ModelError: If a frame does not exist or is named twice, or none is named.

        Example:
            system.with_poses(["hand", "tool"])
        """
        return replace(self, poses=output_rows.poses(self.frame, frames))

    def with_reactions(self, directions: Iterable[str] | None) -> Self:
        """Return the same system with another selection of loads in `reaction_loads`.

        Args:
            directions: Names of locked freedoms such as `<body>.theta2`, of components in a frame of a body
                such as `<frame>.moment1` or `<frame>.force3`, or of frames and bodies for all six components,
                in the order of the loads; None for those of all joints.

        Raises:
            ModelError: If a direction is free, does not exist or is named twice, or none is named.

        Example:
            system.with_reactions(["arm.s3", "tool"])
        """
        return replace(self, reactions=None if directions is None else self._reactions(directions))

    def _reactions(self, chosen: Any) -> tuple[str, ...]:
        """Return the names of the rows of `reaction_loads` that are chosen."""
        return tuple(row.name for row in reaction_rows(self.bodies, self.frames_by_name, chosen))

    def with_name(self, name: str) -> Self:
        """Return the same system with another name, with whose identifier generated code begins.

        Raises:
            ModelError: If the name is blank or contains a control character.

        Example:
            kg.load("2dof-planar.urdf").with_name("planar").identifier  # 'planar'
        """
        return replace(self, name=name)

    def with_geometry(self, path: str | os.PathLike[str] | None) -> Self:
        """Return the same system with another file whose shapes pictures show.

        Args:
            path: A URDF or MJCF file whose links or bodies are frames of this system; None for no shapes.

        Raises:
            ModelError: If `path` is no path.

        Example:
            kg.view(kg.load("arm.toml").with_geometry("arm.urdf"))
        """
        return replace(self, geometry=validation.file(path, "geometry"))

    def with_prescribed(self, names: Iterable[str] | str) -> Self:
        """Return the same system with the motion of some freedoms as an input; they leave {x}, {y}, [A], {f}.

        Args:
            names: Names of free freedoms, one or several: `freedom_names`, or `<body>.theta1` to `<body>.s3`.

        Raises:
            ModelError: If there is no such freedom, it is locked, or its joint needs it free.

        Example:
            system.with_prescribed("trolley.s1")
        """
        return replace(self, bodies=bodies_with_prescribed(self, names))

    def with_locked(self, values: Mapping[str, Any]) -> Self:
        """Return the same system with some freedoms locked at values; they leave {x}, {y}, [A] and {f}.

        The equations are those of this system at these values, with speeds and accelerations of zero there.
        Bodies that no longer move relative to each other cost nothing more. Force elements on a locked
        freedom stay, with its constant value as coordinate and no speed. Its limits are left out. A
        coupled freedom that follows only locked freedoms is locked too.

        Args:
            values: Value (rad, m), a number or a parameter, by name of the freedom: one of `freedom_names`,
                a prescribed one, or `<body>.theta1` to `<body>.s3`, which may be locked already. An
                orientation with three free angles is locked as a whole by the name of its joint, or of its
                body where the joint has none: its coordinates, three angles or four Euler parameters.

        Raises:
            ModelError: If there is no such freedom or it is coupled, a value is no number, only a part of an
                orientation is locked whose speeds are its angular velocity, or nothing is left free.

        Warns:
            KanegenWarning: If a value is outside the limits of its freedom, or a drive on a component of a
                locked angular velocity is left out.

        Example:
            system.with_locked({"finger_joint1": 0.02, "wrist": (1, 0, 0, 0)})
        """
        return replace(self, **locking.with_locked(self, values))

    def with_limits(self, limits: Mapping[str, Mapping[str, Any]]) -> Self:
        """Return the same system with other limits of some freedoms.

        Args:
            limits: By name of a free or prescribed freedom a table with "position" (two numbers, rad or m),
                "speed" (rad/s, m/s) and "effort" (N m, N); what is left out has no limit.

        Raises:
            ModelError: If there is no such freedom, it is locked, or a limit is not usable.

        Example:
            system.with_limits({"elbow": {"position": (-1.5, 1.5), "speed": 2.0, "effort": 87.0}})
        """
        return replace(self, bodies=bodies_with_limits(self, limits))

    def with_couplings(self, *couplings: Coupling) -> Self:
        """Return the same system with further couplings; coupled freedoms leave {x}, {y}, [A], {f}.

        Args:
            couplings: Equations x = sum of a_i x_i + offset. The freedoms that they name may be free,
                prescribed, or coupled themselves.

        Raises:
            ModelError: If a name is unknown, a freedom is locked or coupled twice, the speeds of its body
                are no rates, or freedoms follow each other in a circle.

        Example:
            system.with_couplings(kg.Coupling("left_finger", {"right_finger": 1.0}))
        """
        return replace(self, couplings=(*self.couplings, *couplings))

    def with_rotors(self, *rotors: Rotor) -> Self:
        """Return the same system with further rotors of geared motors.

        Args:
            rotors: Rotors, each of which spins in a body at a multiple of the rate of a freedom. Mass and
                inertia of the body include the rotor, as if it stood still.

        Raises:
            ModelError: If a name is taken or unknown, the inertia of a body is less than that of its rotors,
                or a freedom is coupled or its rate is no speed.

        Example:
            system.with_rotors(kg.Rotor("motor3", "elbow", axis=(0, 0, 1), inertia=3.3e-5, ratio=100.0))
        """
        return replace(self, rotors=(*self.rotors, *rotors))

    def with_contacts(self, contacts: Iterable[Contact | str | int] | Contact | str | int) -> Self:
        """Return the same system with other contacts, instead of those that it has.

        Args:
            contacts: Contacts, or names, one or several, in the order of their rows in `contact_forces`. A
                name means a contact that the system has, else a point, which is then held in three
                directions, else a frame or body, which is held in six, or in the directions that follow the
                name, as in "toe:force1+force3"; a number is that of a body from 1. An empty list leaves all
                contacts out.

        Raises:
            ModelError: If there is nothing of a name, no such direction, it is fixed to the ground, or two
                contacts have one name.

        Example:
            standing = system.with_contacts(["left_sole_link", "right_sole_link"])
            touching = system.with_contacts(kg.Contact(point="toe", directions=("force3",)))
        """
        places = self.point_names, self.frame_names
        return replace(self, contacts=chosen_contacts(contacts, self.contacts, self.bodies, places))

    def with_speeds(self, speeds: str) -> Self:
        """Return the same system with other generalized speeds at every joint that has three free angles.

        Args:
            speeds: One of `coordinates.SPEEDS`: "angle_rates", or "angular_velocity" for the components of
                {omega_hat'_K}, Eq. (8), with which [A] is regular everywhere. Joints with fewer free angles,
                with a quaternion, or with an angle in a coupling stay as they are.

        Raises:
            OptionError: If there are no such speeds.
            ModelError: If a joint has armature that would belong to other speeds.

        Example:
            system.with_speeds("angular_velocity")
        """
        require_one("speeds", speeds, SPEEDS)
        bodies = with_free_orientations(self, lambda joint: replace(joint, speeds=speeds))
        return replace(self, bodies=bodies)

    def with_coordinates(self, coordinates: str) -> Self:
        """Return the same system with other coordinates at every joint that has three free angles.

        Args:
            coordinates: One of `coordinates.ORIENTATIONS`: "angles", in the sequence 1-2-3 where there were
                none, or "quaternion", with which neither [A] nor {xdot} is singular in any orientation.
                Other joints, and those with an angle in a coupling, stay as they are. The speeds of a joint
                that had a quaternion stay its angular velocity.

        Raises:
            OptionError: If there are no such coordinates.
            ModelError: If a joint has armature that would belong to other speeds.

        Example:
            system.with_coordinates("quaternion")
        """
        require_one("coordinates", coordinates, ORIENTATIONS)

        def change(joint: Joint) -> Joint:
            sequence = joint.sequence if coordinates == ORIENTATIONS[0] else NOTES
            return replace(joint, coordinates=coordinates, sequence=sequence)

        return replace(self, bodies=with_free_orientations(self, change))

    def with_right_angles(self, tolerance: float) -> Self:
        """Return the same system with exact right angles where constant orientations nearly are right angles.

        Args:
            tolerance: Largest distance (rad) of an orientation or a locked angle from a right angle that
                counts as rounding; 0 changes nothing. Parameters stay as they are.

        Raises:
            OptionError: If `tolerance` is out of range, see `right_angles.checked_tolerance`.

        Example:
            kg.load("robot.urdf").with_right_angles(5e-5)
        """
        limit = checked_tolerance(tolerance)
        if limit == 0:
            return self

        def exact(body: Body) -> Body:
            joint = body.joint.with_right_angles(limit)
            return body if joint == body.joint else replace(body, joint=joint)

        frames = tuple(frame.with_right_angles(limit) for frame in self.frames)
        return replace(self, bodies=tuple(map(exact, self.bodies)), frames=frames)
