"""The kinds of force elements: springs, drives, loads on points, potentials.

Force elements refer to freedoms and points by name; `names.with_resolved_names` looks the names up when a
system is made.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from kanegen.errors import ModelError, quoted
from kanegen.model import validation
from kanegen.model.expression import Expression, node_of
from kanegen.model.force_elements.element import ForceElement
from kanegen.model.grammar import parse
from kanegen.model.nodes import Operation, Variable
from kanegen.model.numbers import Number, Vector, described, number, numbers, value_of

End = str | Vector
"""End of a spring: the name of a point, or a place fixed in the ground, in inertial components (m)."""


@dataclass(frozen=True)
class JointSpring(ForceElement):
    """A spring and a damper on one freedom: effort -stiffness (x - rest) - damping xdot.

    Attributes:
        freedom: Name of the freedom.
        stiffness: Stiffness (N m/rad or N/m).
        rest: Coordinate at which the spring exerts no effort (rad, m).
        damping: Damping coefficient (N m s/rad or N s/m).

    Raises:
        ModelError: If stiffness and damping are both zero, or a value is no number.

    Example:
        kg.JointSpring("elbow.theta3", stiffness=40.0, damping=0.5)
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
class JointFriction(ForceElement):
    """Coulomb friction on one freedom, smoothed about standstill: effort -friction tanh(y / smoothing).

    Dry friction jumps when the motion changes its direction. Here the effort is 76 % of the friction at the
    rate `smoothing`, and 99.5 % at three times this rate; about standstill it is the viscous effort
    -(friction / smoothing) y. So a joint under load creeps instead of sticking, and a small `smoothing` makes
    the equations stiff: steps of explicit integration must be shorter than about the inertia of the freedom
    times smoothing / friction.

    Attributes:
        freedom: Name of the speed at which the friction does work.
        friction: Magnitude of the effort far from standstill (N m or N).
        smoothing: Rate y within which the friction is smoothed (rad/s or m/s).

    Raises:
        ModelError: If the friction is negative, the smoothing is not positive, or a value is no number.

    Example:
        kg.JointFriction("elbow.theta3", friction=1.5, smoothing=0.01)
    """

    KEY: ClassVar[str] = "joint_friction"

    freedom: str
    friction: Number
    smoothing: Number

    def __post_init__(self) -> None:
        validation.store(self, freedom=_name(self.freedom, "joint_friction freedom"))
        for name in ("friction", "smoothing"):
            validation.store(self, **{name: number(getattr(self, name), f"joint_friction {name}")})
        if value_of(self.friction) < 0:
            raise ModelError(f"joint_friction: the friction {described(self.friction)} is negative.")
        if value_of(self.smoothing) <= 0:
            raise ModelError(
                f"joint_friction: the smoothing {described(self.smoothing)} is not positive. Give a "
                "rate within which the friction may be smaller, such as 0.01 (rad/s or m/s)."
            )

    @property
    def effort(self) -> Expression:
        """The effort as an expression of the speed."""
        share = Operation("/", (Variable(f"y.{self.freedom}"), node_of(self.smoothing)))
        friction = Operation("*", (node_of(self.friction), Operation("tanh", (share,))))
        return Expression(Operation("negate", (friction,)))


@dataclass(frozen=True)
class Spring(ForceElement):
    """A spring and a damper between two points, with the pull stiffness (l - rest_length) + damping ldot.

    The distance of the points is l. Without a rest length the force is the stiffness times the vector between
    the points, and is defined where they meet; with a rest length or damping its direction is undefined.

    Attributes:
        between: The two ends.
        stiffness: Stiffness (N/m).
        rest_length: Length at which the spring exerts no force (m).
        damping: Damping coefficient (N s/m).

    Raises:
        ModelError: If both ends are the same, stiffness and damping are both zero, or a value is not usable.

    Example:
        kg.Spring(("hook", (0.0, 0.0, 2.0)), stiffness=900.0, rest_length=0.5)
    """

    KEY: ClassVar[str] = "spring"

    between: tuple[End, End]
    stiffness: Number = 0.0
    rest_length: Number = 0.0
    damping: Number = 0.0

    @property
    def may_be_undefined(self) -> bool:
        """Whether the direction between the ends matters, which is undefined where they meet."""
        return self.rest_length != 0.0 or self.damping != 0.0

    def without_length(self, number: int) -> ModelError:
        """Return the error that refuses a spring whose ends are at one place in every state.

        Args:
            number: Number of the spring in its system, from 1.
        """
        one, two = (quoted(end) if isinstance(end, str) else "the ground" for end in self.between)
        return ModelError(
            f"spring {number} between {one} and {two}: its ends are at the same place in every state, so "
            "that it has no direction. Move one end, or leave the spring out."
        )

    def __post_init__(self) -> None:
        ends = validation.sequence(self.between, 2, "spring between")
        ends = [end if isinstance(end, str) else numbers(end, (3,), "spring between") for end in ends]
        validation.store(self, between=tuple(ends))
        if ends[0] == ends[1]:
            raise ModelError(
                f"spring between {quoted(ends[0])} and itself: it would do nothing. Name two points."
            )
        _check_spring(self, "rest_length")
        if value_of(self.rest_length) < 0:
            raise ModelError(f"spring rest_length: {described(self.rest_length)} m is negative.")


