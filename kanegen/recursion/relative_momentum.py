"""The momentum of a composite body as its frame sees it: twelve numbers that change its inertia.

A composite body K is a set of particles at {r} from the origin of K. Relative to the frame of K they have the
velocities {u}, which only the joints outward of K cause. Then {p} is the sum of m {u}, and [Q] that of
m ({u} . {r}) [1] - m {u}{r}^T. [Q] + [Q]^T is the rate of the inertia [I] relative to the frame, and the skew
part of [Q] half the angular momentum. As in [I], a turn about an axis leaves the entry of this axis as it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sympy import Expr, Rational, S

from kanegen.recursion.inertia import Inertia
from kanegen.recursion.turns import Turn
from kanegen.recursion.vectors import ZERO, Rows, add, cross, scale, subtract
from kanegen.symbolic.definitions import AXES, Definitions, Vector

HALF = Rational(1, 2)


@dataclass(frozen=True)
class RelativeMomentum:
    """Momentum {p} and rate of inertia [Q], relative to a frame and in its components.

    Attributes:
        linear: {p} (kg m/s).
        rate: [Q], row by row (kg m^2/s).
    """

    linear: Vector = ZERO
    rate: Rows = (ZERO, ZERO, ZERO)

    def plus(self, other: RelativeMomentum, name: str, definitions: Definitions) -> RelativeMomentum:
        """Return the sum for two bodies with one frame and origin."""
        rows = tuple(add(a, b) for a, b in zip(self.rate, other.rate, strict=True))
        return _named(add(self.linear, other.linear), rows, name, definitions)

    def turning(
        self, omega: Vector, body: Inertia, second: Rows, name: str, definitions: Definitions
    ) -> RelativeMomentum:
        """Return the momentum relative to a frame in which the former one turns about their common origin.

        Args:
            omega: Angular velocity of the former frame in the new one (rad/s).
            body: The composite body.
            second: Its second moments [D].
            name: Suffix of the names of intermediates.
            definitions: Definitions that the intermediates are added to.
        """
        columns = [cross(omega, column) for column in second]  # [omega~][D] has no trace
        rows = tuple(
            subtract(row, Vector(*(column[i] for column in columns))) for i, row in enumerate(self.rate)
        )
        return _named(add(self.linear, cross(omega, body.moment)), rows, name, definitions)

    def down(self, turn: Turn, name: str, definitions: Definitions) -> RelativeMomentum:
        """Return the same in components of the frame below a turn that stands still."""
        rows = turn.down_matrix(definitions, f"Qr_{name}", self.rate)
        return _named(turn.down(self.linear), rows, name, definitions)

    def shifted(
        self, d: Vector, velocity: Vector, body: Inertia, name: str, definitions: Definitions
    ) -> RelativeMomentum:
        """Return the momentum relative to a frame with another origin, with {r} + {d} and {u} + {d'}.

        Args:
            d: Vector {d} from the other origin to this one (m).
            velocity: Its rate {d'} in that frame (m/s).
            body: The composite body about the other origin.
            name: Suffix of the names of intermediates.
            definitions: Definitions that the intermediates are added to.
        """
        rows = _with_product(self.rate, self.linear, d, f"pd_{name}", definitions)
        rows = _with_product(rows, velocity, body.moment, f"vh_{name}", definitions)
        return _named(add(self.linear, scale(body.mass, velocity)), rows, name, definitions)

    def column(self, axis: int) -> Vector:
        """Return column `axis` of [Q]: for the basis vector {a} the sum of {r} x ({a} x m {u})."""
        return Vector(*(row[axis] for row in self.rate))

    def row(self, axis: int) -> Vector:
        """Return row `axis` of [Q]: for the basis vector {a} the sum of m {u} x ({a} x {r})."""
        return self.rate[axis]


def _with_product(
    rows: Sequence[Vector], a: Vector, b: Vector, name: str, definitions: Definitions
) -> tuple[Vector, ...]:
    """Return a matrix plus {a} . {b} [1] - {a}{b}^T."""
    products = definitions.vector(name, Vector(*(a[i] * b[i] for i in range(3))))
    found = []
    for i, row in enumerate(rows):
        j, k = (i + 1) % 3, (i + 2) % 3
        entries = list(row)
        entries[i] += products[j] + products[k]
        entries[j] -= a[i] * b[j]
        entries[k] -= a[i] * b[k]
        found.append(Vector(*entries))
    return tuple(found)


def second_moments(body: Inertia, axis: int | None, name: str, definitions: Definitions) -> Rows:
    """Return [D] = tr[I]/2 - [I], the sum of m {r}{r}^T, row by row.

    Args:
        body: A composite body.
        axis: If not None, the basis vector whose diagonal entry is not needed and left 0.
        name: Suffix of the names of intermediates.
        definitions: Definitions that the intermediates are added to.
    """
    i = body.inertia
    inertia = (i.xx, i.yy, i.zz)
    diagonal: list[Expr] = [S.Zero] * 3
    last = 2 if axis is None else axis
    j, k = (last + 1) % 3, (last + 2) % 3
    difference = definitions.define(f"Dd_{name}", inertia[k] - inertia[j])
    diagonal[j] = definitions.define(f"Dc_{name}_{AXES[j] * 2}", HALF * (inertia[last] + difference))
    diagonal[k] = definitions.define(f"Dc_{name}_{AXES[k] * 2}", inertia[last] - diagonal[j])
    if axis is None:
        diagonal[last] = definitions.define(f"Dc_{name}_{AXES[last] * 2}", inertia[k] - diagonal[j])
    return (
        Vector(diagonal[0], -i.xy, -i.xz),
        Vector(-i.xy, diagonal[1], -i.yz),
        Vector(-i.xz, -i.yz, diagonal[2]),
    )


def whole_second_moments(body: Inertia, axis: int, second: Rows, name: str, definitions: Definitions) -> Rows:
    """Return [D] with the diagonal entry of a basis vector that `second_moments` has left out.

    Args:
        body: The composite body.
        axis: The basis vector.
        second: The second moments without this entry.
        name: Suffix of the names of intermediates.
        definitions: Definitions that the intermediates are added to.
    """
    i, j, k = body.inertia, (axis + 1) % 3, (axis + 2) % 3
    last = (i.xx, i.yy, i.zz)[k] - second[j][j]
    found = [list(row) for row in second]
    found[axis][axis] = definitions.define(f"Dc_{name}_{AXES[axis] * 2}", last)
    x, y, z = (Vector(*row) for row in found)
    return x, y, z


def _named(linear: Vector, rows: tuple[Vector, ...], name: str, definitions: Definitions) -> RelativeMomentum:
    """Return a momentum with a symbol for every entry."""
    x, y, z = (definitions.vector(f"Qr_{name}_{axis}", row) for axis, row in zip(AXES, rows, strict=True))
    return RelativeMomentum(definitions.vector(f"pr_{name}", linear), (x, y, z))
