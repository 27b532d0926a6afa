"""Name resolution for force elements: coordinates, speeds and points, looked up when a system is made.

Every name becomes `<body>.<freedom>`, also where the joint has a name or the freedom is locked, so that
locking a freedom changes no element.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from kanegen.choices import did_you_mean
from kanegen.errors import ModelError, quoted
from kanegen.model.body import Body
from kanegen.model.coordinates import COORDINATE_KINDS, FREEDOMS, SPEED_KINDS
from kanegen.model.force_elements.element import ForceElement
from kanegen.model.force_elements.elements import (
    KINDS,
    Drive,
    JointFriction,
    JointSpring,
    PointLoad,
    Potential,
    Spring,
)
from kanegen.model.joint import Joint
from kanegen.model.nodes import TIME

Place = tuple[int, int]
"""Number of a body, from 1, and an index in `COORDINATE_KINDS` (coordinate) or in `FREEDOMS` (speed)."""


def coordinate_places(bodies: Sequence[Body]) -> dict[str, Place]:
    """Return every coordinate, free or not, by every name that it has."""
    found = {
        f"{body.name}.{COORDINATE_KINDS[kind].name}": (k, kind)
        for k, body in enumerate(bodies, start=1)
        for kind in sorted(body.joint.coordinate_kinds)
    }
    return _with_names_of_files(found, bodies, lambda joint, index: index in joint.coordinate_kinds)


def speed_places(bodies: Sequence[Body]) -> dict[str, Place]:
    """Return every speed by every name that it has; the speed of a locked freedom is zero."""
    found = {
        f"{body.name}.{SPEED_KINDS[kind].name}": (k, index)
        for k, body in enumerate(bodies, start=1)
        for index, kind in enumerate(body.joint.speed_kinds)
    }
    return _with_names_of_files(
        found, bodies, lambda joint, index: SPEED_KINDS[joint.speed_kinds[index]].is_rate
    )


def _with_names_of_files(
    found: dict[str, Place], bodies: Sequence[Body], has_own: Callable[[Joint, int], bool]
) -> dict[str, Place]:
    """Return `found` with the names that robot files have for freedoms which have a quantity of their own."""
    for k, body in enumerate(bodies, start=1):
        for index in range(len(FREEDOMS)):
            if (name := body.joint.freedom_name(index)) and has_own(body.joint, index):
                found.setdefault(name, (k, index))
    return found


def variable_places(bodies: Sequence[Body]) -> dict[str, Place]:
    """Return the places of all variables of expressions except the time."""
    coordinates = {f"x.{name}": place for name, place in coordinate_places(bodies).items()}
    return coordinates | {f"y.{name}": place for name, place in speed_places(bodies).items()}


def with_resolved_names(
    elements: Iterable[ForceElement], bodies: Sequence[Body], frames: Mapping[str, int]
) -> tuple[ForceElement, ...]:
    """Return the elements in the order of `KINDS`, with names that do not change when a freedom is locked.

    Args:
        elements: The elements.
        bodies: The bodies.
        frames: Number of the body of each frame, 0 for the ground, by name of the frame.

    Raises:
        ModelError: If a name is unknown, or an element cannot act on the freedom or points that it names.
    """
    resolver = _Resolver(bodies, frames)
    counts: Counter[str] = Counter()
    found = []
    for element in elements:
        counts[element.KEY] += 1
        found.append(resolver.resolved(element, f"{element.KEY} {counts[element.KEY]}"))
    return tuple(sorted(found, key=lambda element: KINDS.index(type(element))))


def with_names_of_freedoms(
    elements: Iterable[ForceElement], names: Mapping[str, str]
) -> tuple[ForceElement, ...]:
    """Return the elements with other names for some freedoms, also in expressions, for people to read.

    Args:
        elements: The elements of a system.
        names: Other names by permanent names, `<body>.<freedom>`.
    """

    def renamed(variable: str) -> str:
        return variable[:2] + names.get(variable[2:], variable[2:])

    found = []
    for element in elements:
        changed = element.with_variables_renamed(renamed)
        if isinstance(changed, JointSpring | JointFriction | Drive):
            changed = replace(changed, freedom=names.get(changed.freedom, changed.freedom))
        found.append(changed)
    return tuple(found)


def referenced_variables(elements: Iterable[ForceElement]) -> set[str]:
    """Return the variables in expressions of elements, and x and y of the freedoms on which elements act."""
    found: set[str] = set()
    for element in elements:
        found |= {name for expression in element.expressions() for name in expression.variables}
        if isinstance(element, JointSpring | JointFriction | Drive):
            found |= {f"x.{element.freedom}", f"y.{element.freedom}"}
    return found


@dataclass(frozen=True)
class _Names:
    """The names of all coordinates or of all speeds.

    Attributes:
        kind: "coordinate" or "speed", for messages.
        known: For every name, the name that does not change when a freedom is locked.
    """

    kind: str
    known: Mapping[str, str]

    @classmethod
    def of(cls, kind: str, places: Mapping[str, Place]) -> _Names:
        """Return the names in `places`; the first name of a place is the permanent one."""
        first: dict[Place, str] = {}
        for name, place in places.items():
            first.setdefault(place, name)
        return cls(kind, {name: first[place] for name, place in places.items()})

    def named(self, name: str, label: str) -> str:
        """Return the permanent name of a coordinate or speed; an unknown name is an error."""
        if name not in self.known:
            raise ModelError(
                f"{label}: there is no {self.kind} {quoted(name)}. {did_you_mean(name, self.known)}"
            )
        return self.known[name]


class _Resolver:
    """Looks up the names in force elements among the bodies of a system."""

    def __init__(self, bodies: Sequence[Body], frames: Mapping[str, int]) -> None:
        self._bodies, self._frames = bodies, frames
        self._places = coordinate_places(bodies)
        self._coordinates = _Names.of("coordinate", self._places)
        self._speeds = _Names.of("speed", speed_places(bodies))
        points = {point.name: k for k, body in enumerate(bodies, start=1) for point in body.points}
        self._points = {**frames, **points}

    def resolved(self, element: ForceElement, label: str) -> ForceElement:
        """Return an element with permanent names, after a check that it can act; `label` begins messages."""
        element = element.with_variables_renamed(lambda name: self._variable(name, label))
        match element:
            case JointSpring():
                name = self._coordinates.named(element.freedom, label)
                self._require_rate(f"x.{name}", label)
                return replace(element, freedom=name)
            case Drive() | JointFriction():
                return replace(element, freedom=self._speeds.named(element.freedom, label))
            case Spring():
                self._check_ends(element, label)
            case PointLoad():
                self._check_load(element, label)
            case Potential():
                for name in element.energy.variables:
                    self._require_rate(name, label)
        return element

    def _variable(self, name: str, label: str) -> str:
        """Return a variable of an expression with its permanent name."""
        for vector, names in (("x", self._coordinates), ("y", self._speeds)):
            if name.startswith(f"{vector}."):
                return f"{vector}.{names.named(name[2:], label)}"
        if name != TIME:
            raise ModelError(
                f"{label}: {quoted(name)} is not known. Write x.<coordinate>, y.<speed>, t or a parameter."
            )
        return name

    def _require_rate(self, variable: str, label: str) -> None:
        """Raise a `ModelError` if the rate of a coordinate is needed, but is not among the speeds."""
        k, index = self._places[variable[2:]]
        body = self._bodies[k - 1]
        if index >= len(FREEDOMS) or not SPEED_KINDS[body.joint.speed_kinds[index]].is_rate:
            raise ModelError(
                f"{label}: the speeds of body {quoted(body.name)} are its angular velocity, so none is the "
                f"rate of {quoted(variable)} alone. Keep angles and their rates there, or use a drive on "
                f"'{body.name}.omega1' to 'omega3'."
            )

    def _check_load(self, load: PointLoad, label: str) -> None:
        """Raise a `ModelError` if a load is on the ground, or in components of a frame of another body."""
        k = self._body(load.point, label)
        if not k:
            raise ModelError(
                f"{label}: {quoted(load.point)} is fixed to the ground, where a load does nothing. Name a "
                "point or frame of a body."
            )
        if load.frame and self._frames.get(load.frame) != k:
            own = [name for name, body in self._frames.items() if body == k]
            raise ModelError(
                f"{label} at {quoted(load.point)}: its body has no frame {quoted(load.frame)}. "
                f"{did_you_mean(load.frame, own)}"
            )

    def _check_ends(self, spring: Spring, label: str) -> None:
        """Raise a `ModelError` if both ends of a spring are on one body."""
        first, second = (self._body(end, label) if isinstance(end, str) else 0 for end in spring.between)
        if first == second:
            one, two = (repr(end) if isinstance(end, str) else "the ground" for end in spring.between)
            raise ModelError(
                f"{label} between {one} and {two}: both ends are on one body, so it would do nothing. Name "
                "points of two bodies, or a place [x, y, z] of the ground."
            )

    def _body(self, point: str, label: str) -> int:
        """Return the number of the body of a point or frame, which must exist; 0 for the ground."""
        if point not in self._points:
            raise ModelError(
                f"{label}: there is no point or frame {quoted(point)}. {did_you_mean(point, self._points)}"
            )
        return self._points[point]
