"""The momentum of a composite body as its frame sees it: twelve numbers that change its second moments.

A composite body K is a set of particles at {r} from the origin of K. Relative to the frame of K they have the
velocities {u}, which only the joints outward of K cause. Then {p} is the sum of m {u}, and [K] that of
m {u}{r}^T. The skew part of [K] is half the angular momentum relative to the frame, its symmetric part half
the rate of the second moments [D], the sum of m {r}{r}^T.
"""

from __future__ import annotations

from dataclasses import dataclass

from sympy import Expr, Rational, S

from kanegen.recursion.inertia import Inertia
from kanegen.recursion.turns import Turn
from kanegen.recursion.vectors import ZERO, Rows, add, cross, scale
from kanegen.symbolic.definitions import AXES, Definitions, Vector

HALF = Rational(1, 2)


@dataclass(frozen=True)
class RelativeMomentum:
    """Momentum {p} and its moments [K], relative to a frame and in its components.

    Attributes:
        linear: {p} (kg m/s).
        moments: [K], row by row (kg m^2/s).
    """

    linear: Vector = ZERO
    moments: Rows = (ZERO, ZERO, ZERO)

    def plus(self, other: RelativeMomentum, name: str, definitions: Definitions) -> RelativeMomentum:
        """Return the sum for two bodies with one frame and origin."""
        rows = tuple(add(a, b) for a, b in zip(self.moments, other.moments, strict=True))
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
        columns = [cross(omega, column) for column in second]
        rows = tuple(
            add(row, Vector(*(column[i] for column in columns))) for i, row in enumerate(self.moments)
        )
        return _named(add(self.linear, cross(omega, body.moment)), rows, name, definitions)

    def down(self, turn: Turn, name: str, definitions: Definitions) -> RelativeMomentum:
        """Return the same in components of the frame below a turn that stands still."""
        rows = turn.down_matrix(definitions, f"Kr_{name}", self.moments)
        return _named(turn.down(self.linear), rows, name, definitions)

    def shifted(
        self, d: Vector, velocity: Vector, body: Inertia, name: str, definitions: Definitions
    ) -> RelativeMomentum:
        """Return the momentum relative to a frame with another origin: [K] + {p}{d}^T + {d'}{H}^T.

        Args:
            d: Vector from the other origin to this one (m).
            velocity: Its rate {d'} in that frame (m/s).
            body: The composite body about the other origin, with the first moment {H}.
            name: Suffix of the names of intermediates.
            definitions: Definitions that the intermediates are added to.
        """
        rows = tuple(
            add(add(row, scale(self.linear[i], d)), scale(velocity[i], body.moment))
            for i, row in enumerate(self.moments)
        )
        return _named(add(self.linear, scale(body.mass, velocity)), rows, name, definitions)

    def couple(self, axis: Vector) -> Vector:
        """Return tr[K] {a} - [K]{a}: the sum of {r} x ({a} x m {u})."""
        return self._couple(axis, self.moments)

    def transposed_couple(self, axis: Vector) -> Vector:
        """Return tr[K] {a} - [K]^T {a}: the sum of m {u} x ({a} x {r})."""
        columns = tuple(Vector(*(row[j] for row in self.moments)) for j in range(3))
        return self._couple(axis, columns)

    def _couple(self, axis: Vector, rows: tuple[Vector, ...]) -> Vector:
        """Return the product of the trace of a matrix, less the matrix, and a vector; zeros do not cancel."""
        diagonal = [rows[i][i] for i in range(3)]
        components = []
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            others = diagonal[j] + diagonal[k]
            components.append(others * axis[i] - rows[i][j] * axis[j] - rows[i][k] * axis[k])
        return Vector(*components)


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


def _named(linear: Vector, rows: tuple[Vector, ...], name: str, definitions: Definitions) -> RelativeMomentum:
    """Return a momentum with a symbol for every entry."""
    x, y, z = (definitions.vector(f"Kr_{name}_{axis}", row) for axis, row in zip(AXES, rows, strict=True))
    return RelativeMomentum(definitions.vector(f"pr_{name}", linear), (x, y, z))
