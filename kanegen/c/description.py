"""`ModelDescription`: names, units and sizes of a system as plain data, for generated files and libraries."""

from __future__ import annotations

from dataclasses import dataclass

from kanegen.errors import quoted
from kanegen.model.coordinates import NOTES
from kanegen.model.reanchorable import ReanchorableJoint, reanchorable_joints
from kanegen.model.system import System
from kanegen.model.system_numbers import expression_summaries


@dataclass(frozen=True)
class ModelDescription:
    """Names, units and sizes of a system, in the order in which the generated code has them.

    Attributes:
        name: A C identifier; the beginning of every generated name.
        freedom_names: n names of the freedoms, in the order of {y}.
        freedom_units: Unit of each freedom, "rad" or "m".
        coordinate_names: Names in the order of {x}: the freedoms, or the four elements of a quaternion.
        coordinate_units: Unit of each coordinate, "rad", "m" or "1".
        title: Name of the system as its model has it; "" where it is `name`.
        homogeneous: For each orientation whose coordinates have a length without meaning, such as a
            quaternion, the places of these coordinates in {x}.
        body_names: N names of the bodies.
        loaded: For each body whether it takes a force and a torque.
        parameters: Name and default of each run-time parameter, in the order of the C array.
        freedom_bodies: n names of the bodies that the freedoms belong to.
        planar: For each joint that can reach gimbal lock, the place in {x} of its middle angle and the
            function of this angle, "cos" or "sin", that is 0 there.
        sequences: Name and sequence of each body whose angles do not turn about the axes 1-2-3.
        speed_names: n names in the order of {y}; a speed that is the rate of a coordinate has its name.
        points: Name of each point and name of its body.
        loaded_points: For each point whether it takes a force and a moment.
        load_frames: For each point the name of the frame of the components of these, "" if they are inertial.
        force_elements: One line of text for each force element.
        undefined_somewhere: The same lines of those that are undefined or infinite in some state.
        motors: One line of text for each armature and each rotor.
        couplings: One line of text for each coupling.
        expressions: One line of text for each quantity that is an expression of parameters.
        locked: One line of text for each freedom that is locked at another value than zero, and for each
            joint whose freedoms are all locked.
        poses: Names of the frames that outputs about frames give, in the order of their rows.
        pose_bodies: Names of the bodies in which these frames are fixed, "" for the ground.
        reactions: Name and unit of each load that `reaction_loads` gives, and the frame in which it is a
            component, "" for the load along a locked direction.
        contacts: One line of text for each contact.
        contact_rows: Name and unit of each load that `contact_forces` gives.
        prescribed: Name and unit, "rad" or "m", of each prescribed freedom.
        limits: Smallest and largest coordinates, speeds and efforts in the order of the C arrays, infinite
            where there is none; () for a model without limits.
        reanchorable: Joints whose frames can be re-anchored at run time.
        rows: Names of the rows of outputs that a status can name, such as a moment or a force on a frame, in
            the order of their places behind that of the status of a result that is not finite.
    """

    name: str
    freedom_names: tuple[str, ...]
    freedom_units: tuple[str, ...]
    coordinate_names: tuple[str, ...]
    coordinate_units: tuple[str, ...]
    body_names: tuple[str, ...]
    loaded: tuple[bool, ...]
    parameters: tuple[tuple[str, float], ...] = ()
    freedom_bodies: tuple[str, ...] = ()
    planar: tuple[tuple[int, str], ...] = ()
    sequences: tuple[tuple[str, str], ...] = ()
    speed_names: tuple[str, ...] = ()
    points: tuple[tuple[str, str], ...] = ()
    loaded_points: tuple[bool, ...] = ()
    load_frames: tuple[str, ...] = ()
    force_elements: tuple[str, ...] = ()
    undefined_somewhere: tuple[str, ...] = ()
    motors: tuple[str, ...] = ()
    couplings: tuple[str, ...] = ()
    expressions: tuple[str, ...] = ()
    locked: tuple[str, ...] = ()
    poses: tuple[str, ...] = ()
    pose_bodies: tuple[str, ...] = ()
    reactions: tuple[tuple[str, str, str], ...] = ()
    contacts: tuple[str, ...] = ()
    contact_rows: tuple[tuple[str, str], ...] = ()
    prescribed: tuple[tuple[str, str], ...] = ()
    reanchorable: tuple[ReanchorableJoint, ...] = ()
    homogeneous: tuple[tuple[int, ...], ...] = ()
    limits: tuple[tuple[float, ...], ...] = ()
    title: str = ""
    rows: tuple[str, ...] = ()

    @property
    def neutral_coordinates(self) -> tuple[float, ...]:
        """(m,) coordinates of the position in which no joint is turned or displaced (rad, m, 1)."""
        ones = {places[0] for places in self.homogeneous}
        return tuple(float(place in ones) for place in range(len(self.coordinate_names)))

    @property
    def shown(self) -> str:
        """Name of the system for people."""
        return self.title or self.name

    @property
    def prefix(self) -> str:
        """The first part of the names of constants and include guards: the name in capitals.

        A name that has capitals itself stays as it is behind a k. So models whose names differ in case only,
        such as arm and Arm, share no name and can be in one program.
        """
        return self.name.upper() if self.name == self.name.lower() else f"k{self.name}"

    @property
    def not_converged(self) -> int:
        """The status of an iteration that does not converge.

        It is the number behind those of freedoms, of a result that is not finite, and of rows of outputs.
        """
        return len(self.freedom_names) + 1 + len(self.rows) + 1

    @property
    def prescribed_names(self) -> tuple[str, ...]:
        """The p names of the freedoms whose motion is an input."""
        return tuple(name for name, _ in self.prescribed)

    def unloaded(self, kind: str) -> dict[int, str]:
        """Return the rows of bodies or points that take no loads, each with the name of its body or point.

        Args:
            kind: "body" or "point".
        """
        points = [name for name, _ in self.points]
        named = {"body": (self.body_names, self.loaded), "point": (points, self.loaded_points)}[kind]
        rows = enumerate(zip(*named, strict=True))
        return {row: f"{kind} {quoted(name)}" for row, (name, is_loaded) in rows if not is_loaded}

    @property
    def has_other_coordinates(self) -> bool:
        """Whether {x} contains anything but the freedoms, such as quaternions."""
        return self.coordinate_names != self.freedom_names

    @property
    def speeds_are_rates(self) -> bool:
        """Whether {xdot} = {y}: every speed is the rate of the coordinate at its place."""
        return not self.has_other_coordinates and not any(self.speeds)

    @property
    def speeds(self) -> tuple[str, ...]:
        """For every place in {y} the name of a velocity component, or "" where it is the rate of {x}."""
        if not self.speed_names:
            return ("",) * len(self.freedom_names)
        pairs = zip(self.freedom_names, self.speed_names, strict=True)
        return tuple("" if speed == name else speed for name, speed in pairs)

    @property
    def takes_loads(self) -> bool:
        """Whether any body takes a force and a torque."""
        return any(self.loaded)


