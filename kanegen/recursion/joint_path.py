"""The path through a joint, element by element, along which wrenches pass inward and accelerations outward.

A turn changes the frame of both, a shift their origin, and at a free component the joint adds its own
acceleration. Three free translations transmit no force but their efforts, and no acceleration. Both solvers
of [A]{ydot} = {b} follow this path, so that the wrenches for a solution follow from its free components
alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from sympy import Add, Expr, S

from kanegen.recursion.joint_motion import FreedomMotion, JointMotion
from kanegen.recursion.tree import Tree
from kanegen.recursion.turns import Turn
from kanegen.recursion.vectors import ZERO, Wrench, add, cross
from kanegen.symbolic.definitions import Definitions, Vector

GROUND_ACCELERATION = (S.Zero,) * 6
"""Angular acceleration of the ground and acceleration of its origin: zeros."""

ROTATIONS, TRANSLATIONS = (0, 1, 2), (3, 4, 5)
"""Indices of a six-vector of angular acceleration and acceleration of the origin."""


@dataclass(frozen=True)
class FreeComponent:
    """A component of the acceleration that the joint leaves free.

    Attributes:
        index: One of `ROTATIONS` or `TRANSLATIONS`.
        freedom: Number of the freedom among those that move, its place in {y} where it is not coupled.
        shares: Factors by place in {y}: by how much each entry of {ydot} accelerates along the component.
        is_coupled: Whether the freedom is coupled, or a coupled freedom follows it.
        is_absolute: Whether it is the whole component of the acceleration of the body, instead of what the
            joint adds to that of the lower body.
        armature: Reflected inertia of its motor and rotors, with twice `momentum` along the component where a
            rotor is carried by the body of the joint (kg m^2, kg); zero where the component is absolute.
        momentum: Angular momentum of its rotors for unit rate, in the frame of the component.
    """

    index: int
    freedom: int
    shares: Mapping[int, Expr]
    is_coupled: bool = False
    is_absolute: bool = False
    armature: Expr = S.Zero
    momentum: Vector = ZERO

    def acceleration(self, components: Sequence[Expr] | Mapping[int, Expr]) -> Expr:
        """Return the acceleration along the component, from the free components by place in {y}."""
        return Add(*(share * components[i] for i, share in self.shares.items()))


@dataclass(frozen=True)
class FrameChange:
    """A change of frame on the path.

    Attributes:
        turn: Turn between the two frames.
        name: Name of the lower frame.
    """

    turn: Turn
    name: str

    def inward(self, wrench: Wrench, definitions: Definitions) -> Wrench:
        """Return a wrench in components of the lower frame."""
        return Wrench(self.turn.down(wrench.force), self.turn.down(wrench.moment)).named(
            self.name, definitions
        )

    def outward(self, a: tuple[Expr, ...], definitions: Definitions) -> tuple[Expr, ...]:
        """Return accelerations in components of the upper frame."""
        angular = definitions.vector(f"qw_{self.name}u", self.turn.up(Vector(*a[:3])))
        return (*angular, *definitions.vector(f"qa_{self.name}u", self.turn.up(Vector(*a[3:]))))


@dataclass(frozen=True)
class OriginChange:
    """A change of origin on the path.

    Attributes:
        offset: Vector from the lower body's origin to the upper body's, in the lower body's frame (m).
        name: Name of the lower origin.
    """

    offset: Vector
    name: str

    def inward(self, wrench: Wrench, definitions: Definitions) -> Wrench:
        """Return a wrench about the lower body's origin."""
        moment = add(wrench.moment, cross(self.offset, wrench.force))
        return Wrench(wrench.force, moment).named(self.name, definitions)

    def outward(self, a: tuple[Expr, ...], definitions: Definitions) -> tuple[Expr, ...]:
        """Return angular acceleration, and acceleration of the upper body's origin."""
        moved = add(Vector(*a[3:]), cross(Vector(*a[:3]), self.offset))
        return (*a[:3], *definitions.vector(f"qa_{self.name}", moved))


@dataclass(frozen=True)
class FreeTranslations:
    """The three free translations of a joint, in the joint frame.

    Attributes:
        freedoms: Places of the freedoms in {y}.
    """

    freedoms: tuple[int, int, int]

    def inward(self, wrench: Wrench, efforts: Sequence[Expr]) -> Wrench:
        """Return a wrench whose force is that of the efforts, by freedom: nothing else is transmitted."""
        return Wrench(Vector(*(efforts[freedom] for freedom in self.freedoms)), wrench.moment)

    def outward(self, a: tuple[Expr, ...], definitions: Definitions) -> tuple[Expr, ...]:
        """Return accelerations without that of the origin."""
        del definitions
        return (*a[:3], *ZERO)


