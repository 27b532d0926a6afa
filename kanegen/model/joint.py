"""The joint between a body and its lower body: the only description of it, which every derivation reads.

A joint consists of steps from its lower body J outward: the constant position {q'_K} and orientation [C_K],
three translations in the joint frame, and a rotation, which is an `AxisRotations` or a `QuaternionRotation`.
Each of the six freedoms is free, prescribed, coupled or locked. `Joint.coordinate_kinds` and
`Joint.speed_kinds` list their coordinates and speeds. A joint is plain data; the mathematics is in the
derivations.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal

from kanegen.choices import did_you_mean, is_among
from kanegen.errors import ModelError, quoted
from kanegen.model import right_angles, validation
from kanegen.model.coordinates import (
    ANGLES,
    ANGULAR_VELOCITY,
    FREEDOMS,
    NOTES,
    ORIENTATIONS,
    SEQUENCES,
    SPEED_KINDS,
    SPEEDS,
    TRANSLATIONS,
    Axes,
    Rotation,
    check_sequence,
    rotation_of,
    selected_freedoms,
)
from kanegen.model.limits import NO_LIMITS, Limits, check_limits
from kanegen.model.names import check_label
from kanegen.model.numbers import (
    Matrix,
    Number,
    Vector,
    map_numbers,
    numbers,
    toml_number,
)

IDENTITY: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
"""The orientation [C_K] of a joint frame that is parallel to the lower body."""


@dataclass(frozen=True)
class Joint:
    """The joint between body K and its lower body J.

    Attributes:
        position: (3,) position {q'_K} of the joint point Q_K from O_J, in J (m).
        orientation: [C_K], from J components to joint-frame components: a (3, 3) rotation, or three
            constant 1-2-3 angles (rad) where an angle is to stay a parameter. Angles that are all plain
            numbers become the matrix, with exact zeros and ones at right angles.
        free: (6,) which of `FREEDOMS` are free.
        locked: (6,) values of the locked freedoms (rad, m); 0 at the others.
        name: Name of the joint in a robot file, also the name of the freedom where only one moves.
        freedom_names: (6,) names of freedoms in a robot file where several joints of the file are one joint
            here; "" at the others. A freedom whose coordinate or speed is not its own, as an angle beside a
            quaternion, does not use its name.
        speeds: One of `SPEEDS`: "angle_rates", or "angular_velocity" for the components of {omega_hat'_K},
            Eq. (8), which keep [A] regular in every orientation and need three free angles.
        sequence: One of `SEQUENCES`, the axes of the three angles: with "3-1-3" theta1 turns about axis 3 of
            the joint frame, theta2 about axis 1 of the frame after that, theta3 about axis 3 of body K.
        coordinates: One of `ORIENTATIONS`: "angles", or "quaternion" for four Euler parameters of any common
            length in place of three free angles. The speeds of a quaternion are "angular_velocity".
        prescribed: (6,) which of `FREEDOMS` have a motion that is an input: values, rates and second
            derivatives. None of them is free.
        limits: Limits of position, speed and effort of the six freedoms. The equations do not contain them.
        coupled: (6,) which of `FREEDOMS` follow other freedoms by a `Coupling` of the system, which sets
            these flags. None of them is free.
        armature: (6,) reflected inertia of the motor of each freedom (kg m^2, kg): J n^2 for a rotor of
            inertia J behind a gear of ratio n. It adds to the inertia against the speed of the freedom, so
            to the diagonal of [A], and to nothing else. Where the speeds are components of the angular
            velocity, the first three belong to these; where a freedom is locked, it has no effect.

    Raises:
        ModelError: If a number, a shape, a name or a combination of choices is not usable.

    Example:
        hinge = kg.Joint(position=(0, 0, 0.4), free=(False, False, True, False, False, False))
    """

    position: Vector = (0.0, 0.0, 0.0)
    orientation: Matrix | Vector = IDENTITY
    free: tuple[bool, ...] = (True,) * 6
    locked: tuple[Number, ...] = (0.0,) * 6
    name: str = ""
    speeds: str = SPEEDS[0]
    sequence: str = NOTES
    coordinates: str = ORIENTATIONS[0]
    prescribed: tuple[bool, ...] = (False,) * 6
    limits: Limits = NO_LIMITS
    coupled: tuple[bool, ...] = (False,) * 6
    freedom_names: tuple[str, ...] = ("",) * 6
    armature: tuple[Number, ...] = (0.0,) * 6

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or self.name:
            check_label(self.name, "joint name")
        position = numbers(self.position, (3,), "joint position")
        free = validation.flags(self.free, 6, "free")
        locked = numbers(self.locked, (6,), "locked")
        orientation = validation.orientation(self.orientation, "joint orientation")
        locked = tuple(0.0 if is_free else value for is_free, value in zip(free, locked, strict=True))
        validation.store(self, position=position, orientation=orientation, free=free, locked=locked)
        validation.store(self, prescribed=validation.flags(self.prescribed, 6, "prescribed"))
        validation.store(self, coupled=validation.flags(self.coupled, 6, "coupled"))
        names = tuple(validation.sequence(self.freedom_names, 6, "freedom_names"))
        for freedom_name in names:
            if not isinstance(freedom_name, str) or freedom_name:
                check_label(freedom_name, "freedom name")
        validation.store(self, freedom_names=names)
        validation.store(self, armature=validation.armature(self.armature, FREEDOMS))
        self._check_driven()
        check_sequence(self.sequence)
        self._check_coordinates()
        self._check_speeds()
        validation.instances((self.limits,), Limits, "limits")
        check_limits(self.limits, self.moving, self.coordinate_kinds)

    def _check_driven(self) -> None:
        """Make sure that no prescribed or coupled freedom is free, locked at a value, or both of them."""
        for kind, flags, other in (
            ("prescribed", self.prescribed, self.coupled),
            ("coupled", self.coupled, self.prescribed),
        ):
            for name, *choice in zip(FREEDOMS, flags, self.free, other, self.locked, strict=True):
                is_driven, is_free, is_other, value = choice
                if is_driven and (is_free or is_other):
                    second = "free" if is_free else "coupled"
                    raise ModelError(
                        f"{kind}: {quoted(name)} is {second} as well. A freedom is one or the other."
                    )
                if is_driven and value != 0:
                    raise ModelError(
                        f"{kind}: {quoted(name)} is locked at {quoted(toml_number(value))}. Leave one out: "
                        f"a {kind} freedom gets its values at run time."
                    )

    def _check_coordinates(self) -> None:
        """Make sure that the coordinates exist and fit the free angles and the sequence."""
        if not is_among(self.coordinates, ORIENTATIONS):
            hint = did_you_mean(self.coordinates, ORIENTATIONS)
            raise ModelError(f"joint coordinates: {quoted(self.coordinates)} is unknown. {hint}")
        if self.coordinates == ORIENTATIONS[0]:
            return
        if not self.has_free_orientation:
            raise ModelError(
                f'joint coordinates: "{self.coordinates}" needs three free angles, because it reaches every '
                'orientation. Free theta1, theta2 and theta3, or keep "angles".'
            )
        if self.sequence != NOTES:
            raise ModelError(
                f"joint sequence: a {self.coordinates} turns about no sequence of axes, so "
                f"{quoted(self.sequence)} says nothing. Leave it out, or keep the coordinates 'angles'."
            )
        validation.store(self, speeds=SPEEDS[1])

    def _check_speeds(self) -> None:
        """Make sure that the speeds exist and fit the free angles."""
        if not is_among(self.speeds, SPEEDS):
            raise ModelError(
                f"joint speeds: {quoted(self.speeds)} is unknown. {did_you_mean(self.speeds, SPEEDS)}"
            )
        if self.speeds != SPEEDS[0] and not self.has_free_orientation:
            raise ModelError(
                'joint speeds: "angular_velocity" needs three free angles, because with fewer its components '
                'depend on each other. Free theta1, theta2 and theta3, or keep "angle_rates".'
            )

    @property
    def moving(self) -> tuple[bool, ...]:
        """(6,) which of `FREEDOMS` move: those that are free, prescribed or coupled."""
        return tuple(map(any, zip(self.free, self.prescribed, self.coupled, strict=True)))

    def freedom_name(self, index: int) -> str:
        """Return the name that a robot file has for freedom `index` of `FREEDOMS`, "" if it has none.

        Example:
            kg.Joint(free=(False, False, True, False, False, False), name="elbow").freedom_name(2)  # "elbow"
        """
        moves_alone = self.moving[index] and sum(self.moving) == 1
        return self.freedom_names[index] or (self.name if moves_alone else "")

    @property
    def has_free_orientation(self) -> bool:
        """Whether all three angles are free, so that the body reaches every orientation."""
        return all(self.free[:3])

    @cached_property
    def rotation(self) -> Rotation:
        """The rotation of body K in the joint frame, by angles or by a quaternion."""
        return rotation_of(self.coordinates, self.sequence)

    @cached_property
    def coordinate_kinds(self) -> tuple[int, ...]:
        """Indices in `COORDINATE_KINDS` of all coordinates, locked or not: rotation, then translations."""
        return (*self.rotation.coordinates, *TRANSLATIONS)

    @cached_property
    def free_coordinate_kinds(self) -> tuple[int, ...]:
        """Indices in `COORDINATE_KINDS` of the free coordinates: rotation, then translations."""
        return tuple(kind for kind in self.coordinate_kinds if kind >= len(FREEDOMS) or self.free[kind])

    @cached_property
    def speed_kinds(self) -> tuple[int, ...]:
        """(6,) indices in `SPEED_KINDS` of the speeds of the six freedoms, locked ones too."""
        angular = ANGLES if self.speeds == SPEEDS[0] else ANGULAR_VELOCITY
        return (*angular, *TRANSLATIONS)

    @property
    def speeds_are_rates(self) -> bool:
        """Whether the speeds of the angles are their rates, not components of the angular velocity."""
        return SPEED_KINDS[self.speed_kinds[0]].is_rate

    @property
    def axes(self) -> Axes:
        """Basis vectors, from 0, about which theta1, theta2, theta3 turn."""
        return SEQUENCES[self.sequence]

    @property
    def gimbal_lock(self) -> Literal["sin", "cos"] | None:
        """The function of theta2 that vanishes at gimbal lock; None for a joint without gimbal lock.

        Gimbal lock is where the axes of three free angles lie in a plane; a quaternion has none.
        """
        return self.rotation.gimbal_lock if self.has_free_orientation else None

    @property
    def mass_matrix_singularity(self) -> Literal["sin", "cos"] | None:
        """The function of theta2 that vanishes where [A] is singular: gimbal lock, with rates as speeds.

        Armature of theta1 or theta3 keeps [A] regular there.
        """
        is_regular = not self.speeds_are_rates or self.armature[0] or self.armature[2]
        return None if is_regular else self.gimbal_lock

    def with_prescribed(self, index: int) -> Joint:
        """Return the same joint with freedom `index` of `FREEDOMS`, free so far, prescribed.

        Example:
            driven = joint.with_prescribed(2)  # theta3 becomes an input
        """
        free = tuple(flag and i != index for i, flag in enumerate(self.free))
        prescribed = tuple(flag or i == index for i, flag in enumerate(self.prescribed))
        return replace(self, free=free, prescribed=prescribed)

    def map_numbers(self, change: Callable[[Number], Number]) -> Joint:
        """Return the same joint with `change` applied to every number.

        Example:
            plain = joint.map_numbers(value_of)  # parameters at their defaults
        """
        return replace(
            self,
            position=map_numbers(self.position, change),
            orientation=map_numbers(self.orientation, change),
            locked=map_numbers(self.locked, change),
            armature=map_numbers(self.armature, change),
        )

    def with_right_angles(self, tolerance: float) -> Joint:
        """Return the same joint, with constant angles within `tolerance` (rad) of a right angle made exact.

        Raises:
            OptionError: If `tolerance` is out of range, see `right_angles.checked_tolerance`.

        Example:
            exact = joint.with_right_angles(5e-5)  # 1.5708 becomes pi/2
        """
        limit = right_angles.checked_tolerance(tolerance)

        angles = (right_angles.if_plain(angle, limit) for angle in self.locked[:3])
        return replace(
            self,
            orientation=right_angles.orientation(self.orientation, limit),
            locked=(*angles, *self.locked[3:]),
        )

    def as_table(self) -> dict[str, Any]:
        """Return the table `joint` of a model file, defaults left out.

        Example:
            kg.Joint(free=(False, False, True, False, False, False)).as_table()
        """
        table: dict[str, Any] = {"name": self.name} if self.name else {}
        if any(self.position):
            table["position"] = map_numbers(self.position, toml_number)
        if self.orientation != IDENTITY:
            key = "orientation" if isinstance(self.orientation[0], tuple) else "orientation_angles"
            table[key] = map_numbers(self.orientation, toml_number)
        if self.sequence != NOTES:
            table["sequence"] = self.sequence
        # A coupled freedom is free in a model file; its coupling takes it out of {x} and {y}.
        free = tuple(map(any, zip(self.free, self.coupled, strict=True)))
        table["free"] = "all" if all(free) else selected_freedoms(free) or "none"
        names = zip(FREEDOMS, self.freedom_names, strict=True)
        if any(self.freedom_names):
            table["freedom_names"] = {freedom: name for freedom, name in names if name}
        if any(self.prescribed):
            table["prescribed"] = selected_freedoms(self.prescribed)
        locked = zip(FREEDOMS, self.locked, strict=True)
        table["locked"] = {name: toml_number(value) for name, value in locked if value}
        if self.coordinates != ORIENTATIONS[0]:
            table["coordinates"] = self.coordinates
        elif self.speeds != SPEEDS[0]:
            table["speeds"] = self.speeds
        if limits := self.limits.as_table():
            table["limits"] = limits
        if any(self.armature):
            armature = zip(FREEDOMS, self.armature, strict=True)
            table["armature"] = {name: toml_number(value) for name, value in armature if value}
        return table
