"""Derivatives of [A]{ydot} - {f} by {x} and {y}, by composite bodies, in one recursion inward.

A system is a set of particles at {r} with the partial velocities [v_P,y]. The generalized force of freedom i
is the sum of m [v_P,i] . {a}, where {a} is the acceleration less gravity. Where speeds are rates of
coordinates, its derivative by speed j is twice the entry of the Coriolis matrix (`coriolis`), and the
derivative of {a} by coordinate j is the second time derivative of [v_P,j]. For a rotation about an axis {b}
through O, which has the rates {b'} and {b''}, and particles outward of it, that is

    {b''} x ({r} - {r_O}) + 2 {b'} x ({v} - {v_O}) + {b} x ({a} - {a_O}),

and for a translation along {b} it is {b''}. Freedoms further outward turn with {b}, so that in their rows all
terms with {a} cancel: the force {F} and the moment {M} about O for unit acceleration, and the couple of the
row of [C], give

    {M} . {b''} + 2 {couple} . {b'} - {F} . (2 {b'} x {v_O} + {b} x {a_O}).

In the rows of freedoms further inward there remains a force and a moment that the composite body requires,
its `slope`, which is passed inward with the column (`slope_assembly`). Loads on bodies turn with them and are
part of the force that a joint transmits. The formulas are those of Singh, Russell and Wensing (2022) for
spatial vectors, here with twelve numbers for the motion outward of a joint instead of a matrix of 36.
"""

from __future__ import annotations

from sympy import Add, Expr, S

from kanegen.model.coordinates import Coordinate
from kanegen.recursion.body_motion import body_motions
from kanegen.recursion.coordinate_rates import turnings
from kanegen.recursion.inverse_dynamics import required_by_elements
from kanegen.recursion.joined_turns import with_joined_turns
from kanegen.recursion.slope_assembly import SlopeAssembly
from kanegen.recursion.tree import Derived, Tree


def inverse_dynamics_by_state(tree: Tree) -> Derived:
    """Derive the derivatives of [A]{ydot} - {f} by {x}, then {y}, but for `inverse_dynamics_of_elements`."""
    return Derived(_by_state(tree, accelerated=True))


def forcing_by_state(tree: Tree) -> Derived:
    """Derive the derivatives of {f} by {x}, then by {y}, without those of `forcing_of_elements`."""
    return Derived([-entry for entry in _by_state(tree, accelerated=False)])


def inverse_dynamics_of_elements(tree: Tree) -> Derived:
    """Derive the part of [A]{ydot} - {f} that force elements, loads on points and rotors cause."""
    return Derived(_of_elements(tree, accelerated=True))


def forcing_of_elements(tree: Tree) -> Derived:
    """Derive the part of {f} that force elements, loads on points and rotors cause."""
    return Derived([-entry for entry in _of_elements(tree, accelerated=False)])


def _of_elements(tree: Tree, *, accelerated: bool) -> list[Expr]:
    """Return the part of the required generalized forces; `accelerated` as for `body_motions`."""
    return required_by_elements(tree, body_motions(tree, accelerated=accelerated), accelerated=accelerated)


def _by_state(tree: Tree, *, accelerated: bool) -> list[Expr]:
    """Return the derivatives of required generalized forces; `accelerated` as for `body_motions`."""
    tree = with_joined_turns(tree)
    assembly = SlopeAssembly(tree, accelerated=accelerated)
    for joint in reversed(tree.joints):
        tree.about(joint.body, "columns and rows of derivatives")
        assembly.pass_inward(joint)
    places, moved = range(len(tree.system.freedoms)), motions_by_coordinates(tree)
    entries: list[Expr] = []
    for i in places:
        by_rotation = [assembly.by_rotation(i, j) for j in places]
        entries += (Add(*(share * by_rotation[j] for j, share in shares.items())) for shares in moved)
        entries += (assembly.by_speed(i, j) for j in places)
    return entries


def motions_by_coordinates(tree: Tree) -> list[dict[int, Expr]]:
    """Return for each coordinate by how much a unit change moves along each speed, by place in {y}.

    The pose of a floating body (`free_components`) moves nothing that matters.
    """
    system = tree.system
    found: dict[int, dict[int, Expr]] = {}
    weightless = {joint.body for joint in tree.joints if joint.is_weightless}
    for joint in tree.joints:
        if joint.angular_speeds and not joint.is_weightless:
            tree.about(joint.body, "rotations by coordinates, Eq. (8)")
            for place, turning in turnings(joint, tree).items():
                shares = zip(joint.rotations, turning, strict=True)
                found[place] = {i: share for i, share in shares if share != 0}
    for freedom, i in system.places.items():
        at = system.coordinate_places.get(Coordinate(freedom.body, freedom.index))
        if at is not None and freedom.body not in weightless:
            found.setdefault(at, {i: S.One})
    return [found.get(place, {}) for place in range(len(system.coordinates))]
