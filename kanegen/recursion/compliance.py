"""Compliance: the acceleration of a body that carries nothing, as a function of a wrench on it.

Angular acceleration and acceleration of an origin are linear in the moment and the force about that origin,

    {alpha; a} = [Y] {N; F},

where the joints inward give way and the bodies outward are cut off, while the wrenches of
`articulated_inertia` stand for what these need. The ground does not give way. From there [Y] is passed
outward (Featherstone 1999, "handles" of articulated bodies). About another origin {a} changes by {alpha} as a
moment does by a force, so that [Y] with {a} before {alpha} has the blocks of an articulated inertia.

Let {s} be the direction of a freedom, {g} its gains and D its pivot. A unit wrench {s} on the body outward,
and a unit effort on the freedom, load the body inward by {s} - {g} and -{g}. So [Y] changes in the row and
column of the freedom alone, to [Y]({s} - {g}), and on the diagonal to

    ({s} - {g})^T [Y] ({s} - {g}) + 1 / D,

a sum of terms that are not negative. The effort accelerates the freedom by {g}^T [Y] {g} + 1 / D, its entry
of [A]^-1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sympy import Add, Expr, S

from kanegen.recursion.articulated_inertia import SIX, ArticulatedInertia, Elimination, from_matrix
from kanegen.recursion.inertia import NO_INERTIA
from kanegen.recursion.turns import Turn
from kanegen.recursion.vectors import ZERO, negate
from kanegen.symbolic.definitions import Definitions, Vector

_PLACES = (3, 4, 5, 0, 1, 2)
"""Place in the blocks of each component of {alpha; a}."""


@dataclass(frozen=True)
class UnitEffort:
    """What a unit generalized force on a freedom causes.

    Attributes:
        acceleration: Angular acceleration of the body outward, and acceleration of its origin.
        mobility: Acceleration of the freedom, its entry of [A]^-1.
    """

    acceleration: tuple[Expr, ...]
    mobility: Expr


@dataclass(frozen=True)
class Compliance:
    """The matrix [Y] of a body, in the frame and about the origin of this.

    Attributes:
        blocks: Its blocks, where the acceleration of the origin stands in the place of a moment.
    """

    blocks: ArticulatedInertia

    def up(self, turn: Turn, name: str, definitions: Definitions) -> Compliance:
        """Return the matrix in components of the frame above a turn."""
        down, old = turn.reversed, self.blocks
        linear = down.down_symmetric(definitions, f"YI_{name}", old.inertia)
        coupling = down.down_matrix(definitions, f"YH_{name}", old.coupling)
        angular = down.down_symmetric(definitions, f"YM_{name}", old.mass)
        return Compliance(ArticulatedInertia(linear, coupling, angular, old.letter))

    def shifted(self, offset: Vector, name: str, definitions: Definitions) -> Compliance:
        """Return the matrix about another origin, to which `offset` leads from the current one."""
        return Compliance(self.blocks.shifted(negate(offset), name, definitions))

    def acceleration(self, wrench: Sequence[Expr]) -> list[Expr]:
        """Return {alpha; a} for the moment and the force of a wrench."""
        return [Add(*(row[i] * wrench[i] for i in SIX)) for row in self._matrix()]

    def with_freedom(self, found: Elimination, definitions: Definitions) -> tuple[Compliance, UnitEffort]:
        """Return the matrix outward of a freedom, and what a unit effort on the freedom causes.

        Args:
            found: Elimination of the freedom from the articulated inertia outward.
            definitions: Definitions that the intermediates are added to.
        """
        index, name, matrix = found.index, found.name, self._matrix()
        passed = [found.kept if i == index else -found.gains.get(i, S.Zero) for i in SIX]
        by_load = [
            definitions.define(f"Yl_{name}_{i}", one) for i, one in enumerate(self.acceleration(passed))
        ]
        by_effort = [definitions.define(f"Ye_{name}_{i}", by_load[i] - matrix[i][index]) for i in SIX]
        along = found.inverse + Add(*(passed[i] * by_effort[i] for i in SIX))
        accelerated = [*by_effort]
        accelerated[index] = definitions.define(f"Yf_{name}", along)
        mobility = definitions.define(f"Ai_{name}_{name}", accelerated[index] - by_effort[index])
        by_load[index] = definitions.define(
            f"Yd_{name}", found.inverse + Add(*(passed[i] * by_load[i] for i in SIX))
        )
        for i in SIX:
            matrix[i][index] = matrix[index][i] = by_load[i]
        blocks = from_matrix([[matrix[i][j] for j in _PLACES] for i in _PLACES], self.blocks.letter)
        return Compliance(blocks.named(name, definitions)), UnitEffort(tuple(accelerated), mobility)

    def _matrix(self) -> list[list[Expr]]:
        """Return [Y] row by row."""
        blocks = self.blocks.matrix()
        return [[blocks[i][j] for j in _PLACES] for i in _PLACES]


RIGID = Compliance(ArticulatedInertia(NO_INERTIA, (ZERO, ZERO, ZERO), NO_INERTIA, "Y"))
"""The compliance of the ground."""
