"""Entries of {y} that move several freedoms, as further unknowns of articulated bodies.

A plain freedom is eliminated where its joint stands. An entry i of {y} that moves several freedoms, because
some of them are coupled, stays unknown until all of these freedoms are outward. Up to there the wrench on a
body, and the generalized force that entry i requires, are linear in {ydot}_i, too:

    {N; F} = [S] {alpha; a} + sum_i {c_i} ydot_i + {p},
    tau_i = {c_i} . {alpha; a} + sum_j d_ij ydot_j + e_i.

Where a freedom adds a_i ydot_i to component q of the acceleration, {c_i} grows by a_i times column q of [S],
and d_ij by what this adds to the generalized force. At last entry i is solved for as a component is, with the
pivot d_ii.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from sympy import Expr, S

from kanegen.recursion.articulated_inertia import ArticulatedInertia, Elimination
from kanegen.recursion.turns import Turn
from kanegen.recursion.vectors import Wrench, add, cross
from kanegen.symbolic.definitions import Definitions, Vector

Six = tuple[Expr, ...]
"""Moment and force for unit acceleration, or the coefficients of an angular and a linear acceleration."""

SIX = range(6)


@dataclass(frozen=True)
class SharedElimination:
    """The elimination of an entry of {y} that moves several freedoms.

    Attributes:
        place: Its place in {y}.
        pivot: The entry d_ii; positive, or [A] is singular.
        inverse: Reciprocal of the pivot.
        gains: Entries of {c_i} over the pivot, by index of the component.
        shared_gains: Entries d_ij over the pivot, by place in {y} of those that are still unknown.
    """

    place: int
    pivot: Expr
    inverse: Expr
    gains: Mapping[int, Expr]
    shared_gains: Mapping[int, Expr]

    def eliminate(
        self, bias: Wrench, required: Mapping[int, Expr], effort: Expr, definitions: Definitions
    ) -> tuple[Wrench, dict[int, Expr], Expr]:
        """Eliminate the entry from {p} and from the generalized forces e_j.

        Args:
            bias: The wrench {p}.
            required: Generalized forces e_j by place in {y}.
            effort: Generalized force of the entry.
            definitions: Definitions that the intermediates are added to.

        Returns:
            The rest of {p}, the rest of e_j, and the value of the entry where all others are zero.
        """
        name, left = f"{self.place}", [*bias.moment, *bias.force]
        surplus = definitions.define(f"e_{name}", effort - required.get(self.place, S.Zero))
        for i, gain in self.gains.items():
            left[i] += gain * surplus
        rest = {j: value for j, value in required.items() if j != self.place}
        for j, gain in self.shared_gains.items():
            rest[j] = definitions.define(f"er_{name}_{j}", rest.get(j, S.Zero) + gain * surplus)
        alone = definitions.define(f"n_{name}", surplus * self.inverse)
        return Wrench(Vector(*left[3:]), Vector(*left[:3])).named(name, definitions), rest, alone

    def solve(self, alone: Expr, acceleration: Sequence[Expr], found: Mapping[int, Expr]) -> Expr:
        """Return the entry of {ydot}.

        Args:
            alone: Its value where everything else is zero.
            acceleration: Acceleration of the body where it was eliminated.
            found: Entries of {ydot} by place; they were eliminated further inward.
        """
        by_body = sum((gain * acceleration[i] for i, gain in self.gains.items()), S.Zero)
        return alone - by_body - sum((gain * found[j] for j, gain in self.shared_gains.items()), S.Zero)


@dataclass(frozen=True)
class SharedRates:
    """The columns {c_i} and entries d_ij of the entries of {y} that are still unknown.

    Attributes:
        columns: Six components of each column, moment and force, by place in {y}.
        products: Entries d_ij by pair of places, the larger first.
        letter: Beginning of the names of intermediates.
    """

    columns: Mapping[int, Six] = field(default_factory=dict)
    products: Mapping[tuple[int, int], Expr] = field(default_factory=dict)
    letter: str = "y"

    def product(self, i: int, j: int) -> Expr:
        """Return the entry d_ij of two places in {y}."""
        return self.products.get((max(i, j), min(i, j)), S.Zero)

    def plus(self, other: SharedRates, name: str, definitions: Definitions) -> SharedRates:
        """Return the sum with the unknowns of another body that has the same frame and origin."""
        columns, products = dict(self.columns), dict(self.products)
        for i, column in other.columns.items():
            columns[i] = _sum(columns.get(i, (S.Zero,) * 6), column)
        for pair, value in other.products.items():
            products[pair] = products.get(pair, S.Zero) + value
        return self._named(columns, products, name, definitions)

    def down(self, turn: Turn, name: str, definitions: Definitions) -> SharedRates:
        """Return the unknowns in components of the frame below a turn."""
        turned = {
            i: (*turn.down(Vector(*column[:3])), *turn.down(Vector(*column[3:])))
            for i, column in self.columns.items()
        }
        return self._named(turned, self.products, name, definitions)

    def shifted(self, d: Vector, name: str, definitions: Definitions) -> SharedRates:
        """Return the unknowns about another origin, from which {d} leads to the current one."""
        shifted = {
            i: (*add(Vector(*column[:3]), cross(d, Vector(*column[3:]))), *column[3:])
            for i, column in self.columns.items()
        }
        return self._named(shifted, self.products, name, definitions)

    def moving(
        self,
        index: int,
        shares: Mapping[int, Expr],
        armature: Expr,
        body: ArticulatedInertia,
        name: str,
        definitions: Definitions,
    ) -> SharedRates:
        """Return the unknowns below a freedom that some of them move.

        Args:
            index: Component of the acceleration along the freedom, 0-2 for rotation and 3-5 for translation.
            shares: Factors by place in {y}.
            armature: Reflected inertia of the motor of the freedom (kg m^2, kg).
            body: The articulated inertia above the freedom.
            name: Suffix of the names of intermediates.
            definitions: Definitions that the intermediates are added to.
        """
        matrix = body.matrix()
        own = {i: self.columns.get(i, (S.Zero,) * 6) for i in sorted({*self.columns, *shares})}
        columns, products = {}, {}
        for i, column in own.items():
            share = shares.get(i, S.Zero)
            columns[i] = tuple(column[k] + share * matrix[index][k] for k in SIX)
            for j, other in own.items():
                if j <= i:
                    factor = shares.get(j, S.Zero)
                    added = factor * column[index] + share * other[index]
                    added += share * factor * (matrix[index][index] + armature)
                    products[i, j] = self.product(i, j) + added
        return self._named(columns, products, name, definitions)

    def below(
        self, found: Elimination, name: str, definitions: Definitions
    ) -> tuple[SharedRates, dict[int, Expr]]:
        """Return the unknowns after the elimination of a free component, and their gains by place in {y}."""
        index = found.index
        gains = {
            i: definitions.define(f"gy_{name}_{i}", column[index] * found.inverse)
            for i, column in self.columns.items()
            if column[index] != 0
        }
        columns = {}
        for i, column in self.columns.items():
            rest = [one - found.gains.get(k, S.Zero) * column[index] for k, one in enumerate(column)]
            rest[index] = found.kept * column[index]
            columns[i] = tuple(rest)
        products = {
            (i, j): self.product(i, j) - gains.get(i, S.Zero) * column[index]
            for j, column in self.columns.items()
            for i in self.columns
            if j <= i
        }
        return self._named(columns, products, name, definitions), gains

    def solved(
        self, place: int, body: ArticulatedInertia, definitions: Definitions
    ) -> tuple[SharedRates, ArticulatedInertia, SharedElimination]:
        """Return the other unknowns and the body after the elimination of an entry of {y}."""
        name, column = f"{place}", self.columns[place]
        pivot = definitions.define(f"D_{name}", self.product(place, place))
        inverse = definitions.define(f"D_{name}i", 1 / pivot)
        others = [i for i in self.columns if i != place]
        row = {i: self.product(i, place) for i in others}
        shared_gains = {
            i: definitions.define(f"gy_{name}_{i}", value * inverse) for i, value in row.items() if value != 0
        }
        gains = {
            k: definitions.define(f"g_{name}_{k}", one * inverse) for k, one in enumerate(column) if one != 0
        }
        columns = {
            i: tuple(one - shared_gains.get(i, S.Zero) * column[k] for k, one in enumerate(self.columns[i]))
            for i in others
        }
        products = {
            (i, j): self.product(i, j) - shared_gains.get(i, S.Zero) * row[j]
            for i in others
            for j in others
            if j <= i
        }
        rest = self._named(columns, products, name, definitions)
        found = SharedElimination(place, pivot, inverse, gains, shared_gains)
        return rest, body.less(column, gains, name, definitions), found

    def _named(
        self,
        columns: Mapping[int, Six],
        products: Mapping[tuple[int, int], Expr],
        name: str,
        definitions: Definitions,
    ) -> SharedRates:
        """Return other unknowns of the same kind with a symbol for every entry."""
        symbols = {
            i: (
                *definitions.vector(f"{self.letter}N_{i}_{name}", Vector(*column[:3])),
                *definitions.vector(f"{self.letter}F_{i}_{name}", Vector(*column[3:])),
            )
            for i, column in columns.items()
        }
        entries = {
            (i, j): definitions.define(f"{self.letter}D_{i}_{j}", value) for (i, j), value in products.items()
        }
        return SharedRates(symbols, entries, self.letter)


def _sum(one: Six, other: Six) -> Six:
    """Return the sum of two columns, component by component."""
    return tuple(a + b for a, b in zip(one, other, strict=True))
