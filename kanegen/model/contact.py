"""Contacts: points and frames of bodies that are held, row by row.

A contact holds the origin of a frame, or a point, in some directions: the accelerations there are zero. What
holds it is a force for each direction, and for a frame, which is also held against turning, a moment. Every
held direction is one row of the constraints J {ydot} + d/dt(J) {y} = {0}.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

from kanegen.choices import chosen, did_you_mean
from kanegen.errors import ModelError, quoted
from kanegen.model import validation
from kanegen.model.body import Body, Point
from kanegen.model.frame import GROUND, Frame
from kanegen.model.names import check_label
from kanegen.model.numbers import Number, number, toml_number, value_of
from kanegen.model.reaction import COMPONENTS

FORCES = COMPONENTS[3:]
"""Names of the directions in which a point can be held."""

LABEL = "contacts"
"""Beginning of error messages on the choice of contacts."""


@dataclass(frozen=True)
class Contact:
    """A point or a frame of a body that is held: its accelerations are zero.

    A point is held in three directions, a frame also against turning about three axes. Directions are those
    of the inertial basis vectors, and are called as the loads that hold them. Whether the held point or frame
    moves is a matter of the state that the caller passes; only its acceleration is zero.

    Attributes:
        name: Label, unique among the contacts of a system; "" stands for the name of what is held.
        point: Name of the point that is held, or of a frame whose origin is; write this or `frame`.
        frame: Name of the frame or body that is held, with its orientation.
        directions: Held directions among "moment1" to "moment3", for frames alone, and "force1" to "force3";
            None for all.
        damping: Regularisation mu of the contact, at least 0 (1/kg, and 1/(kg m^2) for moments). A held
            direction gives way with the acceleration -mu times its load, instead of zero. So loads also exist
            where held directions depend on each other, as in proximal methods; their errors, and those of
            the accelerations, then grow as roundoff over mu.

    Raises:
        ModelError: If a name, a direction or the damping is not usable, or not exactly one of `point` and
            `frame` is given.

    Example:
        kg.Contact("left_foot", frame="left_sole_link")
        kg.Contact("toe", point="toe", directions=("force3",), damping=1e-8)
    """

    name: str = ""
    point: str = ""
    frame: str = ""
    directions: tuple[str, ...] | None = None
    damping: Number = 0.0

    def __post_init__(self) -> None:
        given = [key for key in ("point", "frame") if getattr(self, key) != ""]
        for key in given:
            check_label(getattr(self, key), f"contact {quoted(self.name)}: {key}")
        if len(given) != 1:
            problem = "both a point and a frame are" if given else "neither a point nor a frame is"
            raise ModelError(f"contact {quoted(self.name)}: {problem} held. Name one of them.")
        validation.store(self, name=check_label(self.name or self.place, "contact name"))
        label = f"contact {quoted(self.name)}"
        if self.directions is not None:
            validation.store(self, directions=_directions(self.directions, self.possible, label))
        validation.store(self, damping=number(self.damping, f"{label}: damping"))
        if value_of(self.damping) < 0:
            raise ModelError(f"{label}: its damping {quoted(value_of(self.damping))} is negative.")

    @property
    def place(self) -> str:
        """Name of the point or frame that is held."""
        return self.point or self.frame

    @property
    def possible(self) -> tuple[str, ...]:
        """The directions in which such a contact can hold: three of a point, six of a frame."""
        return FORCES if self.point else COMPONENTS

    @property
    def held(self) -> tuple[str, ...]:
        """The directions in which it holds, in the order of `possible`."""
        return self.possible if self.directions is None else self.directions

    @property
    def summary(self) -> str:
        """The contact in one line, as `kanegen info` and the header of the C show it."""
        what = f"point {self.point}" if self.point else f"frame {self.frame}"
        directions = "" if self.directions is None else f" by {', '.join(self.directions)}"
        damping = "" if self.damping == 0 else f", damping {toml_number(self.damping)}"
        return f"{self.name}: holds {what}{directions}{damping}"

    def rows(self) -> Iterator[ContactRow]:
        """Yield the held directions, row by row."""
        indices = [COMPONENTS.index(direction) for direction in self.held]
        whole = {kind for kind in (0, 1) if sum(index // 3 == kind for index in indices) == len(FORCES)}
        for index in indices:
            yield ContactRow(f"{self.name}.{COMPONENTS[index]}", self, index, index // 3 in whole)

    def map_numbers(self, change: Callable[[Number], Number]) -> Contact:
        """Return the same contact with `change` applied to its damping.

        Example:
            plain = contact.map_numbers(value_of)  # parameters at their defaults
        """
        return replace(self, damping=change(self.damping))

    def as_table(self) -> dict[str, Any]:
        """Return the table `[[contact]]` of a model file, defaults left out.

        Example:
            kg.Contact(frame="left_sole_link").as_table()
        """
        table: dict[str, Any] = {} if self.name == self.place else {"name": self.name}
        table["point" if self.point else "frame"] = self.place
        if self.directions is not None:
            table["directions"] = self.directions
        return table | ({} if self.damping == 0 else {"damping": toml_number(self.damping)})


@dataclass(frozen=True)
class ContactRow:
    """A row of the constraints: a direction in which a contact holds.

    Attributes:
        name: Its name, that of the contact with that of the load, such as "left_foot.force3".
        contact: The contact.
        index: Index of the load in `COMPONENTS`, 0-2 for moments and 3-5 for forces.
        is_along_body: Whether loads are solved for along axis 1, 2 or 3 of the body, in whose frame they are
            cheapest, instead of the inertial axis; so where the contact holds along all three.
    """

    name: str
    contact: Contact
    index: int
    is_along_body: bool = False

    @property
    def is_moment(self) -> bool:
        """Whether it holds against turning."""
        return self.index < len(FORCES)

    @property
    def axis(self) -> int:
        """Axis of the load, 0 to 2."""
        return self.index % 3

    @property
    def effort(self) -> Literal["N m", "N"]:
        """Unit of the load, of a moment or of a force."""
        return "N m" if self.is_moment else "N"

    @property
    def solved(self) -> str:
        """What is solved for in the place of the row, in words."""
        axes = "along axis {} of its body" if self.is_along_body else "along inertial axis {}"
        return (
            f"{COMPONENTS[self.index]!r} of contact {quoted(self.contact.name)}, {axes.format(self.axis + 1)}"
        )


def checked_contacts(
    contacts: Any,
    points: Mapping[str, tuple[int, Point]],
    frames: Mapping[str, Frame],
) -> tuple[Contact, ...]:
    """Return the contacts of a system, after checks.

    Args:
        contacts: The contacts.
        points: The points, each with the number of its body, by name.
        frames: All frames by name.

    Raises:
        ModelError: If a contact holds nothing that the bodies have, what it holds is fixed to the ground, or
            a name is taken.
    """
    found = validation.instances(contacts, Contact, LABEL)
    validation.unique("contact name", [contact.name for contact in found])
    for contact in found:
        label, place = f"contact {quoted(contact.name)}", contact.place
        if contact.point and place in points:
            continue
        if place not in frames and place != GROUND:
            kind = "point or frame" if contact.point else "frame or body"
            known = [*points, *frames] if contact.point else list(frames)
            hint = did_you_mean(place, known)
            if contact.frame and place in points:
                hint = f"There is a point of this name; write point = {quoted(place)}."
            raise ModelError(f"{label}: there is no {kind} {quoted(place)}. {hint}")
        if place not in frames or not frames[place].body:
            raise ModelError(f"{label}: {quoted(place)} is fixed to the ground, where nothing moves.")
    return found


def chosen_contacts(
    contacts: Any,
    declared: Sequence[Contact],
    bodies: Sequence[Body],
    places: tuple[Sequence[str], Sequence[str]],
) -> tuple[Contact, ...]:
    """Return the contacts that a user chooses; see `System.with_contacts`.

    Args:
        contacts: Contacts or names, one or several; a name with directions, such as "toe:force1+force3", is
            a contact that holds in these alone.
        declared: The contacts that the system has.
        bodies: The bodies.
        places: Names of the points, and of the frames.

    Raises:
        ModelError: If there is nothing of a name, or no such direction.
    """
    points, frames = places
    known = {name: Contact(frame=name) for name in frames} | {name: Contact(point=name) for name in points}
    known |= {contact.name: contact for contact in declared}
    items = (contacts,) if isinstance(contacts, Contact) else chosen(contacts)
    found = []
    for item in (contacts,) if items is None else items:
        if isinstance(item, Contact):
            found.append(item)
        elif isinstance(item, str) and (item in known or item == GROUND):
            found.append(known.get(item, Contact(frame=item)))
        elif isinstance(item, str) and (name := item.rpartition(":")[0]) in known:
            directions = tuple(item[len(name) + 1 :].split("+"))
            found.append(replace(known[name], directions=directions))
        elif isinstance(item, int) and not isinstance(item, bool) and 1 <= item <= len(bodies):
            found.append(Contact(frame=bodies[item - 1].name))
        else:
            hint = did_you_mean(item, known)
            raise ModelError(f"{LABEL}: there is no contact, point, frame or body {quoted(item)}. {hint}")
    return tuple(found)


def _directions(value: Any, possible: Sequence[str], label: str) -> tuple[str, ...]:
    """Return directions in which a contact holds, in their order.

    Raises:
        ModelError: If one does not exist or is named twice, none is named, or they are a table.
    """
    if isinstance(value, Mapping):
        raise ModelError(
            f"{label}: directions are a table. Write a list of those that hold, as in [{quoted(FORCES[0])}]."
        )
    items = chosen(value)
    names = [value] if items is None else list(items)
    if not names:
        raise ModelError(f"{label}: it holds in no direction. Name one, or leave the directions out for all.")
    for i, name in enumerate(names):
        if not isinstance(name, str) or name not in possible:
            extra = " Moments hold frames alone." if isinstance(name, str) and name in COMPONENTS else ""
            raise ModelError(
                f"{label}: there is no direction {quoted(name)}.{extra} {did_you_mean(name, possible)}"
            )
        if name in names[:i]:
            raise ModelError(f"{label}: direction {quoted(name)} is named twice. Name it once.")
    return tuple(name for name in possible if name in names)
