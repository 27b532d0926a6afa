"""The kinds of force elements: springs, drives, loads on points, potentials.

Freedoms and points go by their names; `names.resolved` looks them up when a system is made.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from kanegen.errors import ModelError
from kanegen.model import validation
from kanegen.model.force_elements.element import ForceElement
from kanegen.model.force_elements.expression import Expression
from kanegen.model.force_elements.grammar import parse
from kanegen.model.numbers import Number, Vector, number, numbers, value_of

End = str | Vector
"""Where a spring is fixed: the name of a point, or a place of the ground, inertial components (m)."""


@dataclass(frozen=True)
class JointSpring(ForceElement):
    """A spring and a damper on one freedom: effort -stiffness (x - rest) - damping xdot.

    Attributes:
        freedom: Its name.
        stiffness: N m/rad or N/m.
        rest: Where the spring is free (rad, m).
        damping: N m s/rad or N s/m.
    """

    KEY: ClassVar[str] = "joint_spring"

    freedom: str
    stiffness: Number = 0.0
    rest: Number = 0.0
    damping: Number = 0.0

    def __post_init__(self) -> None:
        validation.store(self, freedom=_name(self.freedom, "joint_spring freedom"))
        _check_spring(self, "rest")


@dataclass(frozen=True)
class Spring(ForceElement):
    """A spring and a damper between two points: they pull with stiffness (l - rest_length) + damping ldot.

    Without a rest length the force is stiffness times the way between the points, also where they meet;
    with one, or with damping, it has no direction there.

    Attributes:
        between: Its two ends.
        stiffness: N/m.
        rest_length: Where the spring is free (m).
        damping: N s/m.
    """

    KEY: ClassVar[str] = "spring"

    between: tuple[End, End]
    stiffness: Number = 0.0
    rest_length: Number = 0.0
    damping: Number = 0.0

    def __post_init__(self) -> None:
        ends = validation.sequence(self.between, 2, "spring between")
        ends = [end if isinstance(end, str) else numbers(end, (3,), "spring between") for end in ends]
        validation.store(self, between=tuple(ends))
        if ends[0] == ends[1]:
            raise ModelError(f"spring between {ends[0]!r} and itself: it would do nothing. Name two points.")
        _check_spring(self, "rest_length")
        if value_of(self.rest_length) < 0:
            raise ModelError(f"spring rest_length: {value_of(self.rest_length)!r} m is negative.")


@dataclass(frozen=True)
class Drive(ForceElement):
    """An effort on one freedom.

    Attributes:
        freedom: Name of its speed.
        effort: N m or N; of {x}, {y}, t and parameters.
    """

    KEY: ClassVar[str] = "drive"
    EXPRESSION_FIELDS: ClassVar[tuple[str, ...]] = ("effort",)

    freedom: str
    effort: Expression

    def __post_init__(self) -> None:
        validation.store(self, freedom=_name(self.freedom, "drive freedom"), effort=parse(self.effort))


@dataclass(frozen=True)
class PointLoad(ForceElement):
    """A force and a moment on the body of a point, inertial components.

    Attributes:
        point: Its name.
        force: Acting there (N); of {x}, {y}, t and parameters.
        moment: N m, likewise.
    """

    KEY: ClassVar[str] = "point_load"
    EXPRESSION_FIELDS: ClassVar[tuple[str, ...]] = ("force", "moment")

    point: str
    force: tuple[Expression, Expression, Expression] = (parse(0),) * 3
    moment: tuple[Expression, Expression, Expression] = (parse(0),) * 3

    def __post_init__(self) -> None:
        validation.store(self, point=_name(self.point, "point_load point"))
        for name in ("force", "moment"):
            components = validation.sequence(getattr(self, name), 3, f"point_load {name}")
            validation.store(self, **{name: tuple(parse(component) for component in components)})


@dataclass(frozen=True)
class Potential(ForceElement):
    """A potential energy, whose negative gradient acts on the freedoms.

    Attributes:
        energy: J; of {x} and parameters.
    """

    KEY: ClassVar[str] = "potential"
    EXPRESSION_FIELDS: ClassVar[tuple[str, ...]] = ("energy",)

    energy: Expression

    def __post_init__(self) -> None:
        validation.store(self, energy=parse(self.energy))
        for name in self.energy.variables:
            if not name.startswith("x."):
                raise ModelError(
                    f"potential energy {str(self.energy)!r} depends on {name!r}. It may depend on "
                    "coordinates x and parameters; forces of anything else are drives and point loads."
                )


KINDS: tuple[type[ForceElement], ...] = (JointSpring, Spring, Drive, PointLoad, Potential)
"""Every kind, in the order of a model file."""


def _check_spring(spring: JointSpring | Spring, rest: str) -> None:
    for name in ("stiffness", rest, "damping"):
        validation.store(spring, **{name: number(getattr(spring, name), f"{spring.KEY} {name}")})
    if spring.stiffness == 0 and spring.damping == 0:
        raise ModelError(f"{spring.KEY} without stiffness and damping: give one of them.")


def _name(value: object, what: str) -> str:
    if not isinstance(value, str):
        raise ModelError(f"{what}: {value!r} is not a name.")
    return value
