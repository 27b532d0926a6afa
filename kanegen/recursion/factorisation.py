"""{ydot} from the generalized forces, by factorising [A] = [L]^T [D] [L].

Freedoms are eliminated from the outermost inward. An entry of [A] is zero unless one of its freedoms carries
the other, and this order keeps it so: no fill (Featherstone 2008, section 6.5). Cheap for short trees; its
cost grows with the third power of the depth, that of articulated bodies with the first.
"""

from __future__ import annotations

from sympy import Expr, S

from kanegen.recursion.derived import Derived
from kanegen.recursion.forcing import forcing
from kanegen.recursion.mass_matrix import mass_matrix
from kanegen.recursion.tree import Tree
from kanegen.symbolic.definitions import Definitions
from kanegen.symbolic.symbols import generalized_force
from kanegen.system import System

ARTICULATED_COST = 350
"""About what articulated bodies cost per freedom: beyond it a factorisation is not worth deriving."""

MOST_ANGLES = 2
"""With three free angles [A] is singular where they lose rank; articulated bodies stay accurate there."""


def worth_trying(system: System) -> bool:
    """Whether a factorisation may be the cheaper way, and loses no accuracy."""
    carriers = _carriers(system)
    cost = sum(len(carrying) ** 2 for carrying in carriers.values())
    angles = max(sum(body.joint.free[:3]) for body in system.bodies)
    return angles <= MOST_ANGLES and cost <= ARTICULATED_COST * len(system.freedoms)


def forward_dynamics(tree: Tree) -> Derived:
    """The entries of {ydot}, and the pivots of [D], positive where [A] is regular."""
    system, definitions = tree.system, tree.definitions
    n = len(system.freedoms)
    entries = mass_matrix(tree).entries
    a = {(i, j): entries[n * i + j] for i in range(n) for j in range(n)}
    applied = zip(forcing(tree).entries, system.freedoms, strict=True)
    b = [f + generalized_force(freedom.body, freedom.index) for f, freedom in applied]
    carriers = _carriers(system)
    definitions.about("[A] = [L]^T [D] [L], then {ydot}, Eq. (42)")
    factors, pivots = _factorised(a, carriers, definitions)
    inward = list(carriers)
    for k in inward:
        b[k] = definitions.define(f"b_{k}", b[k])
        for i in carriers[k]:
            b[i] -= factors.get((k, i), S.Zero) * b[k]
    result: dict[int, Expr] = {}
    for k in reversed(inward):
        known = sum(factors.get((k, i), S.Zero) * result[i] for i in carriers[k])
        scaled = definitions.define(f"bd_{k}", b[k] * definitions.define(f"D_{k}i", 1 / pivots[k]))
        result[k] = definitions.define(f"ydot_{k}", scaled - known)
    return Derived([result[i] for i in range(n)], [pivots[i] for i in range(n)])


def _factorised(
    a: dict[tuple[int, int], Expr], carriers: dict[int, list[int]], definitions: Definitions
) -> tuple[dict[tuple[int, int], Expr], dict[int, Expr]]:
    """The entries of [L] left of its diagonal and those of [D]."""
    factors: dict[tuple[int, int], Expr] = {}
    pivots: dict[int, Expr] = {}
    for k, carrying in carriers.items():
        pivots[k] = definitions.define(f"D_{k}", a[k, k])
        inverse = definitions.define(f"D_{k}i", 1 / pivots[k])
        coupled = [i for i in carrying if a[k, i] != 0]
        row = {i: definitions.define(f"A_{k}_{i}_", a[k, i]) for i in coupled}
        for i in coupled:
            factors[k, i] = definitions.define(f"L_{k}_{i}", row[i] * inverse)
        for i in coupled:
            for j in coupled:
                a[i, j] = definitions.define(
                    f"A_{i}_{j}_{k}", a[i, j] - factors[k, max(i, j)] * row[min(i, j)]
                )
    return factors, pivots


def _carriers(system: System) -> dict[int, list[int]]:
    """For every freedom, from the outermost inward, the freedoms that carry it."""
    number = system.places
    outward: dict[int, list[int]] = {0: []}
    for k, body in enumerate(system.bodies, start=1):
        own = [f for f in system.freedoms if f.body == k]
        own.sort(key=lambda f: (f.is_angle, f.axis))  # translations carry angles, the first angle the next
        outward[k] = outward[body.lower] + [number[f] for f in own]
    found: dict[int, list[int]] = {}
    for k in range(system.number_of_bodies, 0, -1):
        before = len(outward[system.connection[k - 1]])
        for place in range(len(outward[k]) - 1, before - 1, -1):
            found[outward[k][place]] = outward[k][:place]
    return found
