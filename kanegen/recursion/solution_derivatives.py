"""What derivatives of {ydot} are made of: the factors of [A], derivatives of what motion requires, and maps.

The derivatives of {ydot} follow from [A]{ydot} = {f} + {tau} at constant {ydot} (Carpentier and Mansard 2018,
section III): each column is the solution for a right side that holds derivatives of inverse dynamics. All of
it is in free components (`free_components`), in which nothing cancels next to gimbal lock and the pose of a
floating body has no part; so a column of {x}, {y} or {tau} is

    -[A]^-1 (derivatives by motions x motions by {x} + derivatives by speeds x speeds by {x}, {y} - efforts),

and a last map leads from components to {ydot}. `lowering.differentiate` differentiates the maps, which are
short, and solves.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sympy import Add, Expr, S

from kanegen.model.coordinates import Freedom
from kanegen.model.force_elements import PointLoad, Spring
from kanegen.model.system import System
from kanegen.recursion.body_motion import body_motions
from kanegen.recursion.coordinate_rates import angle_rates
from kanegen.recursion.factorisation import carriers
from kanegen.recursion.free_components import (
    component_efforts,
    component_speeds,
    floats,
    speed_rates,
    with_free_components,
)
from kanegen.recursion.gravity import gravity_forces
from kanegen.recursion.inverse_dynamics import efforts_of_elements, required_by_bodies, required_by_wrenches
from kanegen.recursion.inverse_dynamics_derivatives import motions_by_coordinates
from kanegen.recursion.joined_turns import with_joined_turns
from kanegen.recursion.mass_matrix import mass_matrix
from kanegen.recursion.pivot_margins import PivotMargins
from kanegen.recursion.refinement import Refinement, unless_positive
from kanegen.recursion.relative_momentum import HALF
from kanegen.recursion.rotors import spinning_rotors
from kanegen.recursion.slope_assembly import SlopeAssembly
from kanegen.recursion.symmetric_factors import factorised
from kanegen.recursion.tree import Derived, Tree
from kanegen.symbolic.state_symbols import NOTES
from kanegen.symbolic.symbols import generalized_force


@dataclass(frozen=True)
class SolutionRows:
    """The rows, each with a number for every freedom, that make up the part "forward_dynamics_parts".

    Attributes:
        coordinates: Number of elements of {x}.
        freedoms: Number of freedoms n.
    """

    coordinates: int
    freedoms: int

    @property
    def slices(self) -> dict[str, slice]:
        """The rows by name.

        They are the factors of [A]; the derivatives of required generalized forces by motions along free
        components, then by speeds along them; the motions by coordinates; the reciprocals of the pivots; the
        right side where all components are zero; what is required; efforts; speeds; and {ydot}.
        """
        sizes = {
            "factors": self.freedoms,
            "by_motion": self.freedoms,
            "by_speed": self.freedoms,
            "motions": self.coordinates,
            **dict.fromkeys(("inverse_pivots", "surplus", "required", "efforts", "speeds", "rates"), 1),
        }
        found, first = {}, 0
        for name, size in sizes.items():
            found[name] = slice(first, first + size)
            first += size
        return found

    @property
    def count(self) -> int:
        """Number of rows of the part."""
        return 3 * self.freedoms + self.coordinates + 6


@dataclass(frozen=True)
class _Factors:
    """The factors of [A] in free components, with what `PivotMargins` needs.

    Attributes:
        tree: The tree with {y} as speeds.
        pivots: Pivots by place in {y}.
        together: Whether they are those of free components.
        factors: Entries left of the diagonal by row and column.
    """

    tree: Tree
    pivots: Sequence[Expr]
    together: bool
    factors: Mapping[tuple[int, int], Expr]


def flying_bodies(system: System) -> list[int]:
    """Return the numbers of the bodies that translate freely, and rotate, relative to their lower bodies."""
    joints = [body.joint for body in system.bodies]
    return [k for k, one in enumerate(joints, start=1) if all(one.free[3:]) and any(one.free[:3])]


def locking_bodies(system: System) -> list[int]:
    """Return the numbers of the bodies whose joints have three angles, which can reach gimbal lock."""
    joints = [body.joint for body in system.bodies]
    return [k for k, one in enumerate(joints, start=1) if one.speeds_are_rates and all(one.free[:3])]


def has_parts_of_derivatives(system: System) -> bool:
    """Return whether derivatives of {ydot} are made from parts of their own instead of its solver.

    The solver costs less where several bodies translate freely and rotate, because it never couples them. And
    it alone is accurate next to gimbal lock, where springs or loads act on points or rotors spin, and for
    angles that have armature or couplings.
    """
    flying, locking = flying_bodies(system), locking_bodies(system)
    if not (locking or flying):
        return True
    coupled = {freedom.body for freedom in system.in_couplings}
    joints = {k: body.joint for k, body in enumerate(system.bodies, start=1)}
    bound = {k for k, one in joints.items() if k in coupled or any(one.armature) or not all(one.free[:3])}
    is_based = all(k not in bound and not system.bodies[k - 1].lower for k in flying)
    if len(flying) > 1 or not is_based or bound.intersection(locking):
        return False
    loaded = any(point.loads for _, point in system.points)
    loaded |= any(isinstance(element, Spring | PointLoad) for element in system.force_elements)
    return not (system.mounted_rotors or (locking and loaded))


def solution_parts(tree: Tree, refinement: Refinement, *, together: bool) -> Derived:
    """Derive the rows of `SolutionRows`, with the conditions under which {ydot} exists and is accurate.

    Args:
        tree: The tree of a solver.
        refinement: What the solver reports; no step of refinement.
        together: Whether the solver eliminates free components.
    """
    system = tree.system
    n = len(system.freedoms)
    free = with_joined_turns(with_free_components(tree) if together else tree)
    assembly = SlopeAssembly(free, accelerated=True)
    for joint in reversed(free.joints):
        tree.about(joint.body, "columns and rows of derivatives")
        assembly.pass_inward(joint)
    factors = _factors(tree, free, assembly, together=together)
    inverses = [tree.definitions.define(f"D_{i}i", 1 / pivot) for i, pivot in enumerate(factors.pivots)]
    places = range(n)
    rows: list[Sequence[Expr]] = [[factors.factors.get((k, i), S.Zero) for i in places] for k in places]
    rows += [[assembly.by_rotation(i, j) for j in places] for i in places]
    rows += [[assembly.by_speed(i, j) for j in places] for i in places]
    rows += [[motion.get(i, S.Zero) for i in places] for motion in motions_by_coordinates(free)]
    speeds = component_speeds(free, NOTES.speeds(system))
    at_rest = _required_at_rest(free, assembly, speeds)
    efforts = [_efforts(tree, accelerated=accelerated, together=together) for accelerated in (False, True)]
    rows.append(inverses)
    rows.append([effort - need for effort, need in zip(efforts[0], at_rest, strict=True)])
    rows.append(_required(free, accelerated=True))
    rows.append(efforts[1])
    rows.append(speeds)
    rows.append(speed_rates(tree, free) if together else NOTES.accelerations(system))
    margins = PivotMargins(factors).margins(refinement.pivots)
    entries = [entry for row in rows for entry in row]
    return Derived(entries, _regular_if_positive(factors), unless_positive([margins] if margins else []))


def _required(free: Tree, *, accelerated: bool) -> list[Expr]:
    """Return the generalized forces that bodies and motors require, without rotors and force elements."""
    return required_by_bodies(free, body_motions(free, accelerated=accelerated), accelerated=accelerated)


def _required_at_rest(free: Tree, assembly: SlopeAssembly, speeds: Sequence[Expr]) -> list[Expr]:
    """Return the generalized forces that bodies and motors require where all free components are zero.

    What speeds require is homogeneous of the second degree: half its derivatives by them, times them (Euler).
    """
    system, weightless = free.system, {joint.body for joint in free.joints if joint.is_weightless}
    is_moved = bool(system.prescribed) or any(body.loads for body in system.bodies)
    roots = {k for k, body in enumerate(system.bodies, start=1) if not body.lower}
    if is_moved or (weightless and weightless != roots):
        return _required(free, accelerated=False)
    places = range(len(speeds))
    weights = [S.Zero] * len(speeds) if weightless else gravity_forces(free).entries
    free.definitions.about("what speeds and weights require, Eq. (44)")
    products = [[assembly.by_speed(i, j) * speeds[j] for j in places] for i in places]
    twice = [free.definitions.define(f"fw_{i}", Add(*row)) for i, row in enumerate(products)]
    return [free.definitions.define(f"fv_{i}", HALF * twice[i] - weights[i]) for i in places]


def _efforts(tree: Tree, *, accelerated: bool, together: bool) -> list[Expr]:
    """Return {tau} plus the efforts of force elements and rotors, on free components.

    Args:
        tree: The tree with {y} as speeds.
        accelerated: Whether rotors have accelerations, as for `body_motions`.
        together: Whether joints have free components.
    """
    needed: Sequence[Expr]
    needed = required_by_wrenches(tree, body_motions(tree, accelerated=accelerated), accelerated=accelerated)
    own = [generalized_force(one.body, one.index) for one in tree.system.freedoms]
    acting = efforts_of_elements(tree)
    efforts = [tree.definitions.define(f"te_{i}", tau + acting[i]) for i, tau in enumerate(own)]
    if together:
        efforts = component_efforts(tree, efforts)
        needed = component_efforts(tree, needed, about_origins=True)
    differences = [effort - need for effort, need in zip(efforts, needed, strict=True)]
    return [tree.definitions.define(f"te_{i}", difference) for i, difference in enumerate(differences)]


def _factors(tree: Tree, free: Tree, assembly: SlopeAssembly, *, together: bool) -> _Factors:
    """Return the factors of [A], from the outermost freedom inward."""
    n, definitions = len(tree.system.freedoms), tree.definitions
    places = range(n)
    if spinning_rotors(tree):
        entries = mass_matrix(free).entries
        a = {(i, j): entries[n * i + j] for i in places for j in places}
    else:
        motors = _armatures(free)
        a = {(i, j): assembly.inertia(i, j) + motors.get((i, j), S.Zero) for i in places for j in places}
    definitions.about("[A] = [L]^T [D] [L], Eq. (42)")
    order = carriers(tree.system, _orders(tree) if together else {})
    found, pivots = factorised(a, order, definitions)
    return _Factors(tree, [pivots[i] for i in places], together, found)


def _armatures(tree: Tree) -> dict[tuple[int, int], Expr]:
    """Return what the armature of motors adds to the entries of [A]."""
    found: dict[tuple[int, int], Expr] = {}
    for joint in tree.joints:
        for one in joint.elements:
            for i, share in one.shares.items() if one.armature != 0 else ():
                for j, other in one.shares.items():
                    found[i, j] = found.get((i, j), S.Zero) + one.armature * share * other
    return found


def _orders(tree: Tree) -> dict[int, list[Freedom]]:
    """Return the order of the freedoms of bodies with free components, from the innermost.

    Components are eliminated in the order of articulated bodies, so that the pivots are the same: the
    translations of a floating body first, then rotations.
    """
    coupled = {one.freedom.body for one in tree.system.coupled}
    found: dict[int, list[Freedom]] = {}
    for joint in tree.joints:
        own = [freedom for freedom in tree.system.freedoms if freedom.body == joint.body]
        is_free = joint.rotates_freely or joint.turns_freely
        angles = sorted((f for f in own if f.is_angle), key=lambda f: f.index, reverse=is_free)
        others = sorted((f for f in own if not f.is_angle), key=lambda f: -f.index)
        if joint.body not in coupled:
            found[joint.body] = angles + others if floats(joint) else others + angles
    return found


def _regular_if_positive(factors: _Factors) -> list[Expr]:
    """Return expressions by freedom that are positive where {ydot} exists."""
    found = list(factors.pivots)
    for joint in factors.tree.joints if factors.together else ():
        if joint.rotates_freely:
            first, across = joint.angles[0].freedom, angle_rates(joint, factors.tree.definitions).across
            weakened = found[first] * across * across
            found[first] = factors.tree.definitions.define(f"Dc_{joint.body}", weakened)
    return found
