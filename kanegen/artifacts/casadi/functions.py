"""The functions of CasADi that a source gives, as plain data: inputs, outputs, Jacobians, calls of C.

An output of the source is a function of CasADi, and its Jacobian is read from the output
`<output>_derivatives`. A step of a method is one, with the derivatives of the step. `ode` gives the rates of
a state. Every array is a matrix of CasADi; loads have entries only in the rows of bodies and points that take
loads, and results only where the program does not give the number 0.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from kanegen.artifacts.casadi.directional import directional, not_read
from kanegen.artifacts.casadi.matrix import CasadiFunction, Matrix
from kanegen.artifacts.casadi.pattern import Pattern, matrix_shape
from kanegen.artifacts.casadi.sources import Derived, Result, differentiable
from kanegen.c.description import ModelDescription
from kanegen.c.source import Source
from kanegen.model.arguments import LOADS
from kanegen.program.ir import Array, Op

SUFFIX = "_casadi"
"""What stands behind the name of the model in the names of the functions and of their file."""


def symbol(model: ModelDescription, name: str) -> str:
    """Return the name of a function of CasADi, in which no two underscores stand side by side.

    Args:
        model: The model.
        name: Name of the function without prefix, such as "forward_dynamics".

    Example:
        >>> symbol(source.model, "forward_dynamics")
        'panda_arm_casadi_forward_dynamics'
    """
    return "_".join(word for word in f"{model.name}{SUFFIX}_{name}".split("_") if word)


def casadi_functions(source: Source) -> tuple[CasadiFunction, ...]:
    """Return the functions of CasADi that a source gives, each followed by its derivatives."""
    return tuple(function for one in differentiable(source) for function in _Functions(source, one).all())


@dataclass(frozen=True)
class _Functions:
    """A function of CasADi and its derivatives, made from what a source says about its results.

    Attributes:
        source: The source.
        of: Name, results and derivatives.
    """

    source: Source
    of: Derived

    def all(self) -> Iterator[CasadiFunction]:
        """Yield the function, its Jacobian if all its results have derivatives, and those by products."""
        name = symbol(self.source.model, self.of.name)
        inputs = tuple(map(self._input, self.of.inputs(self.source)))
        outputs = tuple(map(self._output, self.of.results))
        calls = tuple(dict.fromkeys(one.call for one in self.of.results if one.call))
        function = CasadiFunction(name, self.of.doc, inputs, outputs, calls)
        yield function
        if self.of.has_derivatives:
            yield self._jacobian(function)
        yield from directional(function, self.of)

    def _jacobian(self, function: CasadiFunction) -> CasadiFunction:
        """Return the Jacobian of a function."""
        blocks = [
            self._block(place, given, output.name)
            for place, output in enumerate(function.outputs)
            for given in function.inputs
        ]
        return CasadiFunction(
            f"jac_{function.name}",
            f"The Jacobian of {function.name}: a block for each output and input.",
            (*function.inputs, *not_read("out_", function.outputs)),
            tuple(blocks),
            self.of.derivative_calls,
        )

    def _input(self, array: Array) -> Matrix:
        """Return the matrix of an input, with the rows of loads that are read."""
        rows, columns = matrix_shape(array)
        unread = self.source.model.unloaded(LOADS[array.name]) if array.name in LOADS else {}
        pattern = Pattern.where(rows, columns, lambda row, _: row not in unread)
        places = tuple(columns * row + column for row, column in pattern.entries)
        return Matrix(array.name, pattern, array.name, places, array.size)

    def _output(self, result: Result) -> Matrix:
        """Return the matrix of a result."""
        array = result.array
        rows, columns = matrix_shape(array)
        stored = self._stored(array)
        pattern = Pattern.where(rows, columns, lambda row, column: columns * row + column in stored)
        places = tuple(columns * row + column for row, column in pattern.entries)
        return Matrix(array.name, pattern, result.copied or array.name, places, array.size)

    def _block(self, place: int, given: Matrix, output: str) -> Matrix:
        """Return the derivative of a result by an input: entries by entries, both column by column.

        Args:
            place: Number of the result.
            given: The input.
            output: Name of the result.
        """
        result = self.of.results[place]
        rows, columns = matrix_shape(result.array)
        height, width = result.array.size, given.pattern.rows * given.pattern.columns
        name = f"jac_{output}_{given.name}"
        if result.copied == given.name:
            return Matrix(name, Pattern.where(height, width, lambda row, column: row == column))
        if not result.reads(given.name):
            return Matrix(name, Pattern.empty(height, width))
        found = result.derivative(given.name)
        if found is None:
            return Matrix(name, Pattern.dense(height, width), is_known=False)
        stored, row_length = self._stored(found.array), found.array.row
        start: int = found.columns[given.name].start
        taken = given.pattern

        def at(row: int, column: int) -> int:
            """Return the place in the array of derivatives of an entry of the block."""
            element = columns * (row % rows) + row // rows
            variable = taken.columns * (column % taken.rows) + column // taken.rows
            return row_length * (found.first_row + element) + start + variable

        pattern = Pattern.where(height, width, lambda row, column: at(row, column) in stored)
        places = tuple(at(*entry) for entry in pattern.entries)
        return Matrix(name, pattern, found.array.name, places, found.array.size)

    def _stored(self, array: Array) -> frozenset[int]:
        """Return the places of the elements of a result that are not the number 0 in every state."""
        module = self.source.module
        for program in module.functions.values() if module else ():
            for output in program.outputs:
                if output.array.name == array.name:
                    kinds = program.instructions
                    return frozenset(
                        place
                        for place, value in output.elements()
                        if kinds[value].op is not Op.CONSTANT or kinds[value].number != 0
                    )
        return frozenset(range(array.size))
