"""Named frames that are fixed in a body or in the ground, and the frame of each body for its user.

Every body is a frame under its own name. Unless the system says otherwise, this is the frame of the model, in
which the mass centre and the inertia are given. A reader that turns a body's own frame, so that a joint moves
about or along a basis vector, gives the body a frame of the same name: the one of the file. Poses, loads and
points that name the body then mean that frame, and the turned one does not show.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from kanegen.choices import did_you_mean, is_among
from kanegen.errors import ModelError, quoted
from kanegen.model import right_angles, validation
from kanegen.model.body import Body, Point
from kanegen.model.joint import IDENTITY
from kanegen.model.names import check_label
from kanegen.model.numbers import Matrix, Number, Vector, map_numbers, numbers, toml_number, value_of
from kanegen.model.rotations import UNIT, ZERO, Square, Triple, apply, product, rotation_123, transpose

GROUND = "ground"
"""Name of the inertial frame. Where another frame or a body of a file has it, too, it cannot be used."""


@dataclass(frozen=True)
class Frame:
    """A frame that is fixed in a body or in the ground.

    Attributes:
        name: Label, unique among the frames of a system; the name of its own body makes it the frame that
            users of the body see.
        body: Number of the body, 0 for the ground.
        position: (3,) position of its origin, in the components of the frame in which it is given (m).
        orientation: From components of the frame in which it is given to its own components: a (3, 3)
            rotation, or three constant 1-2-3 angles (rad) where an angle is to stay a parameter.
        frame: Name of the frame in which it is given, an earlier one of the same body; "" is the frame of the
            model, with the origin O_K, in which mass centre and inertia are given.

    Raises:
        ModelError: If a name, a number or a shape is not usable.

    Example:
        kg.Frame("camera", 3, position=(0.0, 0.05, 0.1), orientation=(0.0, 0.4, 0.0))
    """

    name: str
    body: int
    position: Vector = (0.0, 0.0, 0.0)
    orientation: Matrix | Vector = IDENTITY
    frame: str = ""

    def __post_init__(self) -> None:
        check_label(self.name, "frame name")
        label = f"frame {quoted(self.name)}"
        if not isinstance(self.frame, str) or self.frame:
            check_label(self.frame, f"{label}: frame")
        try:
            validation.store(
                self,
                body=validation.integer(self.body, "body"),
                position=numbers(self.position, (3,), "position"),
                orientation=validation.orientation(self.orientation, "orientation"),
            )
        except ModelError as error:
            raise ModelError(f"{label}: {error}") from None

    @property
    def is_trivial(self) -> bool:
        """Whether it coincides with the frame in which it is given."""
        return not any(self.position) and self.orientation == IDENTITY

    def map_numbers(self, change: Callable[[Number], Number]) -> Frame:
        """Return the same frame with `change` applied to every number.

        Example:
            plain = frame.map_numbers(value_of)  # parameters at their defaults
        """
        return replace(
            self,
            position=map_numbers(self.position, change),
            orientation=map_numbers(self.orientation, change),
        )

    def with_right_angles(self, tolerance: float) -> Frame:
        """Return the same frame, with constant angles within `tolerance` (rad) of a right angle made exact.

        Raises:
            OptionError: If `tolerance` is out of range, see `right_angles.checked_tolerance`.

        Example:
            exact = frame.with_right_angles(5e-5)  # 1.5708 becomes pi/2
        """
        limit = right_angles.checked_tolerance(tolerance)
        return replace(self, orientation=right_angles.orientation(self.orientation, limit))

    def as_toml(self) -> Any:
        """Return the frame as a model file holds it: its position, or a table where it is more than that.

        Example:
            kg.Frame("tool", 2, (0, 0, 0.1)).as_toml()  # (0.0, 0.0, 0.1)
        """
        table: dict[str, Any] = {"position": map_numbers(self.position, toml_number)}
        if self.orientation != IDENTITY:
            key = "orientation" if isinstance(self.orientation[0], tuple) else "orientation_angles"
            table[key] = map_numbers(self.orientation, toml_number)
        if self.frame:
            table["frame"] = self.frame
        return table if len(table) > 1 else table["position"]


def placed(path: Sequence[Frame]) -> tuple[Triple, Square]:
    """Return where the last of some frames is, each of which is given in the one before it.

    Args:
        path: The frames; the first is given in the frame of the model of its body.

    Returns:
        Position of its origin from O_K, in K (m), and the rotation from components of K to its own;
        parameters stand at their defaults.
    """
    position, rotation = ZERO, UNIT
    for frame in path:
        x, y, z = apply(transpose(rotation), map_numbers(frame.position, value_of))
        position = position[0] + x, position[1] + y, position[2] + z
        turn = map_numbers(frame.orientation, value_of)
        rotation = product(turn if isinstance(turn[0], tuple) else rotation_123(turn), rotation)
    return position, rotation


def whereabouts(frame: Frame, body: str, position: Triple) -> str:
    """Return a sentence that says to what a frame is fixed and where.

    Args:
        frame: The frame.
        body: Name of its body, "" for the ground.
        position: Position of its origin in the frame of the body (m).
    """
    place = ", ".join(f"{round(value, 9) + 0.0:.6g}" for value in position)
    if not body:
        return f"{quoted(frame.name)} is fixed to the ground, at ({place}) m."
    return f"{quoted(frame.name)} is fixed to body {quoted(body)}, at ({place}) m in the frame of the body."


def frames_by_name(bodies: Sequence[Body], frames: Sequence[Frame]) -> dict[str, Frame]:
    """Return every frame by its name: that of each body for its user, then the further ones."""
    own = {body.name: Frame(body.name, k) for k, body in enumerate(bodies, start=1)}
    return own | {frame.name: frame for frame in frames}


def resolved(known: Mapping[str, Frame], bodies: Sequence[Body], name: Any, label: str) -> Frame:
    """Return the frame that a user names.

    Args:
        known: The frames by name, as `frames_by_name` returns them.
        bodies: The bodies of the system.
        name: Name of a frame or body, number of a body from 1, or `GROUND`.
        label: Name of the object that refers to the frame, for the message.

    Raises:
        ModelError: If there is no such frame, or "ground" may mean the inertial frame or another one.
    """
    if isinstance(name, str):
        if name == GROUND and name in known and (known[name].body or not known[name].is_trivial):
            kind = "body" if any(body.name == name for body in bodies) else "frame"
            raise ModelError(
                f"{label}: 'ground' is the inertial frame, but a {kind} of the model has this name, too. "
                f"Give the {kind} another name."
            )
        if name in known:
            return known[name]
        if name == GROUND:
            return Frame(GROUND, 0)
    elif not isinstance(name, bool) and is_among(name, range(1, len(bodies) + 1)):
        return known[bodies[int(name) - 1].name]
    raise ModelError(f"{label}: there is no body or frame {quoted(name)}. {did_you_mean(name, known)}")


def checked_frames(bodies: Sequence[Body], frames: Any) -> tuple[Frame, ...]:
    """Return the frames of a system in the order of their bodies, those of the ground first.

    Raises:
        ModelError: If a frame is on no body, a name is taken, or a frame is given in one that is not before
            it on the same body.
    """
    ordered = sorted(validation.instances(frames, Frame, "frames"), key=lambda frame: frame.body)
    validation.unique("frame name", [frame.name for frame in ordered])
    number_of = {body.name: k for k, body in enumerate(bodies, start=1)}
    before: dict[str, int] = {}
    names = {frame.name for frame in ordered}
    for frame in ordered:
        label = f"frame {quoted(frame.name)}"
        if not 0 <= frame.body <= len(bodies):
            raise ModelError(
                f"{label}: there is no body {quoted(frame.body)}; bodies count from 1 to {len(bodies)}, and "
                "0 is the ground."
            )
        if number_of.get(frame.name, frame.body) != frame.body:
            raise ModelError(f"{label}: another body has this name. Give the frame its own.")
        is_before = before.get(frame.frame) == frame.body
        is_own = frame.frame not in names and number_of.get(frame.frame) == frame.body
        if frame.frame and not is_before and not is_own:
            raise ModelError(
                f"{label}: it is given in {quoted(frame.frame)}, which is no earlier frame of the same body. "
                f"{did_you_mean(frame.frame, [name for name, k in before.items() if k == frame.body])}"
            )
        before[frame.name] = frame.body
    return tuple(ordered)


def check_points(points: Sequence[tuple[int, Point]], known: Mapping[str, Frame]) -> None:
    """Make sure that the frames in which each point and its loads are given are those of its own body.

    Args:
        points: The points, each with the number of its body.
        known: The frames by name, as `frames_by_name` returns them.

    Raises:
        ModelError: If there is no such frame on the body.
    """
    for k, point in points:
        names = [name for name, frame in known.items() if frame.body == k]
        for name in (point.frame, point.load_frame):
            if name and name not in names:
                raise ModelError(
                    f"point {quoted(point.name)}: its body has no frame {quoted(name)}. "
                    f"{did_you_mean(name, names)}"
                )