def description(system: System) -> ModelDescription:
    """Return the description of `system`."""
    return ModelDescription(
        name=system.identifier,
        title=system.name,
        freedom_names=system.freedom_names,
        freedom_units=tuple(freedom.unit for freedom in system.freedoms),
        body_names=tuple(body.name for body in system.bodies),
        loaded=tuple(body.loads for body in system.bodies),
        parameters=tuple((parameter.name, parameter.value) for parameter in system.parameters),
        freedom_bodies=tuple(system.bodies[freedom.body - 1].name for freedom in system.freedoms),
        planar=_planar(system),
        sequences=_sequences(system),
        speed_names=system.speed_names,
        points=tuple((point.name, system.bodies[k - 1].name) for k, point in system.points),
        loaded_points=tuple(point.loads for _, point in system.points),
        load_frames=tuple(point.load_frame for _, point in system.points),
        force_elements=tuple(element.summary for element in system.force_elements),
        undefined_somewhere=tuple(one.summary for one in system.force_elements if one.may_be_undefined),
        motors=system.motor_summaries,
        couplings=system.coupling_equations,
        expressions=expression_summaries(system),
        locked=system.locked_summaries,
        poses=system.pose_names,
        pose_bodies=tuple(
            system.bodies[frame.body - 1].name if frame.body else "" for frame in system.pose_frames
        ),
        reactions=tuple((row.name, row.effort, row.frame) for row in system.reaction_rows),
        contacts=tuple(contact.summary for contact in system.contacts),
        contact_rows=tuple((row.name, row.effort) for row in system.contact_rows),
        coordinate_names=system.coordinate_names,
        coordinate_units=tuple(coordinate.unit for coordinate in system.coordinates),
        prescribed=tuple(
            (name, freedom.unit)
            for name, freedom in zip(system.prescribed_names, system.prescribed, strict=True)
        ),
        reanchorable=reanchorable_joints(system),
        homogeneous=_homogeneous(system),
        limits=_limits(system),
        rows=(*system.rows_of_frames, *(row.solved for row in system.contact_rows)),
    )


def _limits(system: System) -> tuple[tuple[float, ...], ...]:
    """Return `ModelDescription.limits` of a system."""
    limits = system.limits
    arrays = (limits.lower, limits.upper, limits.speed, limits.effort)
    return tuple(tuple(map(float, values)) for values in arrays) if limits else ()


def _homogeneous(system: System) -> tuple[tuple[int, ...], ...]:
    """Return by body the places in {x} of coordinates without a unit: only their ratios have a meaning."""
    places: dict[int, list[int]] = {}
    for coordinate, place in system.coordinate_places.items():
        if coordinate.unit == "1":
            places.setdefault(coordinate.body, []).append(place)
    return tuple(tuple(found) for found in places.values())


def _sequences(system: System) -> tuple[tuple[str, str], ...]:
    """Return name and sequence of every turning body whose sequence is not 1-2-3."""
    turning = [body for body in system.bodies if any(body.joint.free[:3])]
    return tuple((b.name, b.joint.sequence) for b in turning if b.joint.sequence != NOTES)


def _planar(system: System) -> tuple[tuple[int, str], ...]:
    """Return `ModelDescription.planar`: cos(theta2) for three different axes, else sin(theta2)."""
    found: list[tuple[int, str]] = []
    for k, body in enumerate(system.bodies, start=1):
        if body.joint.mass_matrix_singularity:
            found.append((system.coordinate_place(k, 1), body.joint.mass_matrix_singularity))
    return tuple(found)
