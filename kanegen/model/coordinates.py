"""Freedoms, coordinates, speeds and rotations of a joint: plain data that every derivation reads.

Two tables hold everything that may stand in {x} and {y}, Eq. (1), with its name, unit and symbol. Two classes
say how coordinates orient a body in its joint frame: three rotations about axes, or a quaternion. Every
derivation (symbolic, recursive, reference, truth) turns them into a rotation matrix and rates by formulas of
its own. A new kind of rotation is a class here, its coordinates are appended to `COORDINATE_KINDS`.

Three rotations about basis vectors of the moving frame reach every orientation where no two neighbours have
the same axis: six sequences of three different axes (Tait-Bryan angles), and six that end with the axis they
begin with (proper Euler angles).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product
from typing import ClassVar, Literal

from kanegen.choices import did_you_mean
from kanegen.errors import ModelError, quoted
from kanegen.model.rotations import Triple, angles_123, rotation_quaternion, transpose

FREEDOMS = ("theta1", "theta2", "theta3", "s1", "s2", "s3")
"""Names of the six relative freedoms of a body, in the order of `Joint.free`: angles (rad), then translations
(m)."""

ANGLES = (0, 1, 2)
"""Indices of the angles in `FREEDOMS`."""

TRANSLATIONS = (3, 4, 5)
"""Indices of the translations in `FREEDOMS`."""


@dataclass(frozen=True)
class CoordinateKind:
    """One coordinate that a joint may have.

    Attributes:
        name: Name within the body, such as "theta1" or "e0".
        unit: Unit of the coordinate.
        symbol: Letter of the notes, spelled out: its symbol is `<symbol>_K_<number>`, that of its rate
            `<symbol>dot_K_<number>`.
        number: Subscript of the symbol.
        group: Plural noun for coordinates of this kind: "angles", "translations" or "quaternions".
    """

    name: str
    unit: Literal["rad", "m", "1"]
    symbol: str
    number: int
    group: str


@dataclass(frozen=True)
class SpeedKind:
    """One generalized speed that a joint may have.

    Attributes:
        name: Name within the body, such as "theta1" for the rate of that angle, or "omega1".
        symbol: Letter of the notes, spelled out: its symbol is `<symbol>_K_<number>`.
        derivative: Letter for the time derivative of the speed, spelled out like `symbol`.
        number: Subscript of both symbols.
        is_rate: Whether the speed is the time derivative of the coordinate at the same place of `FREEDOMS`.
    """

    name: str
    symbol: str
    derivative: str
    number: int
    is_rate: bool


QUATERNION = ("e0", "e1", "e2", "e3")
"""Names of the Euler parameters: a scalar and a vector in the joint frame, of any common length but 0."""

COORDINATE_KINDS = (
    *(CoordinateKind(FREEDOMS[i], "rad", "theta", i + 1, "angles") for i in ANGLES),
    *(CoordinateKind(FREEDOMS[i], "m", "s", i - 2, "translations") for i in TRANSLATIONS),
    *(CoordinateKind(name, "1", "epsilon", i, "quaternions") for i, name in enumerate(QUATERNION)),
)
"""Every coordinate that a joint may have: the six freedoms, then the Euler parameters."""

EULER_PARAMETERS = tuple(i for i, kind in enumerate(COORDINATE_KINDS) if kind.symbol == "epsilon")
"""Indices of the Euler parameters in `COORDINATE_KINDS`."""

SPEED_KINDS = (
    *(SpeedKind(FREEDOMS[i], "thetadot", "thetaddot", i + 1, True) for i in ANGLES),
    *(SpeedKind(FREEDOMS[i], "sdot", "sddot", i - 2, True) for i in TRANSLATIONS),
    *(SpeedKind(f"omega{i + 1}", "omegahat", "omegahatdot", i + 1, False) for i in ANGLES),
)
"""Every speed that a joint may have: the rates of the six freedoms, then the components of the relative
angular velocity {omega_hat'_K} in body K, Eq. (8), which stand at the places of the angles."""

ANGULAR_VELOCITY = tuple(i for i, kind in enumerate(SPEED_KINDS) if not kind.is_rate)
"""Indices of the components of the relative angular velocity in `SPEED_KINDS`."""


def selected_freedoms(flags: Iterable[bool]) -> tuple[str, ...]:
    """Return the names of those freedoms of `FREEDOMS` whose flags are set."""
    return tuple(name for name, flag in zip(FREEDOMS, flags, strict=True) if flag)


@dataclass(frozen=True)
class Freedom:
    """One of the six freedoms of a body.

    Attributes:
        body: Number of the body, from 1.
        index: Index in `FREEDOMS`.
    """

    body: int
    index: int

    @property
    def is_angle(self) -> bool:
        """Whether the freedom is an angle (rad) rather than a translation (m)."""
        return self.index in ANGLES

    @property
    def axis(self) -> int:
        """Place of the freedom among the three angles or the three translations: 0, 1 or 2."""
        return self.index % 3

    @property
    def unit(self) -> Literal["rad", "m"]:
        """Unit of the coordinate of the freedom: rad or m."""
        return "rad" if self.is_angle else "m"

    @property
    def effort(self) -> Literal["N m", "N"]:
        """Unit of the generalized force on the freedom."""
        return "N m" if self.is_angle else "N"


@dataclass(frozen=True)
class Coordinate:
    """One element of {x}.

    Attributes:
        body: Number of the body, from 1.
        index: Index in `COORDINATE_KINDS`.
    """

    body: int
    index: int

    @property
    def kind(self) -> CoordinateKind:
        """Name, unit and symbol of the coordinate."""
        return COORDINATE_KINDS[self.index]

    @property
    def name(self) -> str:
        """Name of the coordinate, without that of the body."""
        return self.kind.name

    @property
    def unit(self) -> Literal["rad", "m", "1"]:
        """Unit of the coordinate: rad, m or 1."""
        return self.kind.unit

    @property
    def is_angle(self) -> bool:
        """Whether the coordinate is an angle (rad)."""
        return self.index in ANGLES

    @property
    def is_translation(self) -> bool:
        """Whether the coordinate is a translation (m)."""
        return self.index in TRANSLATIONS


@dataclass(frozen=True)
class Speed:
    """One element of {y}.

    Attributes:
        body: Number of the body, from 1.
        index: Index in `SPEED_KINDS`.
    """

    body: int
    index: int

    @property
    def kind(self) -> SpeedKind:
        """Name and symbols of the speed."""
        return SPEED_KINDS[self.index]


SPEEDS = ("angle_rates", "angular_velocity")
"""Choices of `Joint.speeds`: rates of the angles, or components of the relative angular velocity."""

ORIENTATIONS = ("angles", "quaternion")
"""Choices of `Joint.coordinates`: three angles, or the four elements of a quaternion."""

Axes = tuple[int, int, int]
"""Basis vectors 0, 1, 2 about which theta1, theta2, theta3 turn."""

NOTES = "1-2-3"
"""The sequence of axes in the notes, Eq. (4)."""

SEQUENCES: dict[str, Axes] = {
    f"{a + 1}-{b + 1}-{c + 1}": (a, b, c) for a, b, c in product(range(3), repeat=3) if a != b != c
}
"""The twelve sequences of axes by name."""


@dataclass(frozen=True)
class AxisRotations:
    """Three successive rotations about basis vectors, by the angles theta1, theta2, theta3.

    Attributes:
        axes: Basis vector of each rotation, from 0: the first in the joint frame, the last in body K.
    """

    axes: Axes
    coordinates: ClassVar[tuple[int, ...]] = ANGLES
    """Indices of the angles in `COORDINATE_KINDS`."""

    neutral: ClassVar[tuple[float, ...]] = (0.0, 0.0, 0.0)
    """Angles of the orientation that is not turned."""

    def angles(self, values: Sequence[float]) -> Triple:
        """Return the three angles (rad) of an orientation: its coordinates themselves."""
        one, two, three = values
        return one, two, three

    @property
    def is_proper_euler(self) -> bool:
        """Whether the last axis is the first, as in 3-1-3."""
        return self.axes[0] == self.axes[2]

    @property
    def gimbal_lock(self) -> Literal["sin", "cos"]:
        """The function of theta2 that vanishes where the three axes lie in a plane."""
        return "sin" if self.is_proper_euler else "cos"


@dataclass(frozen=True)
class QuaternionRotation:
    """One rotation by Euler parameters e0, e1, e2, e3, a scalar and a vector of any common length but 0."""

    coordinates: ClassVar[tuple[int, ...]] = EULER_PARAMETERS
    """Indices of the elements in `COORDINATE_KINDS`."""

    neutral: ClassVar[tuple[float, ...]] = (1.0, 0.0, 0.0, 0.0)
    """Euler parameters of the orientation that is not turned."""

    gimbal_lock: ClassVar[None] = None
    """A quaternion is regular in every orientation."""

    def angles(self, values: Sequence[float]) -> Triple:
        """Return the 1-2-3 angles (rad) of an orientation by four Euler parameters, not all of them zero."""
        e0, e1, e2, e3 = values
        return angles_123(transpose(rotation_quaternion(e1, e2, e3, e0)))


Rotation = AxisRotations | QuaternionRotation
"""The ways in which the orientation of a body follows from its coordinates."""


def rotation_of(coordinates: str, sequence: str) -> Rotation:
    """Return the rotation for one of `ORIENTATIONS` and, for angles, one of `SEQUENCES`."""
    return QuaternionRotation() if coordinates == "quaternion" else AxisRotations(SEQUENCES[sequence])


def check_sequence(name: object) -> None:
    """Make sure that `name` is one of the twelve `SEQUENCES`.

    Raises:
        ModelError: If `name` is none of them.
    """
    if not isinstance(name, str) or name not in SEQUENCES:
        raise ModelError(
            f"joint sequence: {quoted(name)} is none of the twelve. {did_you_mean(name, SEQUENCES)}"
        )
