"""How a body is attached to its lower body."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from kanegen.choices import did_you_mean
from kanegen.errors import ModelError
from kanegen.model import right_angles, sequences, validation
from kanegen.model.freedoms import FREEDOMS, ORIENTATIONS, SPEEDS, named
from kanegen.model.names import check_label
from kanegen.model.numbers import Matrix, Number, Parameter, Vector, map_numbers, numbers, value_of, word

IDENTITY: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True)
class Joint:
    """How a body is attached to its lower body J.

    Attributes:
        position: `q'_K`, from O_J to Q_K, in J (m).
        orientation: `[C_K]`, from J components to joint-frame components: a (3, 3) rotation, or three
            constant 1-2-3 angles (rad) where an angle is to stay a parameter. Angles that are all plain
            numbers become the matrix, with exact zeros and ones at right angles.
        free: Which of `FREEDOMS` are free.
        locked: Values of those that neither are free nor prescribed (rad, m); 0 at the others.
        name: Name of the joint in a robot file; names the freedom where there is only one.
        speeds: One of `SPEEDS`. The components of `omega_hat'_K`, Eq. (8), keep [A] regular where the rates
            of the angles lose their meaning; they need three free angles.
        sequence: About which axes the angles turn, one of `sequences.SEQUENCES`: "3-1-3" has theta1 turn
            about axis 3 of the joint frame, theta2 about axis 1 of the frame it finds, theta3 about axis 3
            of body K.
        coordinates: One of `ORIENTATIONS`. Instead of three free angles, {x} then holds `QUATERNION`; their
            length has no meaning. The speeds are the components of `omega_hat'_K`, whatever `speeds` says.
        prescribed: Which of `FREEDOMS` move as they are told: their values, rates and second derivatives are
            inputs. None of them is free.
    """

    position: Vector = (0.0, 0.0, 0.0)
    orientation: Matrix | Vector = IDENTITY
    free: tuple[bool, ...] = (True,) * 6
    locked: tuple[Number, ...] = (0.0,) * 6
    name: str = ""
    speeds: str = SPEEDS[0]
    sequence: str = sequences.NOTES
    coordinates: str = ORIENTATIONS[0]
    prescribed: tuple[bool, ...] = (False,) * 6

    def __post_init__(self) -> None:
        if self.name != "":
            check_label(self.name, "joint name")
        position = numbers(self.position, (3,), "joint position")
        free = validation.flags(self.free, 6, "free")
        locked = numbers(self.locked, (6,), "locked")
        orientation = validation.orientation(self.orientation)
        locked = tuple(0.0 if is_free else value for is_free, value in zip(free, locked, strict=True))
        validation.store(self, position=position, orientation=orientation, free=free, locked=locked)
        validation.store(self, prescribed=validation.flags(self.prescribed, 6, "prescribed"))
        self._check_prescribed()
        sequences.check(self.sequence)
        self._check_coordinates()
        self._check_speeds()

    def _check_prescribed(self) -> None:
        for name, *what in zip(FREEDOMS, self.prescribed, self.free, self.locked, strict=True):
            is_prescribed, is_free, value = what
            if is_prescribed and is_free:
                raise ModelError(f"prescribed: {name!r} is free as well. A freedom is one or the other.")
            if is_prescribed and value != 0:
                raise ModelError(
                    f"prescribed: {name!r} is locked at {word(value)!r}. Leave one out: a prescribed freedom "
                    "gets its values at run time."
                )

    def _check_coordinates(self) -> None:
        if self.coordinates not in ORIENTATIONS:
            hint = did_you_mean(self.coordinates, ORIENTATIONS)
            raise ModelError(f"joint coordinates: {self.coordinates!r} is unknown. {hint}")
        if self.is_quaternion and not self.turns_freely:
            raise ModelError(
                'joint coordinates: "quaternion" needs three free angles, because it reaches every '
                'orientation. Free theta1, theta2 and theta3, or keep "angles".'
            )
        if self.is_quaternion and self.sequence != sequences.NOTES:
            raise ModelError(
                f"joint sequence: a quaternion turns about no sequence of axes, so {self.sequence!r} says "
                'nothing. Leave it out, or keep the coordinates "angles".'
            )
        if self.is_quaternion:
            validation.store(self, speeds="angular_velocity")

    def _check_speeds(self) -> None:
        if self.speeds not in SPEEDS:
            raise ModelError(f"joint speeds: {self.speeds!r} is unknown. {did_you_mean(self.speeds, SPEEDS)}")
        if self.spins and not self.turns_freely:
            raise ModelError(
                'joint speeds: "angular_velocity" needs three free angles, because with fewer its components '
                'depend on each other. Free theta1, theta2 and theta3, or keep "angle_rates".'
            )

    @property
    def moving(self) -> tuple[bool, ...]:
        """Which of `FREEDOMS` move: those that are free or prescribed."""
        return tuple(a or b for a, b in zip(self.free, self.prescribed, strict=True))

    @property
    def turns_freely(self) -> bool:
        """Whether all three angles are free."""
        return all(self.free[:3])

    @property
    def is_quaternion(self) -> bool:
        """Whether a quaternion stands in {x} in place of the three angles."""
        return self.coordinates == "quaternion"

    @property
    def spins(self) -> bool:
        """Whether the three speeds of the angles are components of the relative angular velocity."""
        return self.speeds == "angular_velocity"

    @property
    def axes(self) -> sequences.Axes:
        """Basis vectors about which theta1, theta2, theta3 turn, from 0."""
        return sequences.SEQUENCES[self.sequence]

    @property
    def ends_alike(self) -> bool:
        """Whether the last angle turns about the axis of the first, as in 3-1-3."""
        return self.axes[0] == self.axes[2]

    def prescribing(self, index: int) -> Joint:
        """The same joint where freedom `index` of `FREEDOMS`, free so far, is prescribed."""
        free = tuple(flag and i != index for i, flag in enumerate(self.free))
        told = tuple(flag or i == index for i, flag in enumerate(self.prescribed))
        return replace(self, free=free, prescribed=told)

    def changed(self, change: Callable[[Number], Number]) -> Joint:
        """The same joint with `change` applied to every number."""
        return replace(
            self,
            position=map_numbers(self.position, change),
            orientation=map_numbers(self.orientation, change),
            locked=map_numbers(self.locked, change),
        )

    def with_right_angles(self, tolerance: float) -> Joint:
        """The same joint; constant angles that miss a right one by no more than `tolerance` (rad) are it."""

        def exact(value: Number) -> Number:
            return value if isinstance(value, Parameter) else right_angles.angle(value, tolerance)

        orientation = self.orientation
        if isinstance(orientation[0], tuple):
            plain = map_numbers(orientation, value_of)
            orientation = right_angles.rotation(plain, tolerance) if plain == orientation else orientation
        else:
            orientation = map_numbers(orientation, exact)
        return replace(self, orientation=orientation, locked=(*map(exact, self.locked[:3]), *self.locked[3:]))

    def as_table(self) -> dict[str, Any]:
        """The joint in the words of a model file, defaults left out."""
        table: dict[str, Any] = {"name": self.name} if self.name else {}
        if any(self.position):
            table["position"] = map_numbers(self.position, word)
        if self.orientation != IDENTITY:
            key = "orientation" if isinstance(self.orientation[0], tuple) else "orientation_angles"
            table[key] = map_numbers(self.orientation, word)
        if self.sequence != sequences.NOTES:
            table["sequence"] = self.sequence
        table["free"] = "all" if all(self.free) else named(self.free) or "none"
        if any(self.prescribed):
            table["prescribed"] = named(self.prescribed)
        locked = zip(FREEDOMS, self.locked, strict=True)
        table["locked"] = {name: word(value) for name, value in locked if value}
        if self.is_quaternion:
            table["coordinates"] = self.coordinates
        elif self.spins:
            table["speeds"] = self.speeds
        return table
