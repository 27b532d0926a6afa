"""What force elements and loads on points do: efforts on freedoms, forces on bodies, and stored energy."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain

from sympy import Add, Expr

from kanegen.model.force_elements.elements import Drive, JointSpring, PointLoad, Potential
from kanegen.model.force_elements.names import Place, coordinate_places, speed_places
from kanegen.model.numbers import Number
from kanegen.recursion.joints import exact
from kanegen.recursion.springs import HALF, outward, ties
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import ZERO, add, cross, negate, subtract
from kanegen.symbolic.definitions import Vector
from kanegen.symbolic.expressions import ExpressionTranslator
from kanegen.symbolic.symbols import point_force, point_moment


@dataclass(frozen=True)
class Applied:
    """A force and a moment about the origin of a body, in its frame (N, N m)."""

    force: Vector = ZERO
    moment: Vector = ZERO


UNLOADED = Applied()


def efforts(tree: Tree) -> dict[Place, Expr]:
    """What joint springs, drives and potentials add to the generalized forces, locked freedoms included."""
    found: dict[Place, list[Expr]] = {}
    for place, effort in _efforts(tree):
        found.setdefault(place, []).append(effort)
    define = tree.definitions.define
    tree.definitions.about("Efforts of force elements")
    return {(k, index): define(f"fe_{k}_{index + 1}", Add(*parts)) for (k, index), parts in found.items()}


def _efforts(tree: Tree) -> Iterator[tuple[Place, Expr]]:
    """The same, element by element."""
    bodies, translator = tree.system.bodies, ExpressionTranslator(tree.system, exact)
    coordinates, speeds = coordinate_places(bodies), speed_places(bodies)
    for element in tree.system.force_elements:
        match element:
            case JointSpring(name, stiffness, rest, damping):
                pull = exact(stiffness) * (translator.coordinate(name) - exact(rest))
                yield coordinates[name], -pull - exact(damping) * translator.speed(name)
            case Drive(name, effort):
                yield speeds[name], translator.value(effort)
            case Potential(energy):
                for place, slope in translator.gradient(energy).items():
                    yield place, -slope


def applied(tree: Tree) -> dict[int, Applied]:
    """What springs and loads on points do to the bodies."""
    found: dict[int, Applied] = {}
    for k, load in chain(_pulls(tree), _loads(tree)):
        both = found.get(k, UNLOADED)
        found[k] = Applied(add(both.force, load.force), add(both.moment, load.moment))
    return found


def _pulls(tree: Tree) -> Iterator[tuple[int, Applied]]:
    """Of springs between points."""
    for tie in ties(tree):
        pull = tie.pull(tree.definitions)
        for k, position, force in zip(tie.bodies, tie.positions, (pull, negate(pull)), strict=True):
            if k:
                tree.about(k, f"force of spring {tie.number}")
                yield k, _at(tree, k, position, outward(tree, k, tie.frame, force, f"ks_{tie.number}"))


def _loads(tree: Tree) -> Iterator[tuple[int, Applied]]:
    """On points, by elements and by the caller."""
    places = {point.name: (k, point.position) for k, point in tree.system.points}
    translator = ExpressionTranslator(tree.system, exact)
    for number, element in enumerate(tree.system.force_elements, start=1):
        if isinstance(element, PointLoad):
            force, moment = (
                Vector(*map(translator.value, values)) for values in (element.force, element.moment)
            )
            yield _inertial(tree, *places[element.point], force, moment, f"pl_{number}")
    for number, (k, point) in enumerate(tree.system.points, start=1):
        if point.loads:
            force, moment = (
                Vector(*(symbol(number, axis) for axis in range(3))) for symbol in (point_force, point_moment)
            )
            yield _inertial(tree, k, point.position, force, moment, f"pi_{number}")


def _inertial(
    tree: Tree, k: int, position: Sequence[Number], force: Vector, moment: Vector, name: str
) -> tuple[int, Applied]:
    """A force at a point of body `k` and a moment, both in inertial components."""
    tree.about(k, "load on a point")
    load = _at(tree, k, Vector(*map(exact, position)), outward(tree, k, 0, force, f"{name}F"))
    return k, Applied(load.force, add(load.moment, outward(tree, k, 0, moment, f"{name}M")))


def _at(tree: Tree, k: int, position: Vector, force: Vector) -> Applied:
    """A force at a point of body `k`, in its frame."""
    arm = tree.definitions.vector(f"r_{k}l", subtract(position, tree.motions[k - 1].origin))
    return Applied(force, cross(arm, force))


def stored_energy(tree: Tree) -> Expr:
    """Of springs and potentials (J)."""
    parts: list[Expr] = []
    translator = ExpressionTranslator(tree.system, exact)
    for element in tree.system.force_elements:
        if isinstance(element, JointSpring):
            stretch = translator.coordinate(element.freedom) - exact(element.rest)
            stretch = tree.definitions.define("kx", stretch)
            parts.append(HALF * exact(element.stiffness) * stretch**2)
        elif isinstance(element, Potential):
            parts.append(translator.value(element.energy))
    parts += [tie.energy(tree.definitions) for tie in ties(tree)]
    return Add(*parts)
