"""Maps between rates of angles and components of angular velocities, for joints with three free angles.

Next to gimbal lock [A] of rates of angles is nearly singular, that of angular velocities is not. With {omega}
= [P]{y} for the joint, Eq. (8), {tau} = [P]^T {T} for the torque {T} of the generalized forces, and the
accelerations {ydot} = [P]^-1 ({alpha} - [dP/dt]{y}). Freedoms of other joints stay as they are.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from sympy import Expr

from kanegen.model.system import System
from kanegen.recursion.coordinate_rates import AngleRates, angle_rates
from kanegen.recursion.tree import Derived, Tree
from kanegen.symbolic.definitions import Vector
from kanegen.symbolic.state_symbols import NOTES
from kanegen.symbolic.symbols import generalized_force


def angular_speeds(tree: Tree) -> Derived:
    """Derive {y} with [P]{y} of each joint with three free angles in place of the rates of these."""
    result: list[Expr] = list(NOTES.speeds(tree.system))
    for places, found in _maps(tree, "relative angular velocity, Eq. (8)"):
        omega = found.angular(_three(result, places))
        _replace(result, places, found.definitions.vector(f"omegar_{found.body}", omega))
    return Derived(result)


def torques(tree: Tree) -> Derived:
    """Derive {tau} with the torque of each joint with three free angles in place of their forces."""
    return Derived(
        with_torques(tree, [generalized_force(one.body, one.index) for one in tree.system.freedoms])
    )


def with_torques(tree: Tree, efforts: Sequence[Expr]) -> list[Expr]:
    """Return efforts with the torque of each joint with three free angles in place of their efforts.

    Args:
        tree: The tree.
        efforts: Generalized forces by place in {y}.
    """
    result = list(efforts)
    for places, found in _maps(tree, "efforts in the body, Eq. (9)"):
        _replace(result, places, found.torque(_three(result, places)))
    return result


def angle_accelerations(tree: Tree) -> Derived:
    """Derive {ydot} with [P]^-1 times three entries of each joint with three free angles in their places."""
    result: list[Expr] = list(NOTES.accelerations(tree.system))
    for places, found in _maps(tree, "{ydot} of the joint, Eq. (9)"):
        one, two, three = (f"ydot_{place}" for place in places)
        _replace(result, places, found.rates(Vector(*_three(result, places)), (one, two, three)))
    return Derived(result)


def places_of_angles(system: System) -> tuple[tuple[int, int], ...]:
    """Return the places in {x} and in {y} of the angles whose rates `angular_speeds` replaces."""
    coordinates = {(one.body, one.index): place for one, place in system.coordinate_places.items()}
    return tuple(
        (coordinates[one.body, one.index], place)
        for place, one in enumerate(system.freedoms)
        if one.is_angle and system.bodies[one.body - 1].joint.has_free_orientation
        if system.bodies[one.body - 1].joint.speeds_are_rates
    )


def _maps(tree: Tree, topic: str) -> Iterator[tuple[Sequence[int], AngleRates]]:
    """Yield the places in {y} and the maps of the joints that are solved in components."""
    for joint in tree.joints:
        if joint.rotates_freely:
            tree.about(joint.body, topic)
            yield [step.freedom for step in joint.angles], angle_rates(joint, tree.definitions)


def _three(entries: Sequence[Expr], places: Sequence[int]) -> tuple[Expr, Expr, Expr]:
    """Return the entries at three places."""
    one, two, three = (entries[place] for place in places)
    return one, two, three


def _replace(entries: list[Expr], places: Sequence[int], values: Sequence[Expr]) -> None:
    """Replace the entries at three places by values."""
    for place, value in zip(places, values, strict=True):
        entries[place] = value
