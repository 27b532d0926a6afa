"""Lengths of joints and fixed tendons of a compiled MJCF model: linear functions of the coordinates.

The force of a spring, a damper or an actuator along a length acts on each freedom with its coefficient in the
rate of the length.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from kanegen.readers.mjcf_compiled import JOINT_TYPES, Compiled
from kanegen.readers.mjcf_tree import MjcfTree

Terms = tuple[tuple[float, str], ...]
"""Coefficients, none of them zero, each with the name of a coordinate or a speed."""


@dataclass(frozen=True)
class Length:
    """A length as a linear function of coordinates, with its rate; for a ball or free joint only the rate.

    Attributes:
        coordinates: Coefficients of coordinates (1, or m/rad); empty if the length is not linear.
        speeds: Coefficients of generalized speeds in the rate of the length.
    """

    coordinates: Terms
    speeds: Terms

    def scaled(self, factor: float) -> Length:
        """Return the same length in another unit or through a gear."""
        return Length(
            tuple((factor * coefficient, name) for coefficient, name in self.coordinates if factor),
            tuple((factor * coefficient, name) for coefficient, name in self.speeds if factor),
        )

    @property
    def value(self) -> Iterable[tuple[float, str]]:
        """Coefficients of the variables of expressions in the length."""
        return ((coefficient, f"x[{name!r}]") for coefficient, name in self.coordinates)

    @property
    def rate(self) -> Iterable[tuple[float, str]]:
        """Coefficients of the variables of expressions in the rate of the length."""
        return ((coefficient, f"y[{name!r}]") for coefficient, name in self.speeds)


def joint_length(model: Compiled, tree: MjcfTree, joint: int, gear: Iterable[float]) -> Length:
    """Return the length of an actuator at a joint.

    Args:
        model: The compiled model.
        tree: Its tree.
        joint: Number of the joint.
        gear: (6,) MuJoCo's gear, of which a slide or a hinge uses the first number, a ball the first three.
    """
    place, speed = int(model.model.jnt_qposadr[joint]), int(model.model.jnt_dofadr[joint])
    kind = JOINT_TYPES[int(model.model.jnt_type[joint])]
    count = {"free": 6, "ball": 3}.get(kind, 1)
    factors = [float(factor) for factor in gear][:count]
    speeds = zip(factors, tree.speeds[speed : speed + count], strict=True)
    coordinates = ((factors[0], tree.coordinates[place]),) if count == 1 and factors[0] else ()
    return Length(coordinates, tuple((factor, name) for factor, name in speeds if factor))


def tendon_length(model: Compiled, tree: MjcfTree, tendon: int) -> Length | None:
    """Return the length of a fixed tendon, or None if the tendon runs through points in space."""
    first = int(model.model.tendon_adr[tendon])
    wraps = range(first, first + int(model.model.tendon_num[tendon]))
    is_joint = int(model.mujoco.mjtWrap.mjWRAP_JOINT)
    if any(int(model.model.wrap_type[wrap]) != is_joint for wrap in wraps):
        return None
    coordinates: dict[str, float] = {}
    speeds: dict[str, float] = {}
    for wrap in wraps:
        joint, factor = int(model.model.wrap_objid[wrap]), float(model.model.wrap_prm[wrap])
        coordinate = tree.coordinates[int(model.model.jnt_qposadr[joint])]
        speed = tree.speeds[int(model.model.jnt_dofadr[joint])]
        coordinates[coordinate] = coordinates.get(coordinate, 0.0) + factor
        speeds[speed] = speeds.get(speed, 0.0) + factor
    return Length(_terms(coordinates), _terms(speeds))


def sum_of(terms: Iterable[tuple[float, str]]) -> str:
    """Return the text of a sum of products for an expression; terms with the factor zero are left out.

    The text of a product may be empty, which makes its term a number.
    """
    return " + ".join(_product(factor, text) for factor, text in terms if factor) or "0"


def _product(factor: float, text: str) -> str:
    """Return the text of a number times a product."""
    if not text:
        return repr(factor)
    return text if factor == 1 else f"{factor!r}*{text}"


def _terms(factors: dict[str, float]) -> Terms:
    """Return factors by name as terms, without those that are zero."""
    return tuple((factor, name) for name, factor in factors.items() if factor)