@dataclass(frozen=True)
class Drive(ForceElement):
    """An effort on one freedom, as an expression.

    Attributes:
        freedom: Name of the speed at which the effort does work.
        effort: Effort (N m or N), an expression of {x}, {y}, t and parameters.

    Raises:
        ModelError: If the effort is no expression.

    Example:
        kg.Drive("wheel.theta3", "2*sin(t) - 0.1*y.wheel.theta3")
    """

    KEY: ClassVar[str] = "drive"
    EXPRESSION_FIELDS: ClassVar[tuple[str, ...]] = ("effort",)

    freedom: str
    effort: Expression

    def __post_init__(self) -> None:
        validation.store(self, freedom=_name(self.freedom, "drive freedom"), effort=parse(self.effort))


@dataclass(frozen=True)
class PointLoad(ForceElement):
    """A force and a moment on the body of a point, as expressions.

    The components are inertial, or those of a frame that moves with the body, as of the thrust of a rotor.

    Attributes:
        point: Name of the point.
        force: (3,) force that acts at the point (N), expressions of {x}, {y}, t and parameters.
        moment: (3,) moment on the body of the point (N m), expressions of the same variables.
        frame: Name of the frame of the components, one of the body of the point; "" for inertial components.

    Raises:
        ModelError: If a component is no expression, or there are not three, or the frame is no name.

    Example:
        kg.PointLoad("tip", force=("0", "0", "10*sin(t)"))
        kg.PointLoad("rotor", force=(0, 0, kg.parse("u", [kg.Parameter("u", 5.0)])), frame="rotor")
    """

    KEY: ClassVar[str] = "point_load"
    EXPRESSION_FIELDS: ClassVar[tuple[str, ...]] = ("force", "moment")

    point: str
    force: tuple[Expression, Expression, Expression] = (parse(0),) * 3
    moment: tuple[Expression, Expression, Expression] = (parse(0),) * 3
    frame: str = ""

    def __post_init__(self) -> None:
        validation.store(self, point=_name(self.point, "point_load point"))
        validation.store(self, frame=_name(self.frame, "point_load frame"))
        for name in ("force", "moment"):
            components = validation.sequence(getattr(self, name), 3, f"point_load {name}")
            validation.store(self, **{name: tuple(parse(component) for component in components)})


@dataclass(frozen=True)
class Potential(ForceElement):
    """A potential energy, whose negative gradient acts on the freedoms.

    Attributes:
        energy: Energy (J), an expression of {x} and parameters.

    Raises:
        ModelError: If the energy depends on speeds or the time.

    Example:
        kg.Potential("0.5*k*x.slider.s1**2")
    """

    KEY: ClassVar[str] = "potential"
    EXPRESSION_FIELDS: ClassVar[tuple[str, ...]] = ("energy",)

    energy: Expression

    def __post_init__(self) -> None:
        validation.store(self, energy=parse(self.energy))
        for name in self.energy.variables:
            if not name.startswith("x."):
                raise ModelError(
                    f"potential energy {quoted(str(self.energy))} depends on {quoted(name)}. It may depend "
                    "on coordinates x and parameters; forces of anything else are drives and point loads."
                )


KINDS: tuple[type[ForceElement], ...] = (JointSpring, JointFriction, Spring, Drive, PointLoad, Potential)
"""Every kind of force element, in the order of a model file."""


def _check_spring(spring: JointSpring | Spring, rest: str) -> None:
    """Check and store the numbers of a spring; `rest` is the field of its rest position."""
    for name in ("stiffness", rest, "damping"):
        validation.store(spring, **{name: number(getattr(spring, name), f"{spring.KEY} {name}")})
    if spring.stiffness == 0 and spring.damping == 0:
        raise ModelError(f"{spring.KEY} without stiffness and damping: give one of them.")


def _name(value: object, label: str) -> str:
    """Return `value` if it is a string that names a freedom or a point."""
    if not isinstance(value, str):
        raise ModelError(f"{label}: {quoted(value)} is not a name.")
    return value
