"""`SystemFrames`: the points and frames of a system, by their names."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from kanegen.model.body import Point
from kanegen.model.contact import Contact, ContactRow
from kanegen.model.frame import Frame, frames_by_name, placed, resolved, whereabouts
from kanegen.model.rotations import apply
from kanegen.model.system_fields import SystemFields


@dataclass(frozen=True)
class SystemFrames(SystemFields):
    """The points and frames that are fixed in the bodies of a `System` or in the ground, by their names."""

    @cached_property
    def points(self) -> tuple[tuple[int, Point], ...]:
        """The points of all bodies, body by body, each with the number of its body."""
        return tuple((k, point) for k, body in enumerate(self.bodies, start=1) for point in body.points)

    @cached_property
    def point_names(self) -> tuple[str, ...]:
        """(P,) names of the points, in the order of the rows of outputs about points."""
        return tuple(point.name for _, point in self.points)

    @cached_property
    def _points_by_name(self) -> dict[str, tuple[int, Point]]:
        """Every point by its name, with the number of its body."""
        return {point.name: (k, point) for k, point in self.points}

    @cached_property
    def frames_by_name(self) -> dict[str, Frame]:
        """Every frame by its name: that of each body for its user, then the further ones of `frames`."""
        return frames_by_name(self.bodies, self.frames)

    @cached_property
    def _further_frames(self) -> dict[str, Frame]:
        """The frames beside the bodies' own of the model, by name."""
        return {frame.name: frame for frame in self.frames}

    @property
    def frame_names(self) -> tuple[str, ...]:
        """Names of all frames: the bodies, then the further frames, those of the ground first."""
        return tuple(self.frames_by_name)

    def frame(self, name: str | int, label: str = "frame") -> Frame:
        """Return the frame that a name means: a frame of the system, a body for its user, or "ground".

        Args:
            name: Name of a frame or body, or number of a body from 1.
            label: Name of the object that refers to the frame, for the message.

        Raises:
            ModelError: If there is no such frame.

        Example:
            system.frame("tool").body
        """
        return resolved(self.frames_by_name, self.bodies, name, label)

    def frame_path(self, name: str) -> tuple[Frame, ...]:
        """Return the frames by which a frame is given: each in the one before it, the first in its body.

        A name without a frame of its own, such as that of a body or "", is the body's frame of the model and
        has no such frames.

        Example:
            [frame.name for frame in system.frame_path("tool")]
        """
        found: list[Frame] = []
        while name in self._further_frames:
            found.append(self._further_frames[name])
            name = found[-1].frame
        return tuple(reversed(found))

    def whereabouts(self, name: object) -> str:
        """Return a sentence that says to what a frame is fixed and where; "" if the name is none of one.

        Args:
            name: Name of a frame, or of what would be a freedom of it, such as `<frame>.theta1`. A body is
                fixed to nothing.

        Example:
            system.whereabouts("panda_hand")  # 'panda_hand' is fixed to body 'panda_link7', at ...
        """
        for candidate in (name, name.rpartition(".")[0]) if isinstance(name, str) else ():
            frame = self._further_frames.get(candidate)
            body = self.bodies[frame.body - 1].name if frame and frame.body else ""
            if frame and frame.name != body:
                (x, y, z), _ = placed(self.frame_path(candidate))
                origin, rotation = placed(self.frame_path(body))
                arm = (x - origin[0], y - origin[1], z - origin[2])
                return whereabouts(frame, body, apply(rotation, arm))
        return ""

    @cached_property
    def contact_rows(self) -> tuple[ContactRow, ...]:
        """The rows of `contact_forces`: the held directions of all contacts, contact by contact."""
        return tuple(row for contact in self.contacts for row in contact.rows())

    @cached_property
    def contact_names(self) -> tuple[str, ...]:
        """(m,) names of the rows of `contact_forces`, such as "left_foot.force3"."""
        return tuple(row.name for row in self.contact_rows)

    def place(self, name: str) -> tuple[int, Point]:
        """Return where a spring ends, a load acts or a contact holds: at a point or the origin of a frame.

        Returns:
            Number of the body, 0 for the ground, and the point.

        Raises:
            KeyError: If there is neither a point nor a frame of this name.

        Example:
            body, point = system.place("tool")
        """
        if name in self._points_by_name:
            return self._points_by_name[name]
        return self._origin(name)

    def held(self, contact: Contact) -> tuple[int, Point]:
        """Return what a contact holds: number of the body, and the point, in a frame the origin.

        Example:
            body, point = system.held(system.contacts[0])
        """
        return self.place(contact.point) if contact.point else self._origin(contact.frame)

    def _origin(self, name: str) -> tuple[int, Point]:
        """Return the body of a frame, 0 for the ground, and the origin of the frame as a point."""
        return self.frames_by_name[name].body, Point(name, (0.0, 0.0, 0.0), frame=name)
