"""Conditions under which a joint can be re-anchored: only its own coordinates refer to its joint frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from kanegen.errors import OptionError, quoted
from kanegen.model.body import Body
from kanegen.model.coordinates import ANGLES, TRANSLATIONS, AxisRotations, Freedom
from kanegen.model.force_elements.names import referenced_variables
from kanegen.model.joint import Joint
from kanegen.model.numbers import Parameter, is_fixed, map_numbers, parameters_of
from kanegen.model.system import System
from kanegen.model.system_numbers import numbers_of


@dataclass(frozen=True)
class ReanchorableJoint:
    """A joint that generated C can re-anchor: its constant orientation is three parameters used nowhere else.

    Attributes:
        body: Number of the body, from 1.
        name: Name of the body.
        parameters: Places of the orientation's angles in the array of parameters.
        angles: Places of the joint's angles in {x}.
        speeds: Places of their speeds in {y}.
        translations: Places of the joint's translations in {x}; empty if they are locked at zero.
        translation_rates: Places of the rates of these translations in {y}; empty if they are locked at zero.
        rotations: The axes of the joint's angles.
        speeds_are_rates: Whether the speeds of the angles are their rates, not the angular velocity.
    """

    body: int
    name: str
    parameters: tuple[int, int, int]
    angles: tuple[int, ...]
    speeds: tuple[int, ...]
    translations: tuple[int, ...]
    translation_rates: tuple[int, ...]
    rotations: AxisRotations
    speeds_are_rates: bool

    @property
    def row(self) -> str:
        """The joint as an initialiser in C."""
        places = (
            self.parameters,
            self.angles,
            self.speeds,
            self.translations,
            self.translation_rates,
            self.rotations.axes,
        )
        triples = [f"{{{', '.join(map(str, triple or (-1, -1, -1)))}}}" for triple in places]
        return f"{{{', '.join([*triples, str(int(not self.speeds_are_rates))])}}}"


def require_free_frame(system: System, k: int) -> None:
    """Make sure that the joint of body `k` can be re-anchored.

    Its three angles must be free, and its translations all free or all locked.

    Raises:
        OptionError: If the joint cannot be re-anchored; the message gives the reason and the remedy.
    """
    body = system.bodies[k - 1]
    if obstacle := _obstacle(system, body):
        raise OptionError(f"body {quoted(body.name)} cannot be re-anchored: {obstacle}.")


def _obstacle(system: System, body: Body) -> str:
    """Return the reason against re-anchoring a joint and the remedy; "" if there is none."""
    joint = body.joint
    translations, parameters = joint.free[3:], orientation_parameters(joint)
    if not joint.has_free_orientation:
        return "its three angles are not all free. Leave it out"
    moved = (f"x.{body.name}.", f"y.{body.name}.s", f"y.{body.name}.theta")
    if any(name.startswith(moved) for name in referenced_variables(system.force_elements)):
        return "a force element names its coordinates, which would mean others. Leave it out"
    if any(system.bodies[freedom.body - 1] is body for freedom in system.in_couplings):
        return "a coupling names its coordinates, which would mean others. Leave it out"
    if not isinstance(joint.rotation, AxisRotations):
        return f"it has a {joint.coordinates}, which is regular everywhere. Leave it out"
    if any(translations) and not all(translations):
        return (
            "it slides along some axes of its joint frame only. Free all three translations, or leave it out"
        )
    if any(system.bodies[one.freedom.body - 1] is body for one in system.mounted_rotors):
        return "its coordinates drive rotors, and others would do so. Leave it out"
    if joint.speeds_are_rates and any(joint.armature[:3]):
        return "its angles have armature, which would belong to others. Leave it out"
    if any(armature != joint.armature[3] for armature in joint.armature[4:]):
        return "its translations have different armatures, which would belong to others. Leave it out"
    if any(joint.prescribed):
        return "it has a translation that is prescribed in its joint frame. Leave it out"
    if not all(map(is_fixed, joint.locked)) or (parameters and any(joint.locked)):
        return (
            "parameters meet a locked translation in its joint frame. Put the translation into its position"
        )
    plain = all(isinstance(angle, Parameter) for angle in joint.orientation)
    if parameters and not (plain and _are_three_of_its_own(system, parameters)):
        return (
            "its orientation shares parameters, or has fewer than three. Give it three of its own, or numbers"
        )
    return ""


def _are_three_of_its_own(system: System, names: list[str]) -> bool:
    """Return whether three parameters stand in one orientation, and nowhere else in the system."""
    used = [one.name for value in numbers_of(system) for one in parameters_of(value)]
    return len(names) == len(set(names)) == 3 and all(used.count(name) == 1 for name in names)


def orientation_parameters(joint: Joint) -> list[str]:
    """Return the names of the parameters in the constant orientation of a joint."""
    return _parameter_names(joint.orientation)


def _parameter_names(numbers: Any) -> list[str]:
    """Return the names of the parameters in nested tuples of numbers."""
    names: list[str] = []
    map_numbers(numbers, lambda value: names.extend(one.name for one in parameters_of(value)))
    return names


def reanchorable_joints(system: System) -> tuple[ReanchorableJoint, ...]:
    """Return the joints that C can re-anchor: those whose orientation is three parameters."""
    found = []
    parameters = [parameter.name for parameter in system.parameters]
    for k, body in enumerate(system.bodies, start=1):
        names, rotations = orientation_parameters(body.joint), body.joint.rotation
        if names and isinstance(rotations, AxisRotations) and not _obstacle(system, body):
            one, two, three = (parameters.index(name) for name in names)
            translations = TRANSLATIONS if body.joint.free[3] else ()
            found.append(
                ReanchorableJoint(
                    body=k,
                    name=body.name,
                    parameters=(one, two, three),
                    angles=tuple(system.coordinate_place(k, index) for index in ANGLES),
                    speeds=tuple(system.places[Freedom(k, index)] for index in ANGLES),
                    translations=tuple(system.coordinate_place(k, index) for index in translations),
                    translation_rates=tuple(system.places[Freedom(k, index)] for index in translations),
                    rotations=rotations,
                    speeds_are_rates=body.joint.speeds_are_rates,
                )
            )
    return tuple(found)
