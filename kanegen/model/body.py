"""A rigid body: its mass, its inertia, its points, and the joint below it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

from kanegen.errors import ModelError
from kanegen.model import validation
from kanegen.model.joint import Joint
from kanegen.model.names import check_label
from kanegen.model.numbers import Matrix, Number, Vector, map_numbers, number, numbers, word
from kanegen.model.point import Point


@dataclass(frozen=True)
class Body:
    """A rigid body and the joint below it.

    Attributes:
        name: Label, unique in the system.
        lower: Number of the lower body, 0 for the ground.
        mass: kg.
        inertia: `[I'_{G_K}]`, about the mass centre, in body components (kg m^2).
        mass_center: `r'_K`, from O_K to G_K, in body components (m).
        joint: How it hangs on its lower body.
        loads: Whether it takes a force and a torque as inputs.
        points: Points of it that outputs are about.
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
        try:
            validation.store(
                self,
                lower=validation.integer(self.lower, "connection"),
                mass=validation.mass(number(self.mass, "mass")),
                inertia=validation.inertia(numbers(self.inertia, (3, 3), "inertia"), self.name),
                mass_center=numbers(self.mass_center, (3,), "mass centre"),
                joint=validation.instances((self.joint,), Joint, "joint")[0],
                loads=validation.flags((self.loads,), 1, "loads")[0],
                points=validation.instances(self.points, Point, "points") if self.points else (),
            )
        except ModelError as error:
            raise ModelError(f"body {self.name!r}: {error}") from None

    def changed(self, change: Callable[[Number], Number]) -> Body:
        """The same body with `change` applied to every number of it and its joint."""
        return replace(
            self,
            mass=change(self.mass),
            inertia=map_numbers(self.inertia, change),
            mass_center=map_numbers(self.mass_center, change),
            joint=self.joint.changed(change),
            points=tuple(point.changed(change) for point in self.points),
        )

    def unloaded(self) -> Body:
        """The same body without loads as inputs, on it and its points."""
        points = tuple(replace(point, loads=False) for point in self.points)
        return replace(self, loads=False, points=points)

    def as_table(self, lower: int | str) -> dict[str, Any]:
        """The body in the words of a model file, `lower` being its connection there; defaults left out."""
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = self.inertia
        table: dict[str, Any] = {"name": self.name, "connection": lower, "mass": word(self.mass)}
        if any(self.mass_center):
            table["mass_center"] = map_numbers(self.mass_center, word)
        table["inertia"] = map_numbers(self.inertia if xy or xz or yz else (xx, yy, zz), word)
        if self.loads:
            table["loads"] = True
        if self.points:
            table["points"] = {point.name: point.as_word() for point in self.points}
        return {**table, "joint": self.joint.as_table()}
