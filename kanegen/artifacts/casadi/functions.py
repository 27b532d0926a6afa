"""The functions of CasADi that a source gives, as plain data: inputs, outputs, Jacobians, calls of C.

An output of the source is a function of CasADi, and its Jacobian is read from the output
`<output>_derivatives`. A step of a method is one, with the derivatives of the step. `ode` gives the rates of
a state. Every array is a matrix of CasADi; loads have entries only in the rows of bodies and points that take
loads, and results only where the program does not give the number 0.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from kanegen.artifacts.casadi.pattern import Pattern, matrix_shape
from kanegen.artifacts.casadi.sources import Derived, Result, differentiable
from kanegen.c.description import ModelDescription
from kanegen.c.interface import Function
from kanegen.c.source import Source
from kanegen.model.arguments import LOADS
from kanegen.program.ir import PREPARED, Array, Op

SUFFIX = "_casadi"
"""What stands behind the name of the model in the names of the functions and of their file."""


@dataclass(frozen=True)
class Matrix:
    """A matrix of CasADi, and the array of C that holds its entries.

    Attributes:
        name: Name of the input or output in CasADi.
        pattern: Shape and entries that are stored.
        array: Name of the array, which may be that of an input; "" where all stored entries are ones.
        places: Place in the array of each entry that is stored.
        size: Number of elements of the array.
        is_known: Whether the source can give it; there may be no derivatives by an input.
    """

    name: str
    pattern: Pattern
    array: str = ""
    places: tuple[int, ...] = ()
    size: int = 0
    is_known: bool = True

    @property
    def is_whole(self) -> bool:
        """Whether the matrix is stored as the array is."""
        return self.places == tuple(range(self.size))


@dataclass(frozen=True)
class CasadiFunction:
    """A function of CasADi.

    Attributes:
        name: Its name, a symbol of the library.
        doc: One sentence.
        inputs: Its arguments that are read.
        unread: Further arguments: of a Jacobian the results of the function that it differentiates.
        outputs: Its results.
        calls: Functions of C that fill arrays of results.
    """

    name: str
    doc: str
    inputs: tuple[Matrix, ...]
    outputs: tuple[Matrix, ...]
    calls: tuple[Function, ...]
    unread: tuple[Matrix, ...] = ()

    def results(self, call: Function) -> tuple[int, ...]:
        """Return the numbers of the outputs that are read from arrays of a call."""
        filled = {array.name for array in call.outputs}
        return tuple(i for i, one in enumerate(self.outputs) if one.array in filled and one.places)

    @property
    def reads_parameters(self) -> bool:
        """Whether constants are prepared from parameters."""
        return any(array.name == PREPARED for call in self.calls for array in call.inputs)


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
    """Return the functions of CasADi that a source gives, each followed by its Jacobian if it has one."""
    return tuple(function for one in differentiable(source) for function in _Functions(source, one).all())


@dataclass(frozen=True)
class _Functions:
    """A function of CasADi and its Jacobian, made from what a source says about its results.

    Attributes:
        source: The source.
        of: Name, results and derivatives.
    """

    source: Source
    of: Derived

    def all(self) -> Iterator[CasadiFunction]:
        """Yield the function and, if all its results have derivatives, its Jacobian."""
        name = symbol(self.source.model, self.of.name)
        inputs = tuple(map(self._input, self.of.inputs(self.source)))
        outputs = tuple(map(self._output, self.of.results))
        calls = tuple(dict.fromkeys(one.call for one in self.of.results if one.call))
        yield CasadiFunction(name, self.of.doc, inputs, outputs, calls)
        if not self.of.has_derivatives:
            return
        blocks = [
            self._block(place, given, output.name) for place, output in enumerate(outputs) for given in inputs
        ]
        unread = tuple(
            Matrix(f"out_{one.name}", Pattern.empty(one.pattern.rows, one.pattern.columns)) for one in outputs
        )
        doc = f"The Jacobian of {name}: a block for each output and input."
        yield CasadiFunction(f"jac_{name}", doc, inputs, tuple(blocks), self.of.derivative_calls, unread)

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
