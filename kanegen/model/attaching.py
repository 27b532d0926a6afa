"""Points, frames and loads that are added to the bodies of a system, by the names of frames."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from kanegen.errors import ModelError, quoted
from kanegen.model import output_rows, validation
from kanegen.model.body import Body, Point
from kanegen.model.description import SystemDescription
from kanegen.model.frame import GROUND, Frame
from kanegen.model.joint import IDENTITY

EXAMPLE = '{"tool": ("hand", (0, 0, 0.1))}'


def bodies_with_points(system: SystemDescription, points: Any) -> tuple[Body, ...]:
    """Return the bodies of a system with further points; see `System.with_points`."""
    bodies = list(system.bodies)
    for name, value in validation.table(points, "points", EXAMPLE).items():
        label = f"point {quoted(name)}"
        place, position = validation.sequence(value, 2, label)
        at = _movable(system, place, label)
        point = Point(name, position, frame=_given_in(system, at))
        bodies[at.body - 1] = replace(bodies[at.body - 1], points=(*bodies[at.body - 1].points, point))
    return tuple(bodies)


def new_frame(system: SystemDescription, name: Any, value: Any) -> Frame:
    """Return a further frame of a system from its entry in a table; see `System.with_frames`."""
    label = f"frame {quoted(name)}"
    items: Sequence[Any] = validation.sequence(value, None, label)
    if name == GROUND:
        raise ModelError(f"{label}: this is the name of the inertial frame. Give the frame another name.")
    if len(items) not in (2, 3):
        raise ModelError(
            f"{label}: expected a frame or body, a position and perhaps an orientation, as in {EXAMPLE}, got "
            f"{quoted(value)}."
        )
    at, position, orientation = system.frame(items[0], label), items[1], (*items, IDENTITY)[2]
    return Frame(name, at.body, position, orientation, _given_in(system, at))


def bodies_with_loads(system: SystemDescription, names: Any) -> tuple[Body, ...]:
    """Return the bodies of a system with further loads as inputs; see `System.with_loads`."""
    bodies = list(system.bodies)
    at_points = {point.name: k for k, point in system.points}
    for name in output_rows.listed_choices(names, "loads", "to add none"):
        if isinstance(name, str) and name in at_points:
            k, point = at_points[name], name
        else:
            at = _movable(system, name, "loads")
            k, point = at.body, "" if at.name == bodies[at.body - 1].name else at.name
        bodies[k - 1] = _loaded(bodies[k - 1], point)
    return tuple(bodies)


def _loaded(body: Body, name: str) -> Body:
    """Return a body with a load on its point or frame `name`, or at its mass centre where that is ""."""
    if not name:
        return replace(body, loads=True)
    points = {point.name: point for point in body.points}
    new = Point(name, (0.0, 0.0, 0.0), frame=name, load_frame=name)
    points[name] = replace(points.get(name, new), loads=True)
    return replace(body, points=tuple(points.values()))


def _movable(system: SystemDescription, name: Any, label: str) -> Frame:
    """Return a frame of a body; one of the ground is an error."""
    frame = system.frame(name, label)
    if not frame.body:
        raise ModelError(f"{label}: {quoted(frame.name)} is fixed to the ground, where nothing moves.")
    return frame


def _given_in(system: SystemDescription, frame: Frame) -> str:
    """Return the name by which a point or frame says in which frame it is given."""
    return frame.name if frame in system.frames else ""
