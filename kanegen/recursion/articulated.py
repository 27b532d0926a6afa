"""A body with everything outward of it, as the force that it takes to accelerate it.

The pair {N}, {F} about an origin is linear in the angular acceleration and the acceleration of that origin,

    {N; F} = [S] {alpha; a} + {p},

with a symmetric [S] of rows and columns 0-2 for turning and 3-5 for translation. Where a component of the
acceleration is free, its row is solved for it and what is left passes inward (Featherstone 2008, section
7.3).
A component that is eliminated leaves exact zeros in [S] and its own effort in {p}. [S] depends on {x} alone,
so one elimination serves any number of {p}.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from sympy import Expr, S

from kanegen.recursion.bodies import Inertia
from kanegen.recursion.motion import Requirement
from kanegen.recursion.turns import Turn
from kanegen.recursion.vectors import INDEX, add, add_symmetric, cross, entry
from kanegen.symbolic.definitions import AXES, Definitions, Symmetric, Vector

SIX = range(6)
Rows = tuple[Vector, Vector, Vector]


@dataclass(frozen=True)
class Elimination:
    """How a free component of the acceleration follows from the others.

    Attributes:
        index: The component.
        name: For names.
        pivot: Its entry of [S]; positive, or [A] is singular.
        inverse: Of the pivot.
        gains: By other component, what it takes away per unit.
    """

    index: int
    name: str
    pivot: Expr
    inverse: Expr
    gains: dict[int, Expr]

    def passed(self, bias: Requirement, effort: Expr, definitions: Definitions) -> tuple[Requirement, Expr]:
        """What is left of {p} where `effort` acts along the component.

        Returns:
            It, and the component where the others are zero.
        """
        left = [*bias.moment, *bias.force]
        surplus = definitions.define(f"e_{self.name}", effort - left[self.index])
        free = definitions.define(f"n_{self.name}", surplus * self.inverse)
        for i, gain in self.gains.items():
            left[i] += gain * surplus
        left[self.index] = effort  # what the joint transmits along the component
        return Requirement(Vector(*left[3:]), Vector(*left[:3])).named(self.name, definitions), free

    def solve(self, free: Expr, acceleration: Sequence[Expr]) -> Expr:
        """The component, from what it is where the others are zero and from the others."""
        return free - sum(gain * acceleration[i] for i, gain in self.gains.items())


@dataclass(frozen=True)
class Articulated:
    """[S] in blocks.

    Attributes:
        inertia: Moments by angular acceleration (kg m^2).
        coupling: Rows of moments by acceleration (kg m).
        mass: Forces by acceleration (kg).
    """

    inertia: Symmetric
    coupling: Rows
    mass: Symmetric

    def plus(self, other: Articulated, name: str, definitions: Definitions) -> Articulated:
        """Both together."""
        return Articulated(
            add_symmetric(self.inertia, other.inertia),
            _rows([add(a, b) for a, b in zip(self.coupling, other.coupling, strict=True)]),
            add_symmetric(self.mass, other.mass),
        ).named(name, definitions)

    def named(self, name: str, definitions: Definitions) -> Articulated:
        """With a symbol for every entry."""
        rows = zip(AXES, self.coupling, strict=True)
        return Articulated(
            definitions.symmetric(f"SI_{name}", self.inertia),
            _rows([definitions.vector(f"SH_{name}_{axis}", row) for axis, row in rows]),
            definitions.symmetric(f"SM_{name}", self.mass),
        )

    def eliminated(self, index: int, name: str, definitions: Definitions) -> tuple[Articulated, Elimination]:
        """What is left where component `index` is free."""
        matrix = self._matrix()
        others = [i for i in SIX if i != index and matrix[index][i] != 0]
        pivot = matrix[index][index]
        inverse = definitions.define(f"D_{name}", 1 / pivot)
        gains = {i: definitions.define(f"g_{name}_{i}", matrix[index][i] * inverse) for i in others}
        for i in others:
            for j in others:
                matrix[i][j] -= gains[min(i, j)] * matrix[index][max(i, j)]
        for i in SIX:
            matrix[index][i] = matrix[i][index] = S.Zero
        return _from_matrix(matrix).named(name, definitions), Elimination(index, name, pivot, inverse, gains)

    def down(self, turn: Turn, name: str, definitions: Definitions) -> Articulated:
        """The same from below a turn."""
        rows = [turn.down(row) for row in self.coupling]
        rows = [definitions.vector(f"SHr_{name}_{axis}", row) for axis, row in zip(AXES, rows, strict=True)]
        columns = [turn.down(Vector(rows[0][j], rows[1][j], rows[2][j])) for j in range(3)]
        return replace(
            self,
            inertia=turn.down_symmetric(definitions, f"SI_{name}", self.inertia),
            coupling=_rows([Vector(columns[0][i], columns[1][i], columns[2][i]) for i in range(3)]),
            mass=turn.down_symmetric(definitions, f"SM_{name}", self.mass),
        ).named(name, definitions)

    def shifted(self, d: Vector, name: str, definitions: Definitions) -> Articulated:
        """About an origin from which this one is {d} away.

        With [H'] = [H] + [d~][M], the inertia becomes [I] - [H][d~] + [d~][H']^T.
        """
        mass = [[getattr(self.mass, entry(i, j)) for j in range(3)] for i in range(3)]
        columns = [cross(d, Vector(*mass[j])) for j in range(3)]
        coupling = [
            definitions.vector(
                f"SH_{name}_{AXES[i]}",
                add(self.coupling[i], Vector(columns[0][i], columns[1][i], columns[2][i])),
            )
            for i in range(3)
        ]
        # Row i of -[H][d~] is (d x row i of [H]); row i of [d~][H']^T is row i of d x columns of [H']^T.
        first = [cross(d, row) for row in self.coupling]
        second = [cross(d, coupling[j]) for j in range(3)]
        inertia = Symmetric(
            **{
                name_ij: getattr(self.inertia, name_ij) + first[i][j] + second[j][i]
                for (i, j), name_ij in INDEX.items()
            }
        )
        return Articulated(inertia, _rows(coupling), self.mass).named(name, definitions)

    def _matrix(self) -> list[list[Expr]]:
        matrix = [[S.Zero] * 6 for _ in SIX]
        for (i, j), name in INDEX.items():
            matrix[i][j] = matrix[j][i] = getattr(self.inertia, name)
            matrix[3 + i][3 + j] = matrix[3 + j][3 + i] = getattr(self.mass, name)
        for i in range(3):
            for j in range(3):
                matrix[i][3 + j] = matrix[3 + j][i] = self.coupling[i][j]
        return matrix


def rigid(inertia: Inertia) -> Articulated:
    """A rigid body alone."""
    m, h = inertia.mass, inertia.moment
    coupling = (
        Vector(S.Zero, -h.z, h.y),
        Vector(h.z, S.Zero, -h.x),
        Vector(-h.y, h.x, S.Zero),
    )
    mass = Symmetric(m, m, m, S.Zero, S.Zero, S.Zero)
    return Articulated(inertia.inertia, coupling, mass)


def _from_matrix(matrix: list[list[Expr]]) -> Articulated:
    return Articulated(
        Symmetric(**{name: matrix[i][j] for (i, j), name in INDEX.items()}),
        _rows([Vector(*matrix[i][3:]) for i in range(3)]),
        Symmetric(**{name: matrix[3 + i][3 + j] for (i, j), name in INDEX.items()}),
    )


def _rows(rows: list[Vector]) -> Rows:
    return rows[0], rows[1], rows[2]
