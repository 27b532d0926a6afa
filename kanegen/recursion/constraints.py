"""Constraints on accelerations: rows [J]{ydot} + {gap} + [mu]{lambda} = {0}, held by loads {lambda}.

The loads act on [A]{ydot} = {b} + [J]^T {lambda}. With [A] = [L]^T [D] [L] and [V] = [L]^-T [J]^T, which a
solver finds by passing the unit load of each row inward along its path alone, they are the solution of

    ([V]^T [D]^-1 [V] + [mu]) {lambda} = -({gap} + [V]^T [D]^-1 [L]^-T {b}),

the Schur complement of the equations for {ydot} and {lambda} (Featherstone 2008, section 8.5; by the sparsity
of the tree: Carpentier, Budhiraja and Mansard 2021). It is factorised like [A], and rows that have no freedom
in common never meet. Then [L]^-T {b} + [V]{lambda} takes the place of [L]^-T {b}: one pass outward gives
{ydot}, and no accelerations without constraints are formed before.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from sympy import Add, Expr, Rational, S

from kanegen.recursion.inverse_dynamics import Requirement
from kanegen.recursion.reduced import Reduced
from kanegen.recursion.solver import Solver
from kanegen.recursion.vectors import Wrench, dot, scale, subtract
from kanegen.symbolic.definitions import Definitions


@dataclass(frozen=True)
class ConstraintRow:
    """One row of constraints: a direction in which bodies, or one body and the ground, do not accelerate.

    Attributes:
        loads: Force, and moment about its origin, of the unit load of the row on each body that it acts on,
            by number of the body, in its frame.
        gap: Acceleration along the row where all free components of a solver are zero, less the one that
            the row asks for (m/s^2, rad/s^2).
        damping: Acceleration with which the row gives way to a unit load (1/kg, 1/(kg m^2)).
    """

    loads: Mapping[int, Wrench]
    gap: Expr
    damping: Expr = S.Zero

    def along(self, accelerations: Mapping[int, Sequence[Expr]]) -> Expr:
        """Return the acceleration along the row.

        Args:
            accelerations: Angular acceleration, and acceleration of the origin, of each body in its frame.
        """
        return Add(
            *(
                dot(load.moment, accelerations[k][:3]) + dot(load.force, accelerations[k][3:])
                for k, load in self.loads.items()
            )
        )


class Constraints:
    """The factors of the Schur complement of some rows, which give their loads for any right side.

    Attributes:
        rows: The rows.

    Args:
        solver: The solver of [A]{ydot} = {b}.
        rows: The rows; there may be none.
    """

    def __init__(self, solver: Solver, rows: Sequence[ConstraintRow]) -> None:
        self.rows = rows
        self._definitions: Definitions = solver.tree.definitions
        self._sides = [solver.reduced_wrenches(row.loads, f"_c{i}") for i, row in enumerate(rows, start=1)]
        if rows:
            self._definitions.about("loads of the held directions")
        self._diagonal: list[Expr] = []
        self._pivots: list[Expr] = []
        self._factors: dict[tuple[int, int], Expr] = {}
        self._factorise({(i, j): self._entry(i, j) for i in range(len(rows)) for j in range(i + 1)})

    def _entry(self, i: int, j: int) -> Expr:
        """Return the acceleration along row i, or j, that a unit load along row j, or i, causes."""
        value = self._sides[i].product(self._sides[j])
        if i == j:
            value += self.rows[i].damping
        return self._definitions.define(f"cG_{i + 1}_{j + 1}", value)

    def _factorise(self, entries: dict[tuple[int, int], Expr]) -> None:
        """Factorise the Schur complement from the first row on; zeros by structure stay zeros."""
        define, count = self._definitions.define, len(self.rows)
        self._diagonal = [entries[i, i] for i in range(count)]
        for k in range(count):
            pivot = define(f"cp_{k + 1}", entries[k, k])
            self._pivots.append(pivot)
            inverse = define(f"cp_{k + 1}i", 1 / pivot) if pivot != 0 else S.Zero
            linked = [i for i in range(k + 1, count) if entries[i, k] != 0]
            for i in linked:
                self._factors[i, k] = define(f"cl_{i + 1}_{k + 1}", entries[i, k] * inverse)
            for i in linked:
                for j in linked:
                    if j <= i:
                        value = entries[i, j] - self._factors[i, k] * entries[j, k]
                        entries[i, j] = define(f"cG_{i + 1}_{j + 1}_{k + 1}", value)

    def loads(self, right_side: Reduced, gaps: Sequence[Expr], name: str) -> list[Expr]:
        """Return the loads {lambda} by row.

        Args:
            right_side: The right side {b}, eliminated.
            gaps: Gap by row.
            name: Prefix of the names of the loads.
        """
        define, count = self._definitions.define, len(self.rows)
        if count:
            self._definitions.about("loads of the held directions")
        right: list[Expr] = []
        for i, (side, gap) in enumerate(zip(self._sides, gaps, strict=True)):
            known = Add(*(self._factors.get((i, j), S.Zero) * right[j] for j in range(i)))
            right.append(define(f"cr_{i + 1}", -gap - side.product(right_side) - known))
        found: dict[int, Expr] = {}
        for i in reversed(range(count)):
            known = Add(*(self._factors.get((j, i), S.Zero) * found[j] for j in range(i + 1, count)))
            inverse = define(f"cp_{i + 1}i", 1 / self._pivots[i])
            found[i] = define(f"{name}_{i + 1}", right[i] * inverse - known)
        return [found[i] for i in range(count)]

    def added(self, right_side: Reduced, loads: Sequence[Expr]) -> Mapping[int, Expr]:
        """Return the right side {b} with the loads, eliminated, over the pivots by place in {y}."""
        result = dict(right_side.over_pivots)
        for side, load in zip(self._sides, loads, strict=True):
            for place, value in side.over_pivots.items():
                result[place] += value * load
        return result

    def gaps(self, accelerations: Mapping[int, Sequence[Expr]], loads: Sequence[Expr]) -> list[Expr]:
        """Return the gaps that accelerations and loads leave over, by row.

        Args:
            accelerations: Angular acceleration, and acceleration of the origin, of each body in its frame, as
                the free components cause them.
            loads: Loads by row.
        """
        pairs = enumerate(zip(self.rows, loads, strict=True), start=1)
        return [
            self._definitions.define(f"cd_{i}", row.gap + row.along(accelerations) + row.damping * load)
            for i, (row, load) in pairs
        ]

    def without_loads(self, bias: Requirement, loads: Sequence[Expr]) -> Requirement:
        """Return what is required of the bodies and motors beside the loads of the rows."""
        wrenches = list(bias.wrenches)
        for row, load in zip(self.rows, loads, strict=True):
            for k, unit in row.loads.items():
                needed = wrenches[k - 1]
                force = subtract(needed.force, scale(load, unit.force))
                moment = subtract(needed.moment, scale(load, unit.moment))
                wrenches[k - 1] = Wrench(force, moment).named(f"{k}own", self._definitions)
        return replace(bias, wrenches=wrenches)

    def independent_if_positive(self, share: Rational) -> list[Expr]:
        """Return by row what its pivot exceeds a share of the acceleration of the row alone by.

        Where rows depend on each other, the pivot of one of them is nothing but rounding.
        """
        pairs = enumerate(zip(self._pivots, self._diagonal, strict=True))
        return [pivot if pivot == whole else self._margin(i, share) for i, (pivot, whole) in pairs]

    def accurate_if_positive(self, share: Rational, damped: Rational) -> list[Expr]:
        """Return the same for the loads to be accurate; a one for rows that lose nothing.

        Args:
            share: The share for rows without damping.
            damped: The share for rows with damping, whose pivots may be small.
        """
        pairs = enumerate(zip(self._pivots, self._diagonal, strict=True))
        return [
            S.One if pivot == whole else self._margin(i, damped if self.rows[i].damping != 0 else share)
            for i, (pivot, whole) in pairs
        ]

    def _margin(self, i: int, share: Rational) -> Expr:
        """Return what the pivot of a row exceeds a share of the acceleration of the row alone by."""
        margin = self._pivots[i] - share * self._diagonal[i]
        return self._definitions.define(f"cm_{i + 1}", margin)
