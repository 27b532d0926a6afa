"""Which joints can have their frames turned."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from kanegen.errors import OptionError
from kanegen.model.body import Body
from kanegen.model.coordinates import Freedom
from kanegen.model.force_elements.names import coordinates_named
from kanegen.model.joint import Joint
from kanegen.model.numbers import Parameter, map_numbers
from kanegen.model.system import System


@dataclass(frozen=True)
class Anchor:
    """A joint whose constant orientation is three parameters, and nothing else holds its frame.

    Attributes:
        body: Number of the body, from 1.
        name: Its name.
        parameters: Places of the orientation's angles in the array of parameters.
        angles: Places of the joint's angles in {x}.
        speeds: Those of their speeds in {y}.
        slides: Places of its translations in {x}; none if they are locked at zero.
        sliding: Those of their rates in {y}.
        axes: Basis vectors about which its angles turn, from 0.
        spins: Whether the speeds of its angles are components of the angular velocity.
    """

    body: int
    name: str
    parameters: tuple[int, int, int]
    angles: tuple[int, ...]
    speeds: tuple[int, ...]
    slides: tuple[int, ...]
    sliding: tuple[int, ...]
    axes: tuple[int, int, int]
    spins: bool

    @property
    def ends_alike(self) -> bool:
        """Whether the last angle turns about the axis of the first."""
        return self.axes[0] == self.axes[2]

    @property
    def row(self) -> str:
        """The same as an initialiser in C."""
        places = (self.parameters, self.angles, self.speeds, self.slides, self.sliding, self.axes)
        words = [f"{{{', '.join(map(str, triple or (-1, -1, -1)))}}}" for triple in places]
        return f"{{{', '.join([*words, str(int(self.spins))])}}}"


def require_free_frame(system: System, k: int) -> None:
    """Make sure that the frame can turn: three free angles, and translations all free or all locked.

    Raises:
        OptionError: If it cannot; says why, and how to mend it.
    """
    body = system.bodies[k - 1]
    if held := _held(system, body):
        raise OptionError(f"body {body.name!r} cannot be re-anchored: {held}.")


def _held(system: System, body: Body) -> str:
    """What refers to the joint frame; "" if nothing does."""
    joint = body.joint
    slides, parameters = joint.free[3:], orientation_parameters(joint)
    if not joint.turns_freely:
        return "its three angles are not all free. Leave it out"
    moved = (f"x.{body.name}.", f"y.{body.name}.s", f"y.{body.name}.theta")
    if any(name.startswith(moved) for name in coordinates_named(system.force_elements)):
        return "a force element names its coordinates, which would mean others. Leave it out"
    if joint.is_quaternion:
        return "it has a quaternion, which is regular everywhere. Leave it out"
    if any(slides) and not all(slides):
        return (
            "it slides along some axes of its joint frame only. Free all three translations, or leave it out"
        )
    if any(joint.prescribed):
        return "it has a translation that is prescribed in its joint frame. Leave it out"
    if any(isinstance(value, Parameter) for value in joint.locked) or (parameters and any(joint.locked)):
        return (
            "parameters meet a locked translation in its joint frame. Put the translation into its position"
        )
    if parameters and not _are_its_own(system, parameters):
        return (
            "its orientation shares parameters, or has fewer than three. Give it three of its own, or numbers"
        )
    return ""


def _are_its_own(system: System, names: list[str]) -> bool:
    """Whether they are three, and stand nowhere else."""
    used = _names(system.gravity)
    for body in system.bodies:
        joint = body.joint
        used += _names((body.mass, body.inertia, body.mass_center))
        used += _names(tuple(point.position for point in body.points))
        used += _names((joint.position, joint.orientation, joint.locked))
    elements = [value for element in system.force_elements for value in element.numbers()]
    used += _names(tuple(elements))
    return len(names) == len(set(names)) == 3 and all(used.count(name) == 1 for name in names)


def orientation_parameters(joint: Joint) -> list[str]:
    """Names of the parameters in its orientation."""
    return _names(joint.orientation)


def _names(numbers: Any) -> list[str]:
    """Of the parameters in nested tuples."""
    names: list[str] = []
    map_numbers(numbers, lambda value: names.append(value.name) if isinstance(value, Parameter) else None)
    return names


def reanchorable(system: System) -> tuple[Anchor, ...]:
    """Return the joints that C can re-anchor: those whose orientation is three parameters."""
    found = []
    parameters = [parameter.name for parameter in system.parameters]
    for k, body in enumerate(system.bodies, start=1):
        names = orientation_parameters(body.joint)
        if names and not _held(system, body):
            one, two, three = (parameters.index(name) for name in names)
            angles, slides = range(3), range(3, 6) if body.joint.free[3] else ()
            found.append(
                Anchor(
                    body=k,
                    name=body.name,
                    parameters=(one, two, three),
                    angles=tuple(system.coordinate_place(k, index) for index in angles),
                    speeds=tuple(system.places[Freedom(k, index)] for index in angles),
                    slides=tuple(system.coordinate_place(k, index) for index in slides),
                    sliding=tuple(system.places[Freedom(k, index)] for index in slides),
                    axes=body.joint.axes,
                    spins=body.joint.spins,
                )
            )
    return tuple(found)
