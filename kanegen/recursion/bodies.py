"""Inertia of a body, or of several bodies moving as one, about the origin O_K."""

from __future__ import annotations

from dataclasses import dataclass

from sympy import Expr, S

from kanegen.recursion.joints import exact
from kanegen.recursion.vectors import ZERO, add, add_symmetric, scale
from kanegen.symbolic.definitions import Definitions, Symmetric, Vector
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


def body_inertia(system: System, k: int, definitions: Definitions) -> Inertia:
    """Mass, first moment and inertia of body `k` about O_K: [I_O] = [I_G] - m [r~][r~]."""
    body = system.bodies[k - 1]
    definitions.about(f"Body {k} ({body.name}): mass, first moment and inertia about O_{k}")
    mass = exact(body.mass)
    r = Vector(*(exact(value) for value in body.mass_center))
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