@dataclass(frozen=True)
class SharedRate:
    """The place on the path from which on all freedoms are outward that an entry of {y} moves by couplings.

    Attributes:
        place: Place of the entry in {y}.
    """

    place: int

    def outward(self, a: tuple[Expr, ...], definitions: Definitions) -> tuple[Expr, ...]:
        """Return the same accelerations."""
        del definitions
        return a


PathElement = FreeComponent | FrameChange | OriginChange | FreeTranslations | SharedRate


def joint_path(joint: JointMotion, *, together: bool) -> tuple[PathElement, ...]:
    """Return the path from body K inward to its lower body.

    Args:
        joint: The joint of K.
        together: Whether three free angles, or three free translations, become absolute free components along
            the axes of K. Those of angles are then regular at gimbal lock, unlike their second derivatives.
    """
    return tuple(_elements(joint, together))


def shared_rates(tree: Tree) -> dict[int, list[int]]:
    """Return the entries of {y} that move several freedoms, by the outermost body that carries all of these.

    Returns:
        Places in {y} by number of the body; 0 for the ground.
    """
    carrier: dict[int, int] = {}
    for joint in reversed(tree.joints):
        for one in joint.freedoms:
            for place in one.shares if one.is_coupled else ():
                carrier[place] = _common_carrier(tree, carrier.get(place, joint.body), joint.body)
    found: dict[int, list[int]] = {}
    for place, body in carrier.items():
        found.setdefault(body, []).append(place)
    return found


def _common_carrier(tree: Tree, a: int, b: int) -> int:
    """Return the outermost body that carries two bodies; a body carries itself."""
    while a != b:
        # A lower body has the lower number.
        a, b = min(a, b), tree.joints[max(a, b) - 1].lower
    return a


def with_shared_rates(path: tuple[PathElement, ...], places: Iterable[int]) -> tuple[PathElement, ...]:
    """Return the path of a joint with entries of {y} solved for where their freedoms are all outward.

    Args:
        path: The path.
        places: Places in {y} of the entries whose freedoms the body of the joint carries.
    """
    result = list(path)
    for place in places:
        own = [i for i, one in enumerate(result) if isinstance(one, FreeComponent) and place in one.shares]
        result.insert(own[-1] + 1 if own else 0, SharedRate(place))
    return tuple(result)


def released(tree: Tree, *, together: bool) -> frozenset[int]:
    """Return the freedoms of all joints whose translations, or rotations, are all free and solved for as one.

    Args:
        tree: The tree.
        together: As for `joint_path`.
    """
    found: set[int] = set()
    for joint in tree.joints:
        if joint.translates_freely:
            found.update(one.freedom for one in joint.translations)
        if joint.turns_freely or (together and joint.rotates_freely):
            found.update(joint.rotations)
    return frozenset(found)


def _elements(joint: JointMotion, together: bool) -> Iterator[PathElement]:
    """Yield the elements of `joint_path`."""
    all_translations = together and joint.translates_freely
    all_angles = together and joint.rotates_freely
    if all_translations:
        for index, translation in zip(TRANSLATIONS, joint.translations, strict=True):
            yield _component(index, translation, is_absolute=True)
        if joint.to_center != ZERO:
            yield OriginChange(joint.to_center, f"{joint.body}o")
    for speed in joint.angular_speeds:
        yield _component(speed.axis, speed, is_absolute=together and joint.turns_freely)
    if all_angles:
        for index, step in zip(ROTATIONS, joint.angles, strict=True):
            yield _component(index, step, is_absolute=True)
    for step in reversed(joint.angles):
        if step.shares and not all_angles:
            yield _component(step.axis, step)
        yield FrameChange(step.turn, step.frame)
    if all_translations:
        one, two, three = (translation.freedom for translation in joint.translations)
        yield FreeTranslations((one, two, three))
    else:
        for translation in joint.translations:
            yield _component(3 + translation.axis, translation)
    for step in reversed(joint.constant):
        yield FrameChange(step.turn, step.frame)
    yield OriginChange(joint.offset, f"{joint.body}j")


def _component(index: int, motion: FreedomMotion, *, is_absolute: bool = False) -> FreeComponent:
    """Return the component of an acceleration that a freedom leaves free."""
    armature = S.Zero if is_absolute else motion.armature
    return FreeComponent(index, motion.number, motion.shares, motion.is_coupled, is_absolute, armature)
