"""The class `System`: construction, conversion to arrays, and saving; `variation` has what changes it."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import InitVar, dataclass, replace
from typing import Any, Self

from kanegen.errors import ModelError, WriteError, counted, quoted
from kanegen.files import path_of, write_whole
from kanegen.model import output_rows, validation
from kanegen.model.arrays import SystemArrays, bodies_from_arrays, rotor_arrays, system_arrays
from kanegen.model.body import Body
from kanegen.model.contact import Contact, checked_contacts
from kanegen.model.coordinates import NOTES, ORIENTATIONS, SPEEDS
from kanegen.model.coupling import Coupling, coupled_bodies, with_permanent_names
from kanegen.model.force_elements.element import ForceElement
from kanegen.model.force_elements.names import with_resolved_names
from kanegen.model.frame import Frame, check_points, checked_frames
from kanegen.model.names import check_label
from kanegen.model.nodes import TIME
from kanegen.model.numbers import numbers
from kanegen.model.rotor import Rotor, check_carriers, check_freedoms, permanent_name
from kanegen.model.saving import system_table, toml_text
from kanegen.model.system_fields import GRAVITY
from kanegen.model.system_html import system_html, system_svg
from kanegen.model.system_numbers import with_defaults
from kanegen.model.variation import SystemVariations
from kanegen.pictures.picture import Picture

PARTS: Mapping[str, type] = {
    "bodies": Body,
    "force_elements": ForceElement,
    "couplings": Coupling,
    "frames": Frame,
    "rotors": Rotor,
    "contacts": Contact,
}
"""Classes of the parts of a system, by the field that holds them."""


@dataclass(frozen=True)
class System(SystemVariations):
    """A tree of rigid bodies with gravity, force elements, and the selection of rows of outputs.

    Attributes:
        name: Name of the system; generated code has the identifier that follows from it.
        bodies: The bodies, lower bodies first.
        gravity: (3,) acceleration of gravity, inertial components (m/s^2).
        force_elements: Springs, dampers, drives, loads on points, potentials.
        poses: Names of the frames that `body_poses` gives, in the order of its rows; None for all bodies.
        reactions: Names of the rows that `reaction_loads` gives, `<body>.theta2` or `<body>.s1` of locked
            directions, `<frame>.moment1` or `<frame>.force3` in frames, in its order; None for all joints.
        couplings: Freedoms that follow others: x = sum of a_i x_i + offset. They are in neither {x} nor {y}.
        frames: Frames that are fixed in a body or in the ground, beside the bodies' own.
        rotors: Rotors of geared motors, which spin in bodies that carry them.
        contacts: Points and frames that `contact_dynamics` and `contact_forces` hold.
        geometry: File whose shapes pictures show, the one from which the system was read; None for none. It
            has no effect on equations, and systems that differ in it alone are equal.
        defaults: Default values, by name, of parameters that have none, as those have that symbols of SymPy
            become. They are kept in the parameters of the system.

    Raises:
        ModelError: If the tree, a number or a name is not usable, or a parameter has no default value.

    Example:
        body = kg.Body("bob", 0, 1.0, ((0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1)), (0, 0, -0.5))
        system = kg.System("pendulum", (body,))
    """

    defaults: InitVar[Mapping[str, float] | None] = None

    def __post_init__(self, defaults: Mapping[str, float] | None) -> None:
        check_label(self.name, "system name")
        for name, kind in PARTS.items():
            validation.store(self, **{name: validation.instances(getattr(self, name), kind, name)})
        validation.store(self, gravity=numbers(self.gravity, (3,), "gravity"))
        validation.store(
            self, **with_defaults(self, defaults), geometry=validation.file(self.geometry, "geometry")
        )
        validation.connection(self.connection)
        validation.unique("body name", [body.name for body in self.bodies])
        validation.store(self, frames=checked_frames(self.bodies, self.frames))
        couplings = with_permanent_names(self.couplings, self.bodies)
        validation.store(self, couplings=couplings, bodies=coupled_bodies(self.bodies, couplings))
        validation.store(self, poses=output_rows.poses(self.frame, self.poses))
        if self.reactions is not None:
            validation.store(self, reactions=self._reactions(self.reactions))
        names = (*self.freedom_names, *self.prescribed_names, *self.coupled_names)
        if not self.freedoms:
            states = ["locked"] + ["prescribed"] * bool(self.prescribed) + ["coupled"] * bool(self.couplings)
            state = " or ".join(states)
            raise ModelError(f"system {quoted(self.name)} has no free freedom: every joint is {state}.")
        validation.unique("freedom name", names)
        validation.unique("coordinate name", self.coordinate_names)
        validation.unique("speed name", self.speed_names)
        validation.unique("point name", self.point_names)
        check_points(self.points, self.frames_by_name)
        self._store_rotors()
        contacts = checked_contacts(self.contacts, self._points_by_name, self.frames_by_name)
        validation.store(self, contacts=contacts)
        bodies_of_frames = {name: frame.body for name, frame in self.frames_by_name.items()}
        elements = with_resolved_names(self.force_elements, self.bodies, bodies_of_frames)
        validation.store(self, force_elements=elements)
        validation.parameter_names(self.parameters, self.number_of_bodies, len(self.points))
        if self.depends_on_time and any(parameter.name == TIME for parameter in self.parameters):
            raise ModelError(f"parameter name {TIME!r} is the time in expressions. Choose another name.")

    def _store_rotors(self) -> None:
        """Store the rotors with names that do not change when a freedom is locked, after checks."""
        rotors = []
        for rotor in self.rotors:
            driven = self.freedom(rotor.freedom, f"rotor {quoted(rotor.name)}")
            rotors.append(replace(rotor, freedom=permanent_name(driven, self.bodies)))
        validation.store(self, rotors=tuple(rotors))
        check_freedoms(self.mounted_rotors, self.bodies)
        check_carriers(self.mounted_rotors, self.bodies, [one.axis for one in rotor_arrays(self)])

    @classmethod
    def from_arrays(
        cls,
        connection: Any,
        mass: Any,
        inertia: Any,
        mass_center: Any,
        joint_position: Any,
        joint_orientation: Any = None,
        free: Any = None,
        locked: Any = None,
        gravity: Any = GRAVITY,
        loads: Any = None,
        name: str = "system",
        sequence: Any = NOTES,
        speeds: Any = SPEEDS[0],
        coordinates: Any = ORIENTATIONS[0],
        prescribed: Any = None,
        armature: Any = None,
        defaults: Mapping[str, float] | None = None,
    ) -> Self:
        """Return a system from one array for each quantity; body K is row K - 1 and is called `bodyK`.

        Any number may be a `Parameter`, which stays open until run time, an expression of parameters, or an
        expression of SymPy, whose symbols become parameters.

        Args:
            connection: (N,) number of the lower body of each body, 0 for the ground.
            mass: (N,) masses (kg).
            inertia: (N, 3, 3) inertias about the mass centre, in body components (kg m^2).
            mass_center: (N, 3) positions of G_K from O_K, in body components (m).
            joint_position: (N, 3) positions of Q_K from O_J, in components of the lower body (m).
            joint_orientation: (N, 3, 3) rotations from lower body to joint frame; default identity.
            free: (N, 6) flags, columns as `FREEDOMS`; default all but those that are prescribed.
            locked: (N, 6) values of the locked freedoms (rad, m); default 0.
            gravity: (3,) inertial components (m/s^2).
            loads: None, True or (N,) flags: bodies that take force and torque inputs.
            name: Name of the system.
            sequence: One name or (N,) names of `coordinates.SEQUENCES`: axes of the three angles.
            speeds: One name or (N,) names of `coordinates.SPEEDS`: the generalized speeds of the angles.
            coordinates: One name or (N,) names of `coordinates.ORIENTATIONS`: coordinates of orientations.
            prescribed: (N, 6) flags: freedoms whose motion is an input; default none.
            armature: (N, 6) reflected inertias of motors (kg m^2, kg), see `Joint`; default 0.
            defaults: Default values, by name, of parameters that have none.

        Raises:
            ModelError: If a shape, a number, the tree or the name is not usable.

        Example:
            pendulum = kg.System.from_arrays([0], [1.0], [np.eye(3)], [[0, 0, -0.5]], [[0, 0, 0]])
        """
        bodies = bodies_from_arrays(
            connection=connection,
            mass=mass,
            inertia=inertia,
            mass_center=mass_center,
            joint_position=joint_position,
            joint_orientation=joint_orientation,
            free=free,
            locked=locked,
            loads=loads,
            sequence=sequence,
            speeds=speeds,
            coordinates=coordinates,
            prescribed=prescribed,
            armature=armature,
        )
        return cls(name=name, bodies=bodies, gravity=gravity, defaults=defaults)

    def values(self) -> SystemArrays:
        """Return every number of the model as NumPy arrays, parameters at their defaults.

        Example:
            system.values().mass  # (N,)
        """
        return system_arrays(self)

    def picture(self) -> Picture:
        """Return the tree as a picture: a row for each body, with its joint, what moves, and its mass.

        Example:
            kg.load("models/eight_body.toml").picture().write("tree.svg")
        """
        return Picture(system_svg(self))

    def __repr__(self) -> str:
        """Name and size of the system; `as_table` has all of it."""
        bodies = counted(self.number_of_bodies, "body", "bodies")
        return f"<System {self.name}: {bodies}, {counted(len(self.freedoms), 'freedom')}>"

    def _repr_html_(self) -> str:
        """The tree as a picture, the order of {x} and {y}, and what acts, for a notebook."""
        return system_html(self)

    def as_table(self) -> dict[str, Any]:
        """Return the model as nested tables: the keys and values that `save` writes.

        Example:
            system.as_table()["body"][0]["mass"]
        """
        return system_table(self)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a TOML model file; loading it gives an equal system.

        Raises:
            WriteError: If `path` is no path, does not end in .toml or cannot be written.

        Example:
            kg.load("robot.urdf").save("robot.toml")
        """
        file = path_of(path)
        if file.suffix.lower() != ".toml":
            raise WriteError(f"{file}: a model file ends in .toml.")
        write_whole(file, toml_text(self.as_table()))
