"""Straight-line code: a single-assignment list of scalar instructions.

Instruction number i defines value i; operands are numbers of earlier values, so the list is its own
topological order. Names and notes come from the derivation and go into the C; they carry no meaning here.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import prod
from typing import Any


class Op(StrEnum):
    """What an instruction computes from its operands."""

    INPUT = "input"  # element `index` of the array `array`
    CONSTANT = "constant"  # `number`
    ADD = "add"
    SUBTRACT = "subtract"
    MULTIPLY = "multiply"
    DIVIDE = "divide"
    NEGATE = "negate"
    SQRT = "sqrt"
    SIN = "sin"
    COS = "cos"


ARITY = {
    Op.INPUT: 0,
    Op.CONSTANT: 0,
    Op.ADD: 2,
    Op.SUBTRACT: 2,
    Op.MULTIPLY: 2,
    Op.DIVIDE: 2,
    Op.NEGATE: 1,
    Op.SQRT: 1,
    Op.SIN: 1,
    Op.COS: 1,
}


@dataclass(frozen=True, slots=True)
class Instruction:
    """One assignment.

    Attributes:
        op: The operation.
        operands: Numbers of earlier values, as many as `ARITY` says.
        number: The value of a `CONSTANT`: a float, or a number of mpmath where C computes in more digits.
        array: Which input array an `INPUT` reads.
        index: Which element of it, row-major.
        name: Name of the quantity, such as `omega_7_x`; empty for a mere part of an expression.
        note: What a reader should know where this instruction begins a group.
    """

    op: Op
    operands: tuple[int, ...] = ()
    number: Any = 0.0
    array: str = ""
    index: int = 0
    name: str = ""
    note: str = ""


@dataclass(frozen=True, slots=True)
class Condition:
    """What must be positive, freedom by freedom, for an output to exist.

    Attributes:
        quantity: In words.
        failure: What is so where it is not.
    """

    quantity: str
    failure: str


REGULAR = Condition("pivot of [A]", "[A] is singular")


@dataclass(frozen=True, slots=True)
class Array:
    """An input or output array of a program.

    Attributes:
        name: Name in C, such as `x`.
        shape: Lengths, row-major; () for a scalar, which C has in an array of one element.
        unit: SI unit or units.
        doc: One line: what it holds, with its equation.
        condition: Of an output that does not always exist.
    """

    name: str
    shape: tuple[int, ...]
    unit: str
    doc: str
    condition: Condition = REGULAR

    @property
    def size(self) -> int:
        """Number of elements."""
        return prod(self.shape)

    @property
    def row(self) -> int:
        """Elements along the last axis."""
        return self.shape[-1] if self.shape else 1


@dataclass(frozen=True, slots=True)
class Output:
    """An output array and the values that fill it.

    Attributes:
        array: The array.
        values: Its elements, row-major.
        positive: Values that must be positive for the elements to hold, such as the pivots of a
            factorisation; the function then returns the place, from 1, of the first that is not, or 0.
        places: Which element each value fills, for a program that fills only some; None for all in order.
        margins: Values that must be positive for the elements to be accurate; where one is not, the function
            returns minus the place, from 1, of the least of them.
    """

    array: Array
    values: tuple[int, ...]
    positive: tuple[int, ...] = ()
    places: tuple[int, ...] | None = None
    margins: tuple[int, ...] = ()

    def elements(self) -> Iterator[tuple[int, int]]:
        """Every element that is filled, and its value."""
        return zip(range(len(self.values)) if self.places is None else self.places, self.values, strict=True)

    def renumbered(self, moved: Mapping[int, int] | Sequence[int]) -> Output:
        """The same output where value i has become value `moved[i]`."""
        values, positive, margins = (
            tuple(moved[i] for i in old) for old in (self.values, self.positive, self.margins)
        )
        return Output(self.array, values, positive, self.places, margins)


@dataclass(frozen=True, slots=True)
class Program:
    """Inputs, instructions, outputs; `check` says what must hold.

    Attributes:
        inputs: Arrays that instructions may read.
        instructions: In order of evaluation.
        outputs: What is computed, in the order of the C arguments.
    """

    inputs: tuple[Array, ...]
    instructions: tuple[Instruction, ...]
    outputs: tuple[Output, ...]

    def results(self) -> Iterator[int]:
        """Every value that an output holds or depends on."""
        for output in self.outputs:
            yield from output.values
            yield from output.positive
            yield from output.margins


EVALUATE = "evaluate"
"""Name of the function that computes every requested output, where there are several."""


@dataclass(frozen=True, slots=True)
class Module:
    """Programs that become one C file.

    Attributes:
        prepare: From the parameters to the prepared constants, the one output; None without parameters.
        functions: By function name: one program for every requested output, and `evaluate`, which
            computes all of them and shares every intermediate, where there are several.
    """

    prepare: Program | None
    functions: dict[str, Program]

    @property
    def together(self) -> Program:
        """The program of all requested outputs."""
        return self.functions.get(EVALUATE) or next(iter(self.functions.values()))
