"""The output [C], the Coriolis matrix, by composite bodies whose columns are passed inward with those of [A].

A system is a set of particles with the partial velocities [v_P,y]. As [A] is the sum of m [v_P,y]^T [v_P,y],
[C] is the sum of m [v_P,y]^T [dv_P,y/dt], with time derivatives in inertial space. So [C]{y} is what {y}
requires, and [dA/dt] - 2 [C] is skew: it is the sum of m [dv_P,y/dt]^T [v_P,y] less its transpose. Where all
speeds are rates of coordinates, [C] is that of Christoffel symbols, half the derivative of [C]{y} by {y}. For
bodies it is the factorisation of Niemeyer and Slotine (1990) and Echeandia and Wensing (2021).

With all joints outward of a freedom locked, a column holds what unit acceleration of the freedom requires of
the composite body (`mass_matrix`), and what its [dv_P,y/dt] requires. Along the freedoms further inward the
latter are the entries of [C] in the column of this freedom. The entries in its row follow from the former
with the [dv_P,y/dt] of the inner freedoms, and from a couple, which is turned on the way inward but keeps no
origin. All that the motion outward of a joint contributes is twelve numbers, see `relative_momentum`.
"""

from __future__ import annotations

from kanegen.recursion.coriolis_assembly import CoriolisAssembly
from kanegen.recursion.joined_turns import with_joined_turns
from kanegen.recursion.rotors import spinning_rotors
from kanegen.recursion.tree import Derived, Tree


def coriolis_matrix(tree: Tree) -> Derived:
    """Derive the entries of [C], row-major."""
    tree = with_joined_turns(tree)
    assembly = CoriolisAssembly(tree, spinning_rotors(tree))
    for joint in reversed(tree.joints):
        tree.about(joint.body, "columns and rows of the Coriolis matrix")
        assembly.pass_inward(joint)
    n = len(tree.system.freedoms)
    return Derived([assembly.entry(i, j) for i in range(n) for j in range(n)])
