"""Inertia of a body, or of several bodies moving as one, about the origin O_K."""

from __future__ import annotations

from dataclasses import dataclass

from sympy import Expr, S

from kanegen.recursion.joints import exact
from kanegen.recursion.turns import Turn
from kanegen.recursion.vectors import ZERO, add, add_symmetric, scale, subtract
from kanegen.symbolic.definitions import AXES, Definitions, Symmetric, Vector
from kanegen.system import System

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

    def shifted(self, d: Vector, name: str, definitions: Definitions) -> Inertia:
        """About an origin {d} before this one: with {H} = {h} + m {d}, [I] - [d~][H~] - [h~][d~]."""
        h = self.moment
        shifted = definitions.vector(f"hc_{name}", add(h, scale(self.mass, d)))
        sums = add(h, shifted)
        t = [definitions.define(f"dh_{name}_{AXES[i]}", d[i] * sums[i]) for i in range(3)]
        old = self.inertia
        new = Symmetric(
            xx=old.xx + (t[1] + t[2]),
            yy=old.yy + (t[2] + t[0]),
            zz=old.zz + (t[0] + t[1]),
            xy=old.xy - (d.x * shifted.y + h.x * d.y),
            xz=old.xz - (d.x * shifted.z + h.x * d.z),
            yz=old.yz - (d.y * shifted.z + h.y * d.z),
        )
        return Inertia(self.mass, shifted, definitions.symmetric(f"Ic_{name}", new))


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
