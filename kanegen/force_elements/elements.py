"""Force elements: what acts on the bodies beside gravity, inertia and what a caller passes.

Freedoms and points go by their names; `names.resolved` looks them up when a system is made.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar, Self

from kanegen import validation
from kanegen.errors import ModelError
from kanegen.force_elements.expression import Constant, Expression
from kanegen.force_elements.grammar import parse
from kanegen.numbers import Number, Vector, map_numbers, number, numbers, value_of, word

End = str | Vector
"""Where a spring is fixed: the name of a point, or a place of the ground, inertial components (m)."""

Change = Callable[[Number], Number]


@dataclass(frozen=True)
class ForceElement:
    """What every kind of force element can do.

    Attributes:
        KEY: Its array of tables in a model file.
    """

    KEY: ClassVar[str]

    def changed(self, change: Change) -> Self:
        """The same with `change` applied to every number."""
        return replace(self, **{f.name: _changed(getattr(self, f.name), change) for f in fields(self)})

    def renamed(self, rename: Callable[[str], str]) -> Self:
        """The same with other names of freedoms, and of coordinates and speeds in expressions."""
        return replace(self, **{f.name: _renamed(getattr(self, f.name), rename) for f in fields(self)})

    def numbers(self) -> Iterator[Number]:
        """Its numbers, those of expressions included."""
        found: list[Number] = []

        def collect(value: Number) -> Number:
            found.append(value)
            return value

        self.changed(collect)
        yield from found

    def expressions(self) -> Iterator[Expression]:
        """What it holds of them."""
        for f in fields(self):
            yield from _expressions(getattr(self, f.name))

    @property
    def words(self) -> str:
        """In a line, for readers of generated code."""
        return f"{self.KEY}: {', '.join(f'{key} = {_line(value)}' for key, value in self.as_table().items())}"

    def as_table(self) -> dict[str, Any]:
        """In the words of a model file, defaults left out."""
        every = {f.name: getattr(self, f.name) for f in fields(self)}
        defaults = {f.name: f.default for f in fields(self)}
        return {name: _word(value) for name, value in every.items() if value != defaults[name]}


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

    freedom: str
    effort: Expression

    def __post_init__(self) -> None:
        validation.store(self, freedom=_text(self.freedom, "drive freedom"), effort=parse(self.effort))


@dataclass(frozen=True)
class PointLoad(ForceElement):
    """A force and a moment on the body of a point, inertial components.

    Attributes:
        point: Its name.
        force: Acting there (N); of {x}, {y}, t and parameters.
        moment: N m, likewise.
    """

    KEY: ClassVar[str] = "point_load"

    point: str
    force: tuple[Expression, Expression, Expression] = (parse(0),) * 3
    moment: tuple[Expression, Expression, Expression] = (parse(0),) * 3

    def __post_init__(self) -> None:
        validation.store(self, point=_text(self.point, "point_load point"))
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
    kind = spring.KEY
    for name in ("stiffness", rest, "damping"):
        validation.store(spring, **{name: number(getattr(spring, name), f"{kind} {name}")})
    if isinstance(spring, JointSpring):
        _text(spring.freedom, f"{kind} freedom")
    if spring.stiffness == 0 and spring.damping == 0:
        raise ModelError(f"{kind} without stiffness and damping: give one of them.")


def _text(value: object, what: str) -> str:
    if not isinstance(value, str):
        raise ModelError(f"{what}: {value!r} is not a name.")
    return value


def _changed(value: Any, change: Change) -> Any:
    if isinstance(value, str):
        return value
    if isinstance(value, Expression):
        return value.changed(change)
    return tuple(_changed(item, change) for item in value) if isinstance(value, tuple) else change(value)


def _renamed(value: Any, rename: Callable[[str], str]) -> Any:
    if isinstance(value, Expression):
        return value.renamed(rename)
    if isinstance(value, tuple):
        return tuple(_renamed(item, rename) for item in value)
    return value


def _expressions(value: Any) -> Iterator[Expression]:
    if isinstance(value, Expression):
        yield value
    elif isinstance(value, tuple):
        for item in value:
            yield from _expressions(item)


def _line(value: Any) -> str:
    if isinstance(value, tuple):
        return f"({', '.join(map(_line, value))})"
    return value if isinstance(value, str) else repr(value)


def _word(value: Any) -> Any:
    if isinstance(value, Expression):
        root = value.root
        return word(root.value) if isinstance(root, Constant) else str(value)
    if isinstance(value, tuple):
        return tuple(_word(item) for item in value)
    return value if isinstance(value, str) else map_numbers(value, word)
