"""Inertia of a body, or of several bodies moving as one, about the origin O_K."""

from __future__ import annotations

from dataclasses import dataclass

from sympy import Expr, S

from kanegen.model.system import System
from kanegen.recursion.joints import exact
from kanegen.recursion.turns import Turn
from kanegen.recursion.vectors import ZERO, add, add_symmetric, scale, subtract
from kanegen.symbolic.definitions import AXES, Definitions, Symmetric, Vector

Rows = tuple[Vector, Vector, Vector]

NOTHING = Symmetric(*(S.Zero,) * 6)


@dataclass(frozen=True)
class Inertia:
    """What resists motion, about an origin and in its frame.

    Attributes:
        mass: kg.
        moment: First moment of mass: mass times the position of the mass centre (kg m).
        inertia: Second moment, the inertia matrix about the origin (kg m^2).
    """

    mass: Expr = S.Zero
    moment: Vector = ZERO
    inertia: Symmetric = NOTHING

    def plus(self, other: Inertia, label: str, definitions: Definitions) -> Inertia:
        """Both together, as the composite body `label`."""
        return Inertia(
            definitions.define(f"mc_{label}", self.mass + other.mass),
            definitions.vector(f"hc_{label}", add(self.moment, other.moment)),
            definitions.symmetric(f"Ic_{label}", add_symmetric(self.inertia, other.inertia)),
        )

    def down(self, turn: Turn, name: str, definitions: Definitions) -> Inertia:
        """The same from below a turn."""
        return Inertia(
            self.mass,
            definitions.vector(f"hc_{name}", turn.down(self.moment)),
            turn.down_symmetric(definitions, f"Ic_{name}", self.inertia),
        )

    def levered(self, d: Vector, name: str, definitions: Definitions) -> Rows:
        """Moment about an origin {d} before this one, by angular velocity about this one: [I] - [d~][h~]."""
        h, old = self.moment, self.inertia
        xx, yy, zz = _diagonal(h, d, f"hd_{name}", definitions)
        xy, xz, yz = self._between(d)
        rows = (
            Vector(old.xx + xx, xy, xz),
            Vector(old.xy - h.y * d.x, old.yy + yy, yz),
            Vector(old.xz - h.z * d.x, old.yz - h.z * d.y, old.zz + zz),
        )
        x, y, z = (definitions.vector(f"B_{name}_{axis}", row) for axis, row in zip(AXES, rows, strict=True))
        return x, y, z

    def shifted(self, d: Vector, name: str, definitions: Definitions, levered: Rows | None = None) -> Inertia:
        """About an origin {d} before this one: with {H} = {h} + m {d}, [I] - [d~][h~] - [H~][d~].

        Args:
            d: From that origin to this one, in this frame (m).
            name: For names.
            definitions: Take the intermediates.
            levered: The same of `levered`, where it is known.
        """
        h = definitions.vector(f"hc_{name}", add(self.moment, scale(self.mass, d)))
        if levered is None:
            sums = add(self.moment, h)
            t = [definitions.define(f"dh_{name}_{AXES[i]}", d[i] * sums[i]) for i in range(3)]
            added, between = Vector(t[1] + t[2], t[2] + t[0], t[0] + t[1]), self._between(d)
            old = Vector(self.inertia.xx, self.inertia.yy, self.inertia.zz)
        else:
            x, y, z = levered
            added, between = _diagonal(h, d, f"dh_{name}", definitions), (x.y, x.z, y.z)
            old = Vector(x.x, y.y, z.z)
        xy, xz, yz = between
        new = Symmetric(*add(old, added), xy - d.x * h.y, xz - d.x * h.z, yz - d.y * h.z)
        return Inertia(self.mass, h, definitions.symmetric(f"Ic_{name}", new))

    def _between(self, d: Vector) -> tuple[Expr, Expr, Expr]:
        """Entries xy, xz, yz of [I] - [d~][h~]."""
        h, old = self.moment, self.inertia
        return old.xy - h.x * d.y, old.xz - h.x * d.z, old.yz - h.y * d.z


def _diagonal(h: Vector, d: Vector, name: str, definitions: Definitions) -> Vector:
    """The diagonal of -[d~][h~]."""
    x, y, z = (definitions.define(f"{name}_{AXES[i]}", h[i] * d[i]) for i in range(3))
    return definitions.vector(f"{name}s", Vector(y + z, z + x, x + y))


def body_inertia(system: System, k: int, origin: Vector, definitions: Definitions) -> Inertia:
    """Mass, first moment and inertia of body `k` about a point of it: [I_G] - m [r~][r~].

    Args:
        system: The tree.
        k: Number of the body.
        origin: The point, from O_K, in K (m).
        definitions: Take the intermediates.
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
