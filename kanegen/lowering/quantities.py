"""Quantities that are differentiated along a direction, or as a weighted sum, without their Jacobian.

`Explicit` differentiates a program instruction by instruction. `Solved` is the solution {ydot} of inverse
dynamics ID(x, y, ydot) = {tau}: by the implicit function theorem, [A] times the derivative of {ydot} along a
direction is the change of {tau} less that of ID at constant {ydot}. A sum of {ydot} with the weights {w} has
the gradient -{lambda}^T dID with [A]{lambda} = {w}, and [A] times the derivative of {lambda} along a
direction is -d[A]{lambda}. All products with [A]^-1 are derivatives of the program of {ydot} along a change
of {tau} alone: sweeps through the tree that share its factors (Giles 2008; Carpentier and Mansard 2018).

`InComponents` is {ydot} of a system whose joints with three free angles are solved in components of angular
velocities, where [A] is regular; maps lead from the rates of the angles to these components and back.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

from kanegen.lowering.embedded import Column, Columns, Embedded, gradient
from kanegen.program.builder import Builder
from kanegen.program.constants import Constants
from kanegen.program.ir import Program

Given = Mapping[str, Sequence[int]]
"""Values of a builder for the elements of input arrays, by name of the array."""


class Quantity(Protocol):
    """One or more arrays that are differentiated."""

    def values(self, name: str) -> list[int]:
        """Return the elements of an array."""

    def along(self, direction: Columns) -> dict[str, Column]:
        """Return the derivatives of the arrays along a direction of the variables."""

    def gradient(self, weights: Columns) -> dict[str, Column]:
        """Return the derivatives of a weighted sum of all elements by the variables, by array of these.

        Args:
            weights: The weights by array.
        """

    def gradient_along(self, weights: Columns, change: Columns, direction: Columns) -> dict[str, Column]:
        """Return the derivatives of the gradient along a direction.

        Args:
            weights: The weights by array.
            change: Their derivatives along the direction; arrays that are absent stay as they are.
            direction: The direction of the variables.
        """


class Columnwise:
    """Sums of columns, in a builder.

    Args:
        builder: The builder.
        constants: The arithmetic of constants.
    """

    def __init__(self, builder: Builder, constants: Constants) -> None:
        self._builder = builder
        self._zero = builder.constant(constants.quotient(0, 1))

    def sum(self, *columns: Sequence[int | None]) -> Column:
        """Return the sum of columns."""
        result: Column = list(columns[0])
        for column in columns[1:]:
            for i, value in enumerate(column):
                own = result[i]
                if value is not None:
                    result[i] = value if own is None else self._builder.add(own, value)
        return result

    def negative(self, column: Sequence[int | None]) -> Column:
        """Return the negative of a column."""
        return [None if value is None else self._builder.negate(value) for value in column]

    def values(self, column: Sequence[int | None]) -> list[int]:
        """Return a column with zeros as values."""
        return [self._zero if value is None else value for value in column]

    def merged(self, *parts: Columns) -> dict[str, Column]:
        """Return the sums of columns of the same name."""
        result: dict[str, Column] = {}
        for part in parts:
            for name, column in part.items():
                result[name] = self.sum(result[name], column) if name in result else list(column)
        return result


@dataclass(frozen=True, eq=False)
class Explicit:
    """The outputs of a program, differentiated instruction by instruction.

    Attributes:
        builder: The builder.
        program: The program.
        constants: The arithmetic of constants.
        by: Names of the input arrays by which weighted sums are differentiated.
        given: Values for some inputs.
    """

    builder: Builder
    program: Program
    constants: Constants
    by: Collection[str]
    given: Given

    def values(self, name: str) -> list[int]:
        """Return the elements of an output."""
        return self._embedded.values(name)

    def along(self, direction: Columns) -> dict[str, Column]:
        """Return the derivatives of the outputs along a direction."""
        return self._embedded.tangents(direction, self._names)

    def gradient(self, weights: Columns) -> dict[str, Column]:
        """Return the derivatives of a weighted sum of elements."""
        return self._embedded.adjoints(weights, self.by)

    def gradient_along(self, weights: Columns, change: Columns, direction: Columns) -> dict[str, Column]:
        """Return the derivatives of the gradient along a direction."""
        columns = Columnwise(self.builder, self.constants)
        program = gradient(self.program, self._names, self.by, self.constants)
        given = {f"{name}_weights": columns.values(column) for name, column in weights.items()}
        embedded = Embedded(self.builder, program, self.constants, {**self.given, **given})
        along = {**direction, **{f"{name}_weights": column for name, column in change.items()}}
        return gradient_tangents(embedded, program, along)

    @cached_property
    def _embedded(self) -> Embedded:
        return Embedded(self.builder, self.program, self.constants, self.given)

    @property
    def _names(self) -> list[str]:
        return [output.array.name for output in self.program.outputs]


def gradient_tangents(embedded: Embedded, program: Program, direction: Columns) -> dict[str, Column]:
    """Return the derivatives of a gradient along a direction, by variable.

    Args:
        embedded: The program of the gradient in a builder.
        program: The program, from `embedded.gradient`.
        direction: The direction.
    """
    names = [output.array.name for output in program.outputs]
    found = embedded.tangents(direction, names)
    return {name.removesuffix("_gradient"): column for name, column in found.items()}


ACCELERATION, NEEDED = "acceleration", "generalized_force"
"""Names of the output arrays of forward and inverse dynamics."""


@dataclass(frozen=True, eq=False)
class Solved:
    """The solution {ydot} of inverse dynamics.

    Attributes:
        builder: The builder.
        solver: The program of {ydot}.
        inverse: The program of inverse dynamics.
        constants: The arithmetic of constants.
        by: Names of the input arrays by which weighted sums are differentiated, among them {tau}.
        given: Values for some inputs.
    """

    builder: Builder
    solver: Program
    inverse: Program
    constants: Constants
    by: Collection[str]
    given: Given

    def values(self, name: str = ACCELERATION) -> list[int]:
        """Return the elements of {ydot} as values."""
        return self._forward.values(name)

    def along(self, direction: Columns) -> dict[str, Column]:
        """Return the derivatives of {ydot} along a direction."""
        others = {name: column for name, column in direction.items() if name != "tau"}
        needed = self._columns.negative(self._inverse.tangents(others, [NEEDED])[NEEDED])
        tau = direction.get("tau", [None] * len(needed))
        return {ACCELERATION: self._solution(self._columns.sum(tau, needed))}

    def gradient(self, weights: Columns) -> dict[str, Column]:
        """Return the derivatives of a weighted sum of {ydot}."""
        multipliers = self._solution(weights[ACCELERATION])
        found = self._inverse.adjoints({NEEDED: multipliers}, self._by_others)
        changes = {name: self._columns.negative(column) for name, column in found.items()}
        return {**changes, "tau": multipliers}

    def gradient_along(self, weights: Columns, change: Columns, direction: Columns) -> dict[str, Column]:
        """Return the derivatives of the gradient along a direction."""
        columns, by = self._columns, [*self._by_others, "ydot"]
        others = {name: column for name, column in direction.items() if name != "tau"}
        multipliers = self._solution(weights[ACCELERATION])
        program = gradient(self.inverse, [NEEDED], by, self.constants)
        lagged, key = columns.values(multipliers), f"{NEEDED}_weights"
        given = {**self.given, "ydot": self.values(), key: lagged}
        embedded = Embedded(self.builder, program, self.constants, given, solved=True)
        change_of_matrix = embedded.tangents(others, ["ydot_gradient"])["ydot_gradient"]
        right = columns.negative(change_of_matrix)
        if ACCELERATION in change:
            right = columns.sum(right, change[ACCELERATION])
        multipliers_along = self._solution(right)
        whole = {**others, "ydot": self.along(direction)[ACCELERATION], key: multipliers_along}
        found = gradient_tangents(embedded, program, whole)
        return {
            **{name: columns.negative(found[name]) for name in self._by_others if name in found},
            "tau": multipliers_along,
        }

    def _solution(self, right: Sequence[int | None]) -> Column:
        """Return [A]^-1 times a column."""
        return self._forward.tangents({"tau": right}, [ACCELERATION])[ACCELERATION]

    @property
    def _by_others(self) -> list[str]:
        return [name for name in self.by if name != "tau"]

    @cached_property
    def _forward(self) -> Embedded:
        return Embedded(self.builder, self.solver, self.constants, self.given)

    @cached_property
    def _inverse(self) -> Embedded:
        return Embedded(
            self.builder, self.inverse, self.constants, {**self.given, "ydot": self.values()}, solved=True
        )

    @cached_property
    def _columns(self) -> Columnwise:
        return Columnwise(self.builder, self.constants)


SPEEDS, EFFORTS, BIAS = "speeds", "efforts", "bias"
"""Names of outputs of the map from {x}, {y} and {tau}: [P]{y}, [P]^-T {tau} and [dP/dt]{y}."""


@dataclass(frozen=True, eq=False)
class InComponents:
    """{ydot} of a system whose joints with three free angles are solved in components.

    Attributes:
        builder: The builder.
        before: The program of `SPEEDS`, `EFFORTS` and `BIAS`.
        solver: The program of the accelerations with these speeds and efforts.
        inverse: The program of inverse dynamics with these speeds.
        after: The program of {ydot} for the accelerations, less the bias, in place of "ydot".
        constants: The arithmetic of constants.
        by: Names of the input arrays by which weighted sums are differentiated.
    """

    builder: Builder
    before: Program
    solver: Program
    inverse: Program
    after: Program
    constants: Constants
    by: Collection[str]

    def values(self, name: str = ACCELERATION) -> list[int]:
        """Return the elements of {ydot} as values."""
        return self._after.values(name)

    def along(self, direction: Columns) -> dict[str, Column]:
        """Return the derivatives of {ydot} along a direction."""
        return self._after.along(self._with_free(direction))

    def gradient(self, weights: Columns) -> dict[str, Column]:
        """Return the derivatives of a weighted sum of {ydot}."""
        last = self._after.gradient(weights)
        free = last.pop("ydot")
        middle = self._solved.gradient({ACCELERATION: free})
        first = self._before.gradient(self._weights_before(middle, free))
        return self._columns.merged(_without_replaced(middle), last, first)

    def gradient_along(self, weights: Columns, change: Columns, direction: Columns) -> dict[str, Column]:
        """Return the derivatives of the gradient along a direction."""
        free = self._after.gradient(weights)["ydot"]
        last = self._after.gradient_along(weights, change, self._with_free(direction))
        free_along = last.pop("ydot")
        middle = self._solved.gradient({ACCELERATION: free})
        middle_along = self._solved.gradient_along(
            {ACCELERATION: free}, {ACCELERATION: free_along}, self._replaced(direction)
        )
        first = self._before.gradient_along(
            self._weights_before(middle, free), self._weights_before(middle_along, free_along), direction
        )
        return self._columns.merged(_without_replaced(middle_along), last, first)

    def _replaced(self, direction: Columns) -> dict[str, Sequence[int | None]]:
        """Return a direction for the speeds and efforts of the solver."""
        found = self._before.along(direction)
        return {**direction, "y": found[SPEEDS], "tau": found[EFFORTS]}

    def _with_free(self, direction: Columns) -> dict[str, Sequence[int | None]]:
        """Return a direction for the map to {ydot}."""
        bias = self._columns.negative(self._before.along(direction)[BIAS])
        found = self._solved.along(self._replaced(direction))[ACCELERATION]
        return {**direction, "ydot": self._columns.sum(found, bias)}

    def _weights_before(self, of_solution: Columns, free: Sequence[int | None]) -> dict[str, Column]:
        """Return the weights of what the map from {x}, {y} and {tau} gives."""
        return {
            SPEEDS: list(of_solution["y"]),
            EFFORTS: list(of_solution["tau"]),
            BIAS: self._columns.negative(free),
        }

    @cached_property
    def _before(self) -> Explicit:
        return Explicit(self.builder, self.before, self.constants, self.by, {})

    @cached_property
    def _solved(self) -> Solved:
        given = {"y": self._before.values(SPEEDS), "tau": self._before.values(EFFORTS)}
        return Solved(self.builder, self.solver, self.inverse, self.constants, self.by, given)

    @cached_property
    def _after(self) -> Explicit:
        bias = self._columns.negative(self._before.values(BIAS))
        free = self._columns.sum(self._solved.values(), bias)
        given = {"ydot": self._columns.values(free)}
        return Explicit(self.builder, self.after, self.constants, [*self.by, "ydot"], given)

    @cached_property
    def _columns(self) -> Columnwise:
        return Columnwise(self.builder, self.constants)


def _without_replaced(columns: Columns) -> dict[str, Sequence[int | None]]:
    """Return columns without those of speeds and efforts, which are no variables of the whole."""
    return {name: column for name, column in columns.items() if name not in ("y", "tau")}
