"""Straight-line code: a single-assignment list of scalar instructions.

Instruction number i defines value i. Operands are numbers of earlier values, so the list is its own
topological order. Names and notes come from the derivation and go into the generated code; they carry no
meaning here.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from math import prod
from typing import Any, NamedTuple

from kanegen.program.columns import ColumnSolution

PARAMETERS = "parameters"
"""Name of the input array of the run-time parameters."""

PREPARED = "prepared"
"""Name of the array of constants that depend on the parameters alone, filled by the function `prepare`."""

WORKSPACE = "w"
"""Name of the array in which a part of a function leaves values for later parts."""

EVALUATE = "evaluate"
"""Name of the function that computes every requested output, where there are several."""

STATE_RATES = "state_rates"
"""Name of the function that computes {xdot} and {ydot} together, where steps need both."""

STATE_RATES_DERIVATIVES = "state_rates_derivatives"
"""Name of the function that computes these rates and their derivatives together, for derivatives of steps."""


class Op(StrEnum):
    """What an instruction computes from its operands."""

    INPUT = "input"  # element `index` of the array `array`
    CONSTANT = "constant"  # `number`
    ADD = "add"
    SUBTRACT = "subtract"
    MULTIPLY = "multiply"
    DIVIDE = "divide"
    NEGATE = "negate"
    ABS = "fabs"
    SQRT = "sqrt"
    SIN = "sin"
    COS = "cos"
    SIGN = "sign"  # -1, 0 or 1
    MIN = "min"
    MAX = "max"
    SELECT = "select"  # the second operand where the first is positive, the third where it is 0 or negative
    EXP = "exp"
    LOG = "log"
    TANH = "tanh"
    ATAN2 = "atan2"


ARITY = {
    Op.INPUT: 0,
    Op.CONSTANT: 0,
    Op.ADD: 2,
    Op.SUBTRACT: 2,
    Op.MULTIPLY: 2,
    Op.DIVIDE: 2,
    Op.NEGATE: 1,
    Op.ABS: 1,
    Op.SQRT: 1,
    Op.SIN: 1,
    Op.COS: 1,
    Op.SIGN: 1,
    Op.MIN: 2,
    Op.MAX: 2,
    Op.SELECT: 3,
    Op.EXP: 1,
    Op.LOG: 1,
    Op.TANH: 1,
    Op.ATAN2: 2,
}
"""The number of operands that each operation takes."""

CHOICES = (Op.SIGN, Op.MIN, Op.MAX, Op.SELECT)
"""Operations that compare numbers and round nothing; a NaN decides nothing, and gives NaN."""

TRANSCENDENTAL = (Op.EXP, Op.LOG, Op.TANH, Op.ATAN2)
"""Functions beside sine and cosine whose values are rounded; for `ATAN2` a zero has no sign."""


class Instruction(NamedTuple):
    """One assignment: the operation that computes a value.

    It is a tuple because long programs are copied many times, and nothing in Python is made faster.

    Attributes:
        op: The operation.
        operands: Numbers of earlier values, as many as `ARITY` says.
        number: The value of a `CONSTANT`: a number of mpmath, or a float that is exact.
        array: Name of the input array that an `INPUT` reads.
        index: Index of the element that an `INPUT` reads, row-major.
        name: Name of the quantity, such as `omega_7_x`; empty for a part of an expression.
        note: Comment on the group of quantities that this instruction belongs to.
    """

    op: Op
    operands: tuple[int, ...] = ()
    number: Any = 0.0
    array: str = ""
    index: int = 0  # type: ignore[assignment]  # in place of the method of tuples
    name: str = ""
    note: str = ""

    def with_operands(self, operands: tuple[int, ...]) -> Instruction:
        """Return the same instruction on other operands."""
        return Instruction(self.op, operands, self.number, self.array, self.index, self.name, self.note)

    def named(self, name: str, note: str = "") -> Instruction:
        """Return the same instruction with another name and note."""
        return Instruction(self.op, self.operands, self.number, self.array, self.index, name, note)


@dataclass(frozen=True, slots=True)
class Condition:
    """The condition under which an output exists: one quantity for each freedom must be positive.

    Attributes:
        quantity: Name of the quantity in a sentence, such as "pivot of [A]".
        failure: Clause on the state where the quantity is not positive, such as "[A] is singular".
        remedy: Clause on what helps where the quantity is so small that most digits are lost.
    """

    quantity: str
    failure: str
    remedy: str = 'an output "error_estimate" says how many, refinement or a higher precision helps'


REGULAR = Condition("pivot of [A]", "[A] is singular")
"""The condition of every output that solves [A]{ydot} = {f}: the pivots of [A] are positive."""

INVERTIBLE = Condition(REGULAR.quantity, REGULAR.failure, "a higher precision helps")
"""The same for an output that is not refined, such as [A]^-1."""


@dataclass(frozen=True, slots=True)
class RowCondition:
    """The condition under which an output exists that has rows: one quantity for each row must be positive.

    A status names a row as it names a freedom. Rows of outputs have places behind that of the status of a
    result that is not finite, in the order of `ModelDescription.rows`.

    Attributes:
        quantity: Name of the quantity in a sentence, such as "pivot of J [A]^-1 J^T".
        failure: Clause on the state where the quantity is not positive.
        loss: Clause on the state where the quantity is so small that digits are lost.
        rows: What the rows are, in the plural, such as "moments and forces on the frames".
        first: Number of rows of other outputs before them.
    """

    quantity: str
    failure: str
    loss: str
    rows: str
    first: int = 0


@dataclass(frozen=True, slots=True)
class Array:
    """An input or output array of a program.

    Attributes:
        name: Name in C, such as `x`.
        shape: Lengths, row-major; () for a scalar, which C stores in an array of one element.
        unit: SI unit or units.
        doc: Content of the array in one line, with its equation.
        condition: When an output exists that does not exist in every state.
        of_freedoms: Whether the first index counts the freedoms.
        row_condition: The condition for each of its rows, if it has rows without which it does not exist.
        pattern: Row and column of each element that is filled, for an array that holds only a part of a
            symmetric matrix: all of its elements if it has one axis, those at these places if it has two.
        form: Form of a symmetric matrix, one of `triangle.FORMS`.
    """

    name: str
    shape: tuple[int, ...]
    unit: str
    doc: str
    condition: Condition = REGULAR
    of_freedoms: bool = False
    row_condition: RowCondition | None = None
    pattern: tuple[tuple[int, int], ...] = ()
    form: str = "full"

    @property
    def size(self) -> int:
        """Number of elements."""
        return prod(self.shape)

    @property
    def row(self) -> int:
        """Number of elements along the last axis."""
        return self.shape[-1] if self.shape else 1

    @property
    def is_filled_in_part(self) -> bool:
        """Whether elements are left as they are: those above the diagonal of a lower triangle."""
        return bool(self.pattern) and len(self.shape) == 2

    @property
    def is_matrix(self) -> bool:
        """Whether the elements, in whatever form, are those of one matrix."""
        return bool(self.pattern) or len(self.shape) == 2

    def entry(self, index: int) -> tuple[int, int]:
        """Return row and column of element `index` of a matrix."""
        return self.pattern[index] if len(self.shape) == 1 else divmod(index, self.row)


@dataclass(frozen=True, slots=True)
class Output:
    """An output array and the values that fill it.

    Attributes:
        array: The array.
        values: Numbers of the values that are its elements, row-major.
        exists_if_positive: Values that must be positive for the elements to exist, such as the pivots of a
            factorisation. The generated function returns the place, from 1, of the first that is not, or 0.
        places: The element that each value fills, for a program that fills only some; None for all in order.
        accurate_if_positive: Values that must be positive for the elements to be accurate, as many as
            `exists_if_positive` or a multiple of it. Where one is not, the generated function returns minus
            the place, from 1, of the least of them.
        solution: For an output that loops compute from `values`, how they do; else `values` are its elements.
    """

    array: Array
    values: tuple[int, ...]
    exists_if_positive: tuple[int, ...] = ()
    places: tuple[int, ...] | None = None
    accurate_if_positive: tuple[int, ...] = ()
    solution: ColumnSolution | None = None

    def elements(self) -> Iterator[tuple[int, int]]:
        """Return the index of every element that a value fills, and the number of its value."""
        if self.solution is not None:
            direct = self.values[self.solution.number_of_values :]
            return zip(self.places or (), direct, strict=True)
        return zip(range(len(self.values)) if self.places is None else self.places, self.values, strict=True)

    def renumbered(self, moved: Mapping[int, int] | Sequence[int]) -> Output:
        """Return the same output of a program in which value i has become value `moved[i]`."""
        values, existence, accuracy = (
            tuple(moved[i] for i in old)
            for old in (self.values, self.exists_if_positive, self.accurate_if_positive)
        )
        return replace(self, values=values, exists_if_positive=existence, accurate_if_positive=accuracy)


@dataclass(frozen=True, slots=True)
class Program:
    """Input arrays, instructions and output arrays; `check` verifies the invariants.

    Attributes:
        inputs: Arrays that instructions may read.
        instructions: Assignments in order of evaluation.
        outputs: Arrays that are filled, in the order of the C arguments.
    """

    inputs: tuple[Array, ...]
    instructions: tuple[Instruction, ...]
    outputs: tuple[Output, ...]

    def results(self) -> Iterator[int]:
        """Yield the number of every value that an output holds or that its conditions test."""
        for output in self.outputs:
            yield from output.values
            yield from output.exists_if_positive
            yield from output.accurate_if_positive


@dataclass(frozen=True, slots=True)
class Module:
    """The programs that become one C file.

    Attributes:
        prepare: Computes the array `PREPARED` from the parameters; None for a model without parameters.
        functions: Programs by function name: one for every requested output and, where there are several,
            `EVALUATE`, which computes all of them and shares every intermediate.
        integrators: Names of the functions that follow a motion in steps, composed of those above.
    """

    prepare: Program | None
    functions: dict[str, Program]
    integrators: tuple[str, ...] = ()

    @property
    def together(self) -> Program:
        """The program that computes all requested outputs."""
        return self.functions.get(EVALUATE) or next(iter(self.functions.values()))
