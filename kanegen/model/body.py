"""A rigid body: its mass, its inertia, its points, and the joint below it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from kanegen.errors import ModelError, quoted
from kanegen.model import validation
from kanegen.model.joint import Joint
from kanegen.model.names import check_label
from kanegen.model.numbers import Matrix, Number, Vector, map_numbers, numbers, toml_number


@dataclass(frozen=True)
class Point:
    """A point that is fixed in a body, such as the tip of a tool.

    Attributes:
        name: Label, unique in the system.
        position: (3,) position from the origin O_K of its body, in body components, or from the origin of
            `frame`, in its components (m).
        loads: Whether a force and a moment on the point are inputs.
        frame: Name of a frame of its body in which the position is given; "" is the frame of the model, with
            the origin O_K, in which mass centre and inertia are given.
        load_frame: Name of a frame of its body in whose components the loads are; "" for inertial ones.

    Raises:
        ModelError: If the name or the position is not usable.

    Example:
        kg.Point("tip", (0.0, 0.0, 0.12), loads=True)
    """

    name: str
    position: Vector
    loads: bool = False
    frame: str = ""
    load_frame: str = ""

    def __post_init__(self) -> None:
        check_label(self.name, "point name")
        label = f"point {quoted(self.name)}"
        for key in ("frame", "load_frame"):
            name = getattr(self, key)
            if not isinstance(name, str) or name:
                check_label(name, f"{label}: {key}")
        position = numbers(self.position, (3,), label)
        validation.store(self, position=position, loads=validation.flags((self.loads,), 1, label)[0])

    def map_numbers(self, change: Callable[[Number], Number]) -> Point:
        """Return the same point with `change` applied to every number.

        Example:
            doubled = point.map_numbers(lambda number: 2 * number)
        """
        return replace(self, position=map_numbers(self.position, change))

    def as_toml(self) -> Any:
        """Return the point as a model file holds it: its position, or a table where it has more than that.

        Example:
            kg.Point("tip", (0, 0, 0.1)).as_toml()  # (0.0, 0.0, 0.1)
        """
        table: dict[str, Any] = {"position": map_numbers(self.position, toml_number)}
        if self.loads:
            table["loads"] = True
        if self.frame:
            table["frame"] = self.frame
        if self.load_frame:
            table["load_frame"] = self.load_frame
        return table if len(table) > 1 else table["position"]


@dataclass(frozen=True)
class Body:
    """A rigid body K and the joint that connects it to its lower body J.

    Attributes:
        name: Label, unique in the system.
        lower: Number of the lower body, 0 for the ground.
        mass: Mass (kg).
        inertia: (3, 3) central inertia [I'_{G_K}], about the mass centre, in body components (kg m^2).
        mass_center: (3,) position r'_K of the mass centre G_K from O_K, in body components (m).
        joint: The joint between the lower body and this one.
        loads: Whether a force and a torque on the body are inputs.
        points: Points of the body that outputs, springs and loads refer to.

    Raises:
        ModelError: If a number, a shape or the name is not usable.

    Example:
        link = kg.Body("link", 0, 2.0, ((0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.02)), (0, 0, 0.3))
    """

    name: str
    lower: int
    mass: Number
    inertia: Matrix
    mass_center: Vector = (0.0, 0.0, 0.0)
    joint: Joint = field(default_factory=Joint)
    loads: bool = False
    points: tuple[Point, ...] = ()

    def __post_init__(self) -> None:
        check_label(self.name, "body name")
        label = f"body {quoted(self.name)}: "
        try:
            validation.store(
                self,
                lower=validation.integer(self.lower, "connection"),
                mass=validation.mass(self.mass, f"{label}mass"),
                inertia=validation.inertia(self.inertia, self.name),
                mass_center=numbers(self.mass_center, (3,), f"{label}mass centre"),
                joint=validation.instances((self.joint,), Joint, "joint")[0],
                loads=validation.flags((self.loads,), 1, "loads")[0],
                points=validation.instances(self.points, Point, "points"),
            )
        except ModelError as error:
            raise ModelError(f"{label}{str(error).removeprefix(label)}") from None

    def map_numbers(self, change: Callable[[Number], Number]) -> Body:
        """Return the same body with `change` applied to every number of it, its points and its joint.

        Example:
            plain = body.map_numbers(value_of)  # parameters at their defaults
        """
        return replace(
            self,
            mass=change(self.mass),
            inertia=map_numbers(self.inertia, change),
            mass_center=map_numbers(self.mass_center, change),
            joint=self.joint.map_numbers(change),
            points=tuple(point.map_numbers(change) for point in self.points),
        )

    def without_loads(self) -> Body:
        """Return the same body without forces and torques as inputs, on it and on its points.

        Example:
            bodies = [body.without_loads() for body in system.bodies]
        """
        points = tuple(replace(point, loads=False) for point in self.points)
        return replace(self, loads=False, points=points)

    def as_table(self, lower: int | str, frames: Mapping[str, Any] | None = None) -> dict[str, Any]:
        """Return the table `[[body]]` of a model file, defaults left out.

        Args:
            lower: Number or name of the lower body, as the file says it.
            frames: Frames of the body as the file holds them, by name.

        Example:
            system.bodies[1].as_table("base")
        """
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = self.inertia
        table: dict[str, Any] = {"name": self.name, "connection": lower, "mass": toml_number(self.mass)}
        if any(self.mass_center):
            table["mass_center"] = map_numbers(self.mass_center, toml_number)
        table["inertia"] = map_numbers(self.inertia if xy or xz or yz else (xx, yy, zz), toml_number)
        if self.loads:
            table["loads"] = True
        if frames:
            table["frames"] = dict(frames)
        if self.points:
            table["points"] = {point.name: point.as_toml() for point in self.points}
        return {**table, "joint": self.joint.as_table()}
