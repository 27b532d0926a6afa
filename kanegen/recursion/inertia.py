"""Inertia of a body, or of a composite of several bodies, about the point O_K or another origin."""

from __future__ import annotations

from dataclasses import dataclass

from sympy import Expr, S

from kanegen.model.system import System
from kanegen.recursion.constants import exact
from kanegen.recursion.turns import Turn
from kanegen.recursion.vectors import ZERO, Rows, add, add_symmetric, scale, subtract
from kanegen.symbolic.definitions import AXES, Definitions, Symmetric, Vector

NO_INERTIA = Symmetric(*(S.Zero,) * 6)


@dataclass(frozen=True)
class Inertia:
    """Mass, first moment and second moment of mass about an origin, in the frame of the origin.

    Attributes:
        mass: Mass m (kg).
        moment: First moment {h}: mass times the position of the mass centre (kg m).
        inertia: Second moment [I]: the inertia matrix about the origin (kg m^2).
    """

    mass: Expr = S.Zero
    moment: Vector = ZERO
    inertia: Symmetric = NO_INERTIA

    def plus(self, other: Inertia, label: str, definitions: Definitions) -> Inertia:
        """Return the sum of two inertias about one origin, named as the composite body `label`."""
        return Inertia(
            definitions.define(f"mc_{label}", self.mass + other.mass),
            definitions.vector(f"hc_{label}", add(self.moment, other.moment)),
            definitions.symmetric(f"Ic_{label}", add_symmetric(self.inertia, other.inertia)),
        )

    def down(self, turn: Turn, name: str, definitions: Definitions) -> Inertia:
        """Return the same inertia in components of the frame below a turn."""
        return Inertia(
            self.mass,
            definitions.vector(f"hc_{name}", turn.down(self.moment)),
            turn.down_symmetric(definitions, f"Ic_{name}", self.inertia),
        )

    def moment_matrix(self, d: Vector, name: str, definitions: Definitions) -> Rows:
        """Return [I] - [d~][h~]: angular momentum about another origin by angular velocity about this one.

        Args:
            d: Vector from the other origin to this one, in this frame (m).
            name: Suffix of the names of intermediates.
            definitions: Definitions that the intermediates are added to.
        """
        h, old = self.moment, self.inertia
        xx, yy, zz = _diagonal(h, d, f"hd_{name}", definitions)
        xy, xz, yz = self._upper(d)
        rows = (
            Vector(old.xx + xx, xy, xz),
            Vector(old.xy - h.y * d.x, old.yy + yy, yz),
            Vector(old.xz - h.z * d.x, old.yz - h.z * d.y, old.zz + zz),
        )
        x, y, z = (definitions.vector(f"B_{name}_{axis}", row) for axis, row in zip(AXES, rows, strict=True))
        return x, y, z

    def shifted(
        self, d: Vector, name: str, definitions: Definitions, moment_matrix: Rows | None = None
    ) -> Inertia:
        """Return the inertia about another origin: with {H} = {h} + m {d}, [I] - [d~][h~] - [H~][d~].

        Args:
            d: Vector from the other origin to this one, in this frame (m).
            name: Suffix of the names of intermediates.
            definitions: Definitions that the intermediates are added to.
            moment_matrix: Result of `moment_matrix` for the same {d}, where it is known.
        """
        h = definitions.vector(f"hc_{name}", add(self.moment, scale(self.mass, d)))
        if moment_matrix is None:
            sums = add(self.moment, h)
            t = [definitions.define(f"dh_{name}_{AXES[i]}", d[i] * sums[i]) for i in range(3)]
            added, upper = Vector(t[1] + t[2], t[2] + t[0], t[0] + t[1]), self._upper(d)
            old = Vector(self.inertia.xx, self.inertia.yy, self.inertia.zz)
        else:
            x, y, z = moment_matrix
            added, upper = _diagonal(h, d, f"dh_{name}", definitions), (x.y, x.z, y.z)
            old = Vector(x.x, y.y, z.z)
        xy, xz, yz = upper
        new = Symmetric(*add(old, added), xy - d.x * h.y, xz - d.x * h.z, yz - d.y * h.z)
        return Inertia(self.mass, h, definitions.symmetric(f"Ic_{name}", new))

    def _upper(self, d: Vector) -> tuple[Expr, Expr, Expr]:
        """Return the entries xy, xz, yz of [I] - [d~][h~]."""
        h, old = self.moment, self.inertia
        return old.xy - h.x * d.y, old.xz - h.x * d.z, old.yz - h.y * d.z


def _diagonal(h: Vector, d: Vector, name: str, definitions: Definitions) -> Vector:
    """Return the diagonal of -[d~][h~]."""
    x, y, z = (definitions.define(f"{name}_{AXES[i]}", h[i] * d[i]) for i in range(3))
    return definitions.vector(f"{name}s", Vector(y + z, z + x, x + y))


def body_inertia(system: System, k: int, origin: Vector, definitions: Definitions) -> Inertia:
    """Return the inertia of body `k` about a point that is fixed in it: [I_G] - m [r~][r~].

    Args:
        system: The system of the body.
        k: Number of the body.
        origin: Position of the point from O_K, in K (m).
        definitions: Definitions that the intermediates are added to.
    """
    body = system.bodies[k - 1]
    definitions.about(f"Body {k} ({body.name}): mass, first moment and inertia")
    mass = exact(body.mass)
    arm = subtract(Vector(*(exact(value) for value in body.mass_center)), origin)
    r = definitions.vector(f"r_{k}", arm)
    moment = definitions.vector(f"h_{k}", scale(mass, r))
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = [[exact(value) for value in row] for row in body.inertia]
    squares = [
        definitions.define(f"hr_{k}_{axis}", h * c) for axis, h, c in zip("xyz", moment, r, strict=True)
    ]
    about_origin = Symmetric(
        xx=xx + squares[1] + squares[2],
        yy=yy + squares[2] + squares[0],
        zz=zz + squares[0] + squares[1],
        xy=xy - moment.x * r.y,
        xz=xz - moment.x * r.z,
        yz=yz - moment.y * r.z,
    )
    return Inertia(mass, moment, definitions.symmetric(f"I_{k}", about_origin))
