"""The class of systems: how one is made, checked, handed out and saved."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import numpy as np

from kanegen.errors import ModelError, WriteError
from kanegen.files import write_whole
from kanegen.model import arrays, validation
from kanegen.model import selection as reported
from kanegen.model.body import Body
from kanegen.model.changing import Changing
from kanegen.model.description import GRAVITY
from kanegen.model.force_elements.element import ForceElement
from kanegen.model.force_elements.elements import KINDS
from kanegen.model.force_elements.expression import TIME
from kanegen.model.force_elements.names import resolved, variable_places
from kanegen.model.freedoms import ORIENTATIONS, SPEEDS
from kanegen.model.joint import IDENTITY, Joint
from kanegen.model.names import check_identifier
from kanegen.model.numbers import map_numbers, numbers, value_of, word
from kanegen.model.sequences import NOTES
from kanegen.model.toml_text import toml_text


@dataclass(frozen=True)
class System(Changing):
    """A tree of rigid bodies, its gravity, what else acts on it, its name, and what outputs are about.

    Attributes:
        name: A C identifier; prefix of everything in the generated code.
        bodies: Lower bodies first.
        gravity: Inertial components (m/s^2).
        force_elements: Springs, dampers, drives, loads on points, potentials.
        poses: Names of the bodies that `body_poses` gives, in the order of its rows; None for all.
        reactions: Names of the locked directions that `reaction_loads` gives, `<body>.theta2` or `<body>.s1`,
            in its order; None for all.

    Raises:
        ModelError: If the tree, a number or a name is not usable.
    """

    def __post_init__(self) -> None:
        check_identifier(self.name, "system name")
        bodies = validation.instances(self.bodies, Body, "bodies")
        elements = validation.instances(self.force_elements, ForceElement, "force_elements")
        validation.store(self, bodies=bodies, gravity=numbers(self.gravity, (3,), "gravity"))
        validation.connection(self.connection)
        validation.unique("body name", [body.name for body in self.bodies])
        validation.store(self, poses=reported.poses(self.bodies, self.poses))
        validation.store(self, reactions=reported.reactions(self.bodies, self.reactions))
        if not self.freedoms:
            what = "locked or prescribed" if self.prescribed else "locked"
            raise ModelError(f"system {self.name!r} has no free freedom: every joint is {what}.")
        validation.unique("freedom name", (*self.freedom_names, *self.prescribed_names))
        validation.unique("coordinate name", self.coordinate_names)
        validation.unique("speed name", self.speed_names)
        validation.unique("point name", self.point_names)
        validation.store(self, force_elements=resolved(elements, self.bodies))
        validation.parameter_names(self.parameters, self.number_of_bodies)
        if self.depends_on_time and any(parameter.name == TIME for parameter in self.parameters):
            raise ModelError(f"parameter name {TIME!r} is the time in expressions. Choose another name.")

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
    ) -> Self:
        """A system from one array a quantity; body K is row K - 1 and is called `bodyK`.

        Any number may be a `Parameter`, which stays open until run time.

        Args:
            connection: (N,) lower body of each body, 0 for the ground.
            mass: (N,) kg.
            inertia: (N, 3, 3) about the mass centre, in body components, kg m^2.
            mass_center: (N, 3) from O_K to G_K, in body components, m.
            joint_position: (N, 3) from O_J to Q_K, in lower body components, m.
            joint_orientation: (N, 3, 3) rotations, lower body to joint frame; default identity.
            free: (N, 6) bool, columns as `FREEDOMS`; default all but those that are prescribed.
            locked: (N, 6) values of the locked freedoms, rad and m; default 0.
            gravity: (3,) inertial components, m/s^2.
            loads: None, True or (N,) bool: bodies that take force and torque inputs.
            name: A C identifier; prefix of everything in the generated code.
            sequence: One name or (N,) names of `sequences.SEQUENCES`: about which axes the angles turn.
            speeds: One name or (N,) names of `body.SPEEDS`: what the speeds of the angles are.
            coordinates: One name or (N,) names of `body.ORIENTATIONS`: what stands for the orientation.
            prescribed: (N, 6) bool: freedoms whose motion is an input; default none.

        Raises:
            ModelError: If a shape, a number, the tree or the name is not usable.
        """
        lower = validation.connection(arrays.integers(connection, "connection"))
        count = len(lower)
        rows = arrays.Rows(count)
        masses = numbers(mass, (count,), "mass")
        inertias = numbers(inertia, (count, 3, 3), "inertia")
        centers = numbers(mass_center, (count, 3), "mass_center")
        positions = numbers(joint_position, (count, 3), "joint_position")
        orientations = rows.numbers(joint_orientation, (3, 3), IDENTITY, "joint_orientation")
        told = rows.flags(prescribed, 6, False, "prescribed")
        rest = tuple(tuple(not flag for flag in row) for row in told)
        frees = rest if free is None else rows.flags(free, 6, True, "free")
        lockeds = rows.numbers(locked, (6,), (0.0,) * 6, "locked")
        loaded = rows.loads(loads)
        kinds = rows.names(speeds, "speeds")
        order = rows.names(sequence, "sequence")
        held = rows.names(coordinates, "coordinates")
        bodies = []
        for k in range(count):
            try:
                turning = {"sequence": order[k], "speeds": kinds[k], "coordinates": held[k]}
                joint = Joint(
                    positions[k], orientations[k], frees[k], lockeds[k], **turning, prescribed=told[k]
                )
            except ModelError as error:
                raise ModelError(f"body {k + 1}: {error}") from None
            label = f"body{k + 1}"
            bodies.append(Body(label, lower[k], masses[k], inertias[k], centers[k], joint, loaded[k]))
        return cls(name=name, bodies=tuple(bodies), gravity=gravity)

    def values(self) -> arrays.SystemArrays:
        """Every number of the model as NumPy arrays, parameters at their defaults."""
        joints = [body.joint for body in self.bodies]
        return arrays.system_arrays(
            connection=self.connection,
            mass=map_numbers(tuple(body.mass for body in self.bodies), value_of),
            inertia=map_numbers(tuple(body.inertia for body in self.bodies), value_of),
            mass_center=map_numbers(tuple(body.mass_center for body in self.bodies), value_of),
            joint_position=map_numbers(tuple(joint.position for joint in joints), value_of),
            joint_orientation=tuple(map_numbers(joint.orientation, value_of) for joint in joints),
            free=tuple(joint.free for joint in joints),
            locked=map_numbers(tuple(joint.locked for joint in joints), value_of),
            gravity=map_numbers(self.gravity, value_of),
            loads=tuple(body.loads for body in self.bodies),
            sequence=tuple(joint.sequence for joint in joints),
            speeds=tuple(joint.speeds for joint in joints),
            coordinates=tuple(joint.coordinates for joint in joints),
            prescribed=tuple(joint.prescribed for joint in joints),
            forces=self._forces(),
        )

    def _forces(self) -> arrays.ForceArrays:
        places = {p.name: (k, np.array(map_numbers(p.position, value_of))) for k, p in self.points}
        return arrays.ForceArrays(
            elements=tuple(element.changed(value_of) for element in self.force_elements),
            variables=variable_places(self.bodies),
            points=places,
            loaded=np.array([point.loads for _, point in self.points], dtype=np.bool_),
        )

    def as_table(self) -> dict[str, Any]:
        """The model in the words of a model file: what `save` writes."""
        table: dict[str, Any] = {"name": self.name, "gravity": map_numbers(self.gravity, word)}
        if self.parameters:
            table["parameters"] = {parameter.name: parameter.value for parameter in self.parameters}
        outputs = {"body_poses": self.poses, "reaction_loads": self.reactions}
        if chosen := {output: names for output, names in outputs.items() if names}:
            table["outputs"] = chosen
        # In a file, "ground" always means the ground; a body of this name is called by its number.
        names = ["ground", *(body.name for body in self.bodies)]
        words = [k if k > 0 and name == "ground" else name for k, name in enumerate(names)]
        table["body"] = [body.as_table(words[body.lower]) for body in self.bodies]
        elements = {kind: [e.as_table() for e in self.force_elements if type(e) is kind] for kind in KINDS}
        return table | {kind.KEY: tables for kind, tables in elements.items() if tables}

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a TOML model file; loading it gives an equal system.

        Raises:
            WriteError: If `path` does not end in .toml or cannot be written.
        """
        file = Path(path)
        if file.suffix.lower() != ".toml":
            raise WriteError(f"{file}: a model file ends in .toml.")
        write_whole(file, toml_text(self.as_table()))
