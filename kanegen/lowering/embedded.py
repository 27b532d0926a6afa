"""Programs within a builder, some of whose inputs are values of it, and products with their derivatives."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

from kanegen.program.adjoint import adjoints
from kanegen.program.builder import Builder
from kanegen.program.constants import Constants
from kanegen.program.ir import Array, Op, Output, Program
from kanegen.program.passes.fold import FoldingBuilder
from kanegen.program.passes.prune import prune
from kanegen.program.tangent import seeded_tangents, tangents

Element = int | None
"""Number of a value in a builder, or None for a zero that is never written down."""

Column = list[Element]
"""The elements of an array, or their derivatives."""

Columns = Mapping[str, Sequence[Element]]
"""Columns by name of the array."""


class Embedded:
    """A program within a builder.

    Args:
        builder: The builder.
        program: The program.
        constants: The arithmetic of constants.
        given: Values of the builder for the elements of some input arrays, by name of the array.
        solved: Whether "ydot" is given as a solution, which the names of values that depend on it then say.
    """

    def __init__(
        self,
        builder: Builder,
        program: Program,
        constants: Constants,
        given: Mapping[str, Sequence[int]],
        *,
        solved: bool = False,
    ) -> None:
        self._builder, self._program, self._constants = builder, program, constants
        self._outputs = {output.array.name: output for output in program.outputs}
        self._inputs: dict[str, dict[int, int]] = {array.name: {} for array in program.inputs}
        self._moved: dict[int, int] = {}
        changed: set[int] = set()
        for i, x in enumerate(program.instructions):
            if x.op is Op.INPUT:
                self._inputs[x.array][i] = x.index
            if x.op is Op.INPUT and x.array in given:
                if solved and x.array == "ydot":
                    changed.add(i)
                self._moved[i] = given[x.array][x.index]
                continue
            bare = x if x.op is Op.INPUT else x.named("")
            value = builder.copy(bare, [self._moved[j] for j in x.operands])
            if not changed.isdisjoint(x.operands):
                changed.add(i)
            name = f"{x.name}{'_s' if i in changed else ''}" if x.name else ""
            self._moved[i] = builder.name(value, name, x.note)

    def output(self, name: str) -> Output:
        """Return an output of the program, in the builder."""
        return self._outputs[name].renumbered(self._moved)

    def values(self, name: str) -> list[int]:
        """Return the values of an output of the program."""
        return list(self.output(name).values)

    def tangents(self, along: Columns, names: Iterable[str]) -> dict[str, Column]:
        """Return the derivatives of outputs along a direction.

        Args:
            along: The direction, by name of an input array; arrays that are absent stay as they are.
            names: Names of the outputs.
        """
        seeds = {
            i: {0: value}
            for array, column in along.items()
            for i, place in self._inputs.get(array, {}).items()
            if (value := column[place]) is not None
        }
        wanted = {name: self._outputs[name].values for name in names}
        every = [value for values in wanted.values() for value in values]
        found = seeded_tangents(
            self._builder, self._program, self._moved, seeds, every, self._constants, mark="_dir"
        )
        return {name: [found[value].get(0) for value in values] for name, values in wanted.items()}

    def derivatives(self, name: str, columns: Mapping[str, slice]) -> list[dict[int, int]]:
        """Return the derivatives of the elements of an output that are not zero, by column.

        Args:
            name: Name of the output.
            columns: Columns of the elements of input arrays by which it is differentiated.
        """
        directions = {
            i: columns[array].start + place
            for array in columns
            for i, place in self._inputs.get(array, {}).items()
        }
        wanted = self._outputs[name].values
        found = tangents(self._builder, self._program, self._moved, directions, wanted, self._constants)
        return [found[value] for value in wanted]

    def adjoints(self, weights: Columns, by: Collection[str]) -> dict[str, Column]:
        """Return the derivatives of a weighted sum of elements of outputs, by the elements of input arrays.

        Args:
            weights: The weights, by name of the output.
            by: Names of the input arrays; those that the program does not have are left out.
        """
        shares: dict[int, int] = {}
        for name, column in weights.items():
            for i, weight in zip(self._outputs[name].values, column, strict=True):
                if weight is not None:
                    shares[i] = self._builder.add(shares[i], weight) if i in shares else weight
        wanted = {i for name in by for i in self._inputs.get(name, {})}
        found = adjoints(self._builder, self._program, self._moved, shares, wanted, self._constants)
        sizes = {array.name: array.size for array in self._program.inputs}
        result: dict[str, Column] = {name: [None] * sizes[name] for name in by if name in sizes}
        for name, column in result.items():
            for i, place in self._inputs[name].items():
                column[place] = found.get(i)
        return result


def gradient(program: Program, names: Sequence[str], by: Collection[str], constants: Constants) -> Program:
    """Return the program of the gradient of a weighted sum of elements of outputs.

    Args:
        program: The program of the outputs.
        names: Names of the outputs. The weights of the output "f" are the input array "f_weights".
        by: Names of the input arrays by which the sum is differentiated.
        constants: The arithmetic of constants.

    Returns:
        A program with an output for each array of `by` that the program has, of the name of the array with
        "_gradient" at the end.
    """
    arrays = {
        o.array.name: Array(f"{o.array.name}_weights", (len(o.values),), "", "") for o in program.outputs
    }
    builder = FoldingBuilder((*program.inputs, *(arrays[name] for name in names)))
    embedded = Embedded(builder, program, constants, {})
    weights = {
        name: [builder.input(arrays[name].name, i) for i in range(arrays[name].size)] for name in names
    }
    zero = builder.constant(constants.quotient(0, 1))
    found = embedded.adjoints(weights, by)
    outputs = [
        Output(
            Array(f"{name}_gradient", (len(column),), "", ""),
            tuple(zero if value is None else value for value in column),
        )
        for name, column in found.items()
    ]
    return prune(builder.program(outputs))
