"""Programs of the outputs that are second derivatives, by tangents of programs of first derivatives.

Each pair of variables is differentiated once: the first derivative by the later of the two along the earlier.
For the solution {ydot} of ID(x, y, ydot) = {tau}, with its first derivatives F and ID linear in {ydot},

    [A] F_ab = -(ID_ab + [A]_a F_b + [A]_b F_a),

and one elimination of [A] serves all pairs. Where {ydot} has digits that products with [A]^-1 lose, the first
derivatives of its solver are differentiated instead; see `differentiate`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import combinations_with_replacement

from kanegen.lowering.differentiate import differentiated
from kanegen.lowering.embedded import Embedded
from kanegen.model.system import System
from kanegen.program.builder import Builder
from kanegen.program.check import check
from kanegen.program.constants import Constants
from kanegen.program.elimination import Column, Elimination
from kanegen.program.ir import PARAMETERS, Output, Program
from kanegen.program.passes.fold import FoldingBuilder, fold
from kanegen.program.passes.prune import prune
from kanegen.recursion import RecursiveForm
from kanegen.recursion.factorisation import carriers
from kanegen.recursion.outputs import OUTPUTS, SECOND_DERIVATIVES, Derivative, argument_arrays
from kanegen.recursion.solution_derivatives import flying_bodies, locking_bodies

Pair = tuple[int, int]
"""Places of two variables, the earlier first."""

Second = dict[Pair, Column]
"""Second derivatives that are not zero, row by row, by pair of variables."""


def second_derivatives(
    program: Program, form: RecursiveForm, outputs: Mapping[str, Output], constants: Constants, name: str
) -> Program:
    """Return the program of an output that is a second derivative.

    Args:
        program: Program of the outputs that are differentiated, among others.
        form: What it was lowered from.
        outputs: Outputs of this program, by name.
        constants: The arithmetic of constants.
        name: Name of the output.
    """
    system, derivation = form.system, SECOND_DERIVATIVES[name]
    of_solution = "forward_dynamics" in derivation.needs
    solved = of_solution and not (_differentiates_solver(system) or form.refinement.steps)
    names = _first_derivatives(of_solution=of_solution, solved=solved)
    found = differentiated(program, system, outputs, names, constants)
    builder = FoldingBuilder(argument_arrays(system))
    making = _Making(builder, prune(fold(found)), form, constants, derivation.columns_of(system))
    by_columns = partial(making.of_columns, names[-1], with_matrix=not of_solution)
    second = making.of_solution() if solved else by_columns()
    conditions = Embedded(builder, program, constants, {}).output(outputs[derivation.needs[-1]].array.name)
    width, n = derivation.width(system), len(system.freedoms)
    zero = builder.constant(constants.quotient(0, 1))
    values = [
        second.get((min(a, b), max(a, b)), {}).get(row, zero)
        for row in range(n)
        for a in range(width)
        for b in range(width)
    ]
    output = replace(conditions, array=OUTPUTS[name].array(system), values=tuple(values))
    return prune(check(builder.program([output])))


def _differentiates_solver(system: System) -> bool:
    """Return whether second derivatives of {ydot} are those of the program of the first.

    So it is where three angles of a joint can reach gimbal lock, next to which a product with [A]^-1 loses
    digits that {ydot} has, and where several bodies translate freely and rotate.
    """
    return bool(locking_bodies(system)) or len(flying_bodies(system)) > 1


def _first_derivatives(*, of_solution: bool, solved: bool) -> list[str]:
    """Return the outputs whose programs are differentiated once more."""
    if of_solution and not solved:
        return ["forward_dynamics_derivatives"]
    return [*(["forward_dynamics"] if solved else []), "mass_matrix", "inverse_dynamics_derivatives"]


@dataclass(frozen=True)
class _Making:
    """The making of second derivatives from a program of first derivatives.

    Attributes:
        builder: The builder to which instructions are appended.
        first: The program of first derivatives.
        form: The system, and how its outputs were derived.
        constants: The arithmetic of constants.
        columns: Places of the variables by array.
    """

    builder: Builder
    first: Program
    form: RecursiveForm
    constants: Constants
    columns: Mapping[str, slice]

    def of_columns(self, name: str, *, with_matrix: bool) -> Second:
        """Return the derivatives of an output that holds first derivatives.

        Args:
            name: Name of the output.
            with_matrix: Whether [A] holds the first derivatives by {ydot}.
        """
        embedded = Embedded(self.builder, self.first, self.constants, {})
        second = self._along_earlier(embedded, name, self._places(name))
        if with_matrix:
            second |= self._along_earlier(embedded, "A", [*_range(self.columns["ydot"])])
        return second

    def of_solution(self) -> Second:
        """Return the second derivatives of {ydot} through those of inverse dynamics at {ydot}."""
        embedded = Embedded(self.builder, self.first, self.constants, {"ydot": self._solution}, solved=True)
        name = "inverse_dynamics_derivatives"
        places = self._places(name)
        needed = self._along_earlier(embedded, name, places)
        elimination = self._elimination(embedded)
        slopes = self._first_of_solution(embedded, elimination, name, places)
        changes = self._changes_of_matrix(embedded)
        every = [*range(max(part.stop for part in self.columns.values()))]
        second: Second = {}
        for a, b in combinations_with_replacement(every, 2):
            right = dict(needed.get((a, b), {}))
            for one, other in ((a, b), (b, a)):
                for (row, k), change in changes.get(one, {}).items():
                    if k in slopes[other]:
                        self._add(right, row, self.builder.multiply(change, slopes[other][k]))
            if right:
                second[a, b] = self._negative(elimination.solve(right))
        return second

    def _add(self, column: Column, row: int, value: int) -> None:
        """Add a value to an element of a column."""
        column[row] = self.builder.add(column[row], value) if row in column else value

    def _negative(self, column: Column) -> Column:
        return {row: self.builder.negate(value) for row, value in column.items()}

    def _along_earlier(self, embedded: Embedded, name: str, places: list[int]) -> Second:
        """Return the derivatives of columns of an output along variables that are not later.

        Args:
            embedded: The program of first derivatives.
            name: Name of the output.
            places: Places of the variables to which its columns belong.
        """
        second: Second = {}
        by = {array: part for array, part in self.columns.items() if array != "tau"}
        width = len(places)
        for element, slopes in enumerate(embedded.derivatives(name, by)):
            row, later = element // width, places[element % width]
            for earlier, value in slopes.items():
                if earlier <= later:
                    second.setdefault((earlier, later), {})[row] = value
        return second

    def _places(self, name: str) -> list[int]:
        """Return the places of the variables to which the columns of first derivatives belong."""
        arrays = OUTPUTS[name].derivation
        assert isinstance(arrays, Derivative)
        own = arrays.columns_of(self.form.system)
        return [place for array in own for place in _range(self.columns[array])]

    def _first_of_solution(
        self, embedded: Embedded, elimination: Elimination, name: str, places: list[int]
    ) -> dict[int, Column]:
        """Return the first derivatives of {ydot} by place of the variable."""
        values, width = embedded.values(name), len(places)
        n = len(self.form.system.freedoms)
        found: dict[int, Column] = {}
        for k, place in enumerate(places):
            right = {i: v for i in range(n) if not self.builder.is_zero(v := values[width * i + k])}
            found[place] = self._negative(elimination.solve(right))
        one = self.builder.constant(self.constants.quotient(1, 1))
        for k, place in enumerate(_range(self.columns["tau"])):
            found[place] = elimination.solve({k: one})
        return found

    def _changes_of_matrix(self, embedded: Embedded) -> dict[int, dict[Pair, int]]:
        """Return the derivatives of [A] that are not zero, by row and column, by place of the variable."""
        found: dict[int, dict[Pair, int]] = {}
        n = len(self.form.system.freedoms)
        by = {array: part for array, part in self.columns.items() if array in ("x", PARAMETERS)}
        for element, slopes in enumerate(embedded.derivatives("A", by)):
            for place, value in slopes.items():
                found.setdefault(place, {})[divmod(element, n)] = value
        return found

    @cached_property
    def _solution(self) -> list[int]:
        """The solution {ydot}, element by element."""
        return Embedded(self.builder, self.first, self.constants, {}).values("acceleration")

    def _elimination(self, embedded: Embedded) -> Elimination:
        """Return the elimination of [A] at the solution."""
        n, values = len(self.form.system.freedoms), embedded.values("A")
        entries = {
            (i, j): values[n * i + j]
            for i in range(n)
            for j in range(i + 1)
            if not self.builder.is_zero(values[n * i + j])
        }
        one = self.builder.constant(self.constants.quotient(1, 1))
        return Elimination.of_matrix(self.builder, entries, carriers(self.form.system), one)


def _range(part: slice) -> Iterator[int]:
    """Yield the places of a slice."""
    yield from range(part.start, part.stop)
