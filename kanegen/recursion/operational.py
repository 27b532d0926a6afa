"""Operational inertia of frames: how the acceleration of a frame follows from a wrench on it, and inversely.

A wrench {w} on a frame, a moment and a force at its origin, adds J [A]^-1 J^T {w} to the acceleration {a} of
the frame, with its Jacobian J of `frame_jacobians`. With [Lambda] = (J [A]^-1 J^T)^-1, the operational
inertia,

    [Lambda] {a} + {bias} = {w},    {bias} = -[Lambda] {a_0},

where {a_0} is the acceleration without the wrench, under gravity, loads, {tau} and {y}. For {tau} = 0 the
bias is the sum mu + p of Khatib (1987, "A unified approach for motion and force control of robot
manipulators").

J [A]^-1 J^T needs no [A]^-1: its entries are products of unit moments and forces on the frame that a solver
has eliminated, see `reduced`. It exists where [A] is regular. [Lambda] also needs six independent
accelerations of the frame. It comes from the factors of J [A]^-1 J^T, whose pivots are by row what the rows
below leave free.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from sympy import Expr, Rational

from kanegen.recursion.attached import BodyVector, acceleration, inertial
from kanegen.recursion.body_motion import BodyMotion
from kanegen.recursion.constants import exact
from kanegen.recursion.frame_motion import frame_origins
from kanegen.recursion.reduced import Reduced
from kanegen.recursion.solver import Solver
from kanegen.recursion.symmetric_factors import factorised, inverse_from_factors
from kanegen.recursion.vectors import ZERO
from kanegen.symbolic.definitions import Vector

ROWS = range(6)
"""Rows of a frame: moments and angular accelerations, then forces and linear ones, in inertial components."""


@dataclass(frozen=True)
class FrameInertia:
    """The operational inertia of a frame.

    Attributes:
        entries: Entries of [Lambda], row by row.
        independent: By row the pivot of its inverse, less what it has by rounding. The pivot is what the row
            has left where the rows below it are held. Positive where [Lambda] exists.
        accurate: By row a quantity that is positive where [Lambda] is accurate.
    """

    entries: Sequence[Sequence[Expr]]
    independent: Sequence[Expr]
    accurate: Sequence[Expr]


class Operational:
    """Operational inertias and biases of the frames that a system selects, each derived when it is needed.

    Args:
        solver: The factorised [A].
        rounding: Share of a diagonal entry of J [A]^-1 J^T that its pivot has by rounding alone.
        amplification: Largest product of a diagonal entry of [Lambda] and that of its inverse with which
            [Lambda] counts as accurate; roundoffs of its inverse grow by about this product.
    """

    def __init__(self, solver: Solver, rounding: float, amplification: float) -> None:
        self._solver, self._tree = solver, solver.tree
        self._rounding, self._amplification = Rational(rounding), Rational(amplification)
        self._frames = frame_origins(solver.tree)

    @cached_property
    def _loads(self) -> list[Sequence[Reduced]]:
        """Unit moments and forces on each frame, eliminated."""
        return [self._solver.reduced_loads(one) for one in self._frames]

    @cached_property
    def inverses(self) -> list[list[list[Expr]]]:
        """Entries of J [A]^-1 J^T of each frame, row by row; both halves hold the same symbols."""
        return [self._inverse(number, loads) for number, loads in enumerate(self._loads, start=1)]

    def _inverse(self, number: int, loads: Sequence[Reduced]) -> list[list[Expr]]:
        """Return the entries of J [A]^-1 J^T of one frame."""
        self._tree.definitions.about(f"J [A]^-1 J^T of frame {number}")
        found: dict[tuple[int, int], Expr] = {}
        for i in ROWS:
            for j in range(i + 1):
                value = self._tree.definitions.define(f"Li_{number}_{i}{j}", loads[i].product(loads[j]))
                found[i, j] = found[j, i] = value
        return [[found[i, j] for j in ROWS] for i in ROWS]

    @cached_property
    def inertias(self) -> list[FrameInertia]:
        """The operational inertia of each frame."""
        return [self._inertia(number, inverse) for number, inverse in enumerate(self.inverses, start=1)]

    def _inertia(self, number: int, inverse: Sequence[Sequence[Expr]]) -> FrameInertia:
        """Return the operational inertia of one frame."""
        definitions = self._tree.definitions
        definitions.about(f"operational inertia of frame {number}")
        with definitions.marking(f"_f{number}"):
            order = {i: list(reversed(range(i))) for i in reversed(ROWS)}
            entries = {(i, j): inverse[i][j] for i in ROWS for j in ROWS}
            factors, pivots = factorised(entries, order, definitions)
            reciprocals = {i: definitions.define(f"D_{i}i", 1 / pivot) for i, pivot in pivots.items()}
            found = inverse_from_factors(factors, reciprocals, ROWS, definitions)
        independent, accurate = [], []
        for i in ROWS:
            whole, pivot = inverse[i][i], pivots[i]
            left = pivot if pivot == whole else pivot - self._rounding * whole
            independent.append(definitions.define(f"Le_{number}_{i}", left))
            loss = definitions.define(f"Ll_{number}_{i}", found[i, i] * whole)
            accurate.append(definitions.define(f"Lm_{number}_{i}", self._amplification - loss))
        return FrameInertia([[found[i, j] for j in ROWS] for i in ROWS], independent, accurate)

    def biases(self, side: Reduced, motions: Mapping[int, BodyMotion]) -> list[list[Expr]]:
        """Return the entries of -[Lambda] {a_0} of each frame.

        Args:
            side: The right side of [A]{ydot} = {f} + {tau}, eliminated.
            motions: Motion of the bodies where all free components are zero.
        """
        definitions, result = self._tree.definitions, []
        free = self._free_accelerations(side, motions)
        for number, (one, a) in enumerate(zip(self.inertias, free, strict=True), start=1):
            definitions.about(f"operational bias of frame {number}")
            rows = [sum((-entry * part for entry, part in zip(row, a, strict=True))) for row in one.entries]
            result.append([definitions.define(f"Lb_{number}_{i}", row) for i, row in enumerate(rows)])
        return result

    def _free_accelerations(self, side: Reduced, motions: Mapping[int, BodyMotion]) -> list[list[Expr]]:
        """Return the acceleration {a_0} of each frame without a wrench on it."""
        definitions, gravity = self._tree.definitions, [exact(value) for value in self._tree.system.gravity]
        turning, sliding = [], []
        for one in self._frames:
            moved = motions[one.body]
            what = f"angular acceleration of frame {one.number}"
            turning.append(BodyVector(one.body, f"ef_{one.number}", what, moved.alpha))
            sliding.append(acceleration(self._tree, one, moved))
        found = inertial(self._tree, [*turning, *sliding])
        result = []
        for number, loads in enumerate(self._loads):
            definitions.about(f"acceleration of frame {number + 1} without a load on it")
            start = [*found[number], *found[len(self._frames) + number]]
            weight = [*ZERO, *Vector(*gravity)]
            values = (a + load.product(side) + g for a, load, g in zip(start, loads, weight, strict=True))
            result.append([definitions.define(f"La_{number + 1}_{i}", v) for i, v in enumerate(values)])
        return result
