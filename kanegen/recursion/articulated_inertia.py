"""Articulated inertia: the wrench on a body with all bodies outward, as a function of its acceleration.

Moment {N} and force {F} about an origin are linear in the angular acceleration and the acceleration of that
origin,

    {N; F} = [S] {alpha; a} + {p},

with a symmetric [S] of rows and columns 0-2 for rotation and 3-5 for translation. Where a component of the
acceleration is free, its row is solved for the component, and the Schur complement passes inward
(Featherstone 2008, section 7.3). An eliminated component leaves exact zeros in [S] and its generalized force
in {p}. [S] depends on {x} alone, so one elimination serves any number of {p}.

With the armature a of a motor at the joint, the component q of index i needs the effort a q more, so that
[S]_i {alpha; a} + {p}_i + a q is the effort, where q is what the joint adds to the acceleration of the frame
below. Then the pivot is [S]_ii + a, and a share a / ([S]_ii + a) of row and column i remains: a motor with a
large armature holds its joint. No difference is formed for it. Rotors with the angular momentum {h} q,
carried below or above the joint, add {h} q to the moment below it and {h}^T {alpha} to the effort, so that
{h} is added to the row that is solved.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from sympy import Expr, S

from kanegen.recursion.inertia import Inertia
from kanegen.recursion.turns import Turn
from kanegen.recursion.vectors import INDEX, Rows, Wrench, add, add_symmetric, cross, entry
from kanegen.symbolic.definitions import AXES, Definitions, Symmetric, Vector

SIX = range(6)


@dataclass(frozen=True)
class Elimination:
    """The elimination of a free component of the acceleration.

    Attributes:
        index: The component, 0-2 for rotation and 3-5 for translation.
        name: Suffix of the names of intermediates.
        pivot: Diagonal entry of [S] of the component, plus armature; positive, or [A] is singular.
        inverse: Reciprocal of the pivot.
        gains: Entries of its row of [S], with the momentum of rotors, over the pivot, by index of the other
            component.
        own_gain: The same for the component itself: 1 without armature.
        kept: 1 less `own_gain`: armature over the pivot, if there is no rotor.
    """

    index: int
    name: str
    pivot: Expr
    inverse: Expr
    gains: dict[int, Expr]
    own_gain: Expr
    kept: Expr

    def eliminate(self, bias: Wrench, effort: Expr, definitions: Definitions) -> tuple[Wrench, Expr]:
        """Eliminate the component from {p}.

        Args:
            bias: The wrench {p}.
            effort: Generalized force along the component.
            definitions: Definitions that the intermediates are added to.

        Returns:
            The rest of {p}, and the value of the component where all others are zero.
        """
        left = [*bias.moment, *bias.force]
        surplus = definitions.define(f"e_{self.name}", effort - left[self.index])
        alone = definitions.define(f"n_{self.name}", surplus * self.inverse)
        for i, gain in self.gains.items():
            left[i] += gain * surplus
        left[self.index] = effort - self.kept * surplus  # what the joint transmits along the component
        return Wrench(Vector(*left[3:]), Vector(*left[:3])).named(self.name, definitions), alone

    def solve(self, alone: Expr, acceleration: Sequence[Expr], definitions: Definitions) -> tuple[Expr, Expr]:
        """Return the component of the acceleration above the joint, and what the joint adds to that below.

        Args:
            alone: Value of the component where all others are zero.
            acceleration: Acceleration below the joint.
            definitions: Definitions that the intermediates are added to.
        """
        by_others = alone - sum(gain * acceleration[i] for i, gain in self.gains.items())
        below = acceleration[self.index]
        if self.kept == 0:
            total = definitions.define(f"q_{self.name}", by_others)
            return total, total - below
        by_others = definitions.define(f"qo_{self.name}", by_others)
        total = definitions.define(f"q_{self.name}", by_others + self.kept * below)
        return total, by_others - self.own_gain * below


@dataclass(frozen=True)
class ArticulatedInertia:
    """The matrix [S] in blocks.

    Attributes:
        inertia: Moment by angular acceleration (kg m^2).
        coupling: Rows of moment by acceleration of the origin (kg m).
        mass: Force by acceleration of the origin (kg).
        letter: Beginning of the names of intermediates.
    """

    inertia: Symmetric
    coupling: Rows
    mass: Symmetric
    letter: str = "S"

    def plus(self, other: ArticulatedInertia, name: str, definitions: Definitions) -> ArticulatedInertia:
        """Return the sum of this matrix and another, with a symbol for every entry."""
        return ArticulatedInertia(
            add_symmetric(self.inertia, other.inertia),
            _rows([add(a, b) for a, b in zip(self.coupling, other.coupling, strict=True)]),
            add_symmetric(self.mass, other.mass),
            self.letter,
        ).named(name, definitions)

    def named(self, name: str, definitions: Definitions) -> ArticulatedInertia:
        """Return the same matrix with a symbol for every entry."""
        rows, letter = zip(AXES, self.coupling, strict=True), self.letter
        return ArticulatedInertia(
            definitions.symmetric(f"{letter}I_{name}", self.inertia),
            _rows([definitions.vector(f"{letter}H_{name}_{axis}", row) for axis, row in rows]),
            definitions.symmetric(f"{letter}M_{name}", self.mass),
            letter,
        )

    def eliminated(
        self, index: int, motor: tuple[Expr, Vector], name: str, definitions: Definitions
    ) -> tuple[ArticulatedInertia, Elimination]:
        """Return the matrix after the elimination of a free component, and the elimination.

        Args:
            index: The component, 0-2 for rotation and 3-5 for translation.
            motor: Reflected inertia of the motor of the component (kg m^2, kg), as in `FreeComponent`, and
                angular momentum of rotors for unit rate.
            name: Suffix of the names of intermediates.
            definitions: Definitions that the intermediates are added to.
        """
        (armature, momentum), matrix = motor, self.matrix()
        spin = (*momentum, S.Zero, S.Zero, S.Zero)
        row = [
            definitions.define(f"sr_{name}_{i}", entry + spin[i]) if spin[i] != 0 else entry
            for i, entry in enumerate(matrix[index])
        ]
        others = [i for i in SIX if i != index and row[i] != 0]
        pivot, own_gain, kept = matrix[index][index], S.One, S.Zero
        if armature != 0:
            pivot = definitions.define(f"D_{name}", pivot + armature)
        inverse = definitions.define(f"D_{name}i", 1 / pivot)
        gains = {i: definitions.define(f"g_{name}_{i}", row[i] * inverse) for i in others}
        if armature != 0:
            own_gain = definitions.define(f"g_{name}_{index}", row[index] * inverse)
            kept = definitions.define(f"gk_{name}", (armature - spin[index]) * inverse)
        for i in others:
            for j in others:
                matrix[i][j] -= gains[min(i, j)] * row[max(i, j)]
        for i in SIX:
            matrix[index][i] = matrix[i][index] = kept * matrix[index][i] - own_gain * spin[i]
        found = Elimination(index, name, pivot, inverse, gains, own_gain, kept)
        return from_matrix(matrix).named(name, definitions), found

    def less(
        self, column: Sequence[Expr], gains: Mapping[int, Expr], name: str, definitions: Definitions
    ) -> ArticulatedInertia:
        """Return the matrix less the product of a column and its gains, by index of the component."""
        matrix = self.matrix()
        for i in gains:
            for j in gains:
                matrix[i][j] -= gains[min(i, j)] * column[max(i, j)]
        return from_matrix(matrix).named(name, definitions)

    def down(self, turn: Turn, name: str, definitions: Definitions) -> ArticulatedInertia:
        """Return the matrix in components of the frame below a turn."""
        rows, letter = [turn.down(row) for row in self.coupling], self.letter
        turned = zip(AXES, rows, strict=True)
        rows = [definitions.vector(f"{letter}Hr_{name}_{axis}", row) for axis, row in turned]
        columns = [turn.down(Vector(rows[0][j], rows[1][j], rows[2][j])) for j in range(3)]
        return replace(
            self,
            inertia=turn.down_symmetric(definitions, f"{letter}I_{name}", self.inertia),
            coupling=_rows([Vector(columns[0][i], columns[1][i], columns[2][i]) for i in range(3)]),
            mass=turn.down_symmetric(definitions, f"{letter}M_{name}", self.mass),
        ).named(name, definitions)

    def shifted(self, d: Vector, name: str, definitions: Definitions) -> ArticulatedInertia:
        """Return the matrix about another origin, from which {d} leads to the current one.

        With [H'] = [H] + [d~][M], the inertia becomes [I] - [H][d~] + [d~][H']^T.
        """
        mass = [[getattr(self.mass, entry(i, j)) for j in range(3)] for i in range(3)]
        columns = [cross(d, Vector(*mass[j])) for j in range(3)]
        coupling = [
            definitions.vector(
                f"{self.letter}H_{name}_{AXES[i]}",
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
        moved = ArticulatedInertia(inertia, _rows(coupling), self.mass, self.letter)
        return moved.named(name, definitions)

    def matrix(self) -> list[list[Expr]]:
        """Return [S] row by row."""
        matrix = [[S.Zero] * 6 for _ in SIX]
        for (i, j), name in INDEX.items():
            matrix[i][j] = matrix[j][i] = getattr(self.inertia, name)
            matrix[3 + i][3 + j] = matrix[3 + j][3 + i] = getattr(self.mass, name)
        for i in range(3):
            for j in range(3):
                matrix[i][3 + j] = matrix[3 + j][i] = self.coupling[i][j]
        return matrix


def rigid_body(inertia: Inertia) -> ArticulatedInertia:
    """Return the articulated inertia of a rigid body alone."""
    m, h = inertia.mass, inertia.moment
    coupling = (
        Vector(S.Zero, -h.z, h.y),
        Vector(h.z, S.Zero, -h.x),
        Vector(-h.y, h.x, S.Zero),
    )
    mass = Symmetric(m, m, m, S.Zero, S.Zero, S.Zero)
    return ArticulatedInertia(inertia.inertia, coupling, mass)


def from_matrix(matrix: Sequence[Sequence[Expr]], letter: str = "S") -> ArticulatedInertia:
    """Return the blocks of [S]; `letter` as for `ArticulatedInertia`."""
    return ArticulatedInertia(
        Symmetric(**{name: matrix[i][j] for (i, j), name in INDEX.items()}),
        _rows([Vector(*matrix[i][3:]) for i in range(3)]),
        Symmetric(**{name: matrix[3 + i][3 + j] for (i, j), name in INDEX.items()}),
        letter,
    )


def _rows(rows: list[Vector]) -> Rows:
    """Return three rows as a matrix."""
    return rows[0], rows[1], rows[2]
