"""Running errors: instructions that bound the rounding errors of other instructions, state by state.

Every value v of a program is computed as some number near it. `RunningErrors` appends, for every value, the
instructions that compute E with |computed - exact| <= u E (Wilkinson 1963; Higham 2002, section 3.3). The
exact value is that of the program in exact arithmetic, for the very inputs, with exact constants. Each rule
holds for all rounding to nearest, whether the compiler contracts products and sums or not:

    a + b         E = E_a + E_b + |v|
    a b           E = E_a (|b| + u E_b) + E_b |a| + |v| + t
    a / b         E = (E_a + |v| E_b) / (|b| - u E_b) + |v| + t,   where |b| > 2 u E_b
    sqrt a        E = E_a / |v| + |v|
    sin a, cos a  E = E_a + c
    exp a         E = E_a e^(u E_a) |v| + c |v| + t
    log a         E = E_a / (|a| - u E_a) + c |v| + t
    tanh a        E = E_a + c |v| + t
    atan2(a, b)   E = (E_a + E_b) / (max(|a|, |b|) - u E_a - u E_b) + c |v| + t
    min, max      E = max(E_a, E_b)
    sign a        E = 0 where |a| > 2 u E_a
    a if c else b E = E_a or E_b where |c| > 2 u E_c

Here v is what the operation computed, t covers a result or a product of errors that underflows, and c is
the error of the functions. Where rounding decides a sign or a condition, E reaches from one value to the
other, and at the half-line y = 0, x < 0, where the angle of a point jumps, from -pi to pi. What is exact
has no E: inputs, sign changes, constants that the precision holds, and products with powers of two.
Instructions that compute E round, too. They add, multiply and divide positive numbers, so that E is off by
a factor near 1, which `SLACK` and `RAISED` cover.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from kanegen.program.builder import Builder
from kanegen.program.constants import MULTIPRECISION, as_fraction
from kanegen.program.elementary import roundoffs
from kanegen.program.ir import CHOICES, TRANSCENDENTAL, Instruction, Op, Program
from kanegen.program.precision import Precision

SLACK = 1 / 16
"""Relative amount by which bounds are raised, because the instructions that compute them round as well."""

RAISED = 1 / 8
"""Relative amount by which u is raised where u E is added to a factor or subtracted from a divisor."""

_SINES = (Op.SIN, Op.COS)


@dataclass(frozen=True)
class Arithmetic:
    """The arithmetic whose errors are bounded.

    Attributes:
        precision: Precision of all operations, with rounding to nearest.
        sine_error: Bound on the error of a computed sine or cosine, in units of u.
    """

    precision: Precision
    sine_error: float

    @property
    def roundoff(self) -> float:
        """Unit roundoff u of the precision: half the distance from 1 to the next larger number."""
        return self.precision.roundoff

    @property
    def least(self) -> float:
        """Four times what an operation whose result underflows can lose, in units of u."""
        return 4 * float(np.finfo(self.precision.dtype).smallest_normal)


class RunningErrors:
    """Copies a program into a builder and appends the running errors of its values.

    Errors that nothing reads are left to the pass `prune`.

    Args:
        builder: The builder; its inputs are those of the program.
        program: The program, with constants of as many digits as the exact values have.
        arithmetic: The arithmetic in which the instructions are carried out.
    """

    def __init__(self, builder: Builder, program: Program, arithmetic: Arithmetic) -> None:
        self._builder, self._program, self._arithmetic = builder, program, arithmetic
        self._values: list[int] = []
        self._errors: list[int | None] = []
        self._sizes: dict[int, int] = {}
        self._largest: dict[int, int] = {}
        self._divisors: dict[int, int] = {}
        self.roundoff = builder.constant((1 + RAISED) * arithmetic.roundoff)
        self.least = builder.constant(arithmetic.least)
        for i, instruction in enumerate(program.instructions):
            self._values.append(self._value(instruction))
            self._errors.append(self._error(instruction, i))

    def value(self, i: int) -> int:
        """Return the value of instruction `i` in the builder."""
        return self._values[i]

    def error(self, i: int) -> int | None:
        """Return the value E of instruction `i`; None if the instruction is exact."""
        return self._errors[i]

    def size(self, i: int) -> int:
        """Return the magnitude |v| of what instruction `i` computes."""
        instruction = self._program.instructions[i]
        if instruction.op is Op.NEGATE:
            return self.size(instruction.operands[0])
        if i not in self._sizes:
            if instruction.op is Op.CONSTANT:
                self._sizes[i] = self._builder.constant(abs(self._nearest(instruction)))
            else:
                self._sizes[i] = self._builder.function(Op.ABS, self.value(i))
        return self._sizes[i]

    def largest(self, i: int) -> int:
        """Return an upper bound |v| + u E of the exact magnitude of instruction `i`."""
        error = self.error(i)
        if error is None:
            return self.size(i)
        if i not in self._largest:
            make = self._builder
            self._largest[i] = make.add(self.size(i), make.multiply(self.roundoff, error))
        return self._largest[i]

    def margin(self, i: int) -> int:
        """Return |v| - 2 u E of instruction `i`; where that is positive, the exact value is not 0."""
        error = self.error(i)
        if error is None:
            return self.size(i)
        make = self._builder
        twice = make.constant(2 * (1 + RAISED) * self._arithmetic.roundoff)
        return make.subtract(self.size(i), make.multiply(twice, error))

    def divisor(self, i: int) -> int:
        """Return a lower bound |v| - u E of the exact magnitude of instruction `i`; NaN without a margin."""
        error = self.error(i)
        if error is None:
            return self.size(i)
        if i not in self._divisors:
            make = self._builder
            root = make.function(Op.SQRT, self.margin(i))  # NaN where the margin is negative
            least = make.subtract(self.size(i), make.multiply(self.roundoff, error))
            self._divisors[i] = make.multiply(least, make.divide(root, root))
        return self._divisors[i]

    def _value(self, instruction: Instruction) -> int:
        """Append an instruction of the program, a constant as C rounds it."""
        if instruction.op is Op.CONSTANT:
            return self._builder.constant(self._nearest(instruction))
        return self._builder.copy(instruction, [self._values[j] for j in instruction.operands])

    def _error(self, instruction: Instruction, i: int) -> int | None:
        """Return E of an instruction by the rule for its operation."""
        op, operands = instruction.op, instruction.operands
        if op is Op.INPUT:
            return None
        if op is Op.CONSTANT:
            return self._error_of_constant(instruction)
        if op in (Op.NEGATE, Op.ABS):
            return self.error(operands[0])
        if op in (Op.ADD, Op.SUBTRACT):
            return self._sum([*map(self.error, operands), self.size(i)])
        if op is Op.MULTIPLY:
            return self._error_of_product(i, *operands)
        if op is Op.DIVIDE:
            return self._error_of_quotient(i, *operands)
        if op in CHOICES:
            return self._error_of_choice(op, operands)
        inner = self.error(operands[0])
        if op is Op.SQRT:
            moved = None if inner is None else self._builder.divide(inner, self.size(i))
            return self._sum([moved, self.size(i)])
        if op in TRANSCENDENTAL:
            own = self._builder.multiply(self._builder.constant(roundoffs(op)), self.size(i))
            return self._sum([self._moved_by_operands(op, i, operands), own, self.least])
        assert op in _SINES
        return self._sum([inner, self._builder.constant(self._arithmetic.sine_error)])

    def _moved_by_operands(self, op: Op, i: int, operands: tuple[int, ...]) -> int | None:
        """Return the part of E of exp, log, tanh or atan2 that comes from the errors of the operands."""
        make, a = self._builder, operands[0]
        if op is Op.ATAN2:
            return self._moved_angle(*operands)
        inner = self.error(a)
        if inner is None or op is Op.TANH:
            return inner
        if op is Op.LOG:
            return make.divide(inner, self.divisor(a))
        growth = make.function(Op.EXP, make.multiply(self.roundoff, inner))
        return make.multiply(make.multiply(inner, growth), self.size(i))

    def _moved_angle(self, y: int, x: int) -> int | None:
        """Return the change of the angle of the point (x, y) by the errors of x and y.

        By d a point at the distance r turns at most by arcsin(d/r), which is at most d/(r - d).
        """
        make = self._builder
        moved = self._sum([self.error(y), self.error(x)])
        if moved is None:
            return None
        distance = make.function(Op.MAX, self.size(y), self.size(x))
        left = make.subtract(distance, make.multiply(self.roundoff, moved))
        turned = make.divide(moved, self._where_positive(left))
        if self.error(y) is None:
            return turned
        jump = make.constant(math.tau / self._arithmetic.roundoff)
        zero = make.constant(0.0)
        behind = make.subtract(self.value(x), make.multiply(self.roundoff, self.error(x) or zero))
        across = make.function(Op.SELECT, behind, zero, jump)
        return make.add(turned, make.function(Op.SELECT, self.margin(y), zero, across))

    def _error_of_choice(self, op: Op, operands: tuple[int, ...]) -> int | None:
        """Return E of a sign, a minimum, a maximum or a choice by a condition."""
        make, errors = self._builder, [self.error(j) for j in operands]
        if all(error is None for error in errors):
            return None
        zero = make.constant(0.0)
        present = [zero if error is None else error for error in errors]
        if op in (Op.MIN, Op.MAX):
            return make.function(Op.MAX, *present)
        if op is Op.SIGN:
            return make.function(Op.SELECT, self.margin(operands[0]), zero, self._units(make.constant(2.0)))
        condition, a, b = operands
        own = make.function(Op.SELECT, self.value(condition), present[1], present[2])
        if errors[0] is None:
            return own
        apart = make.function(Op.ABS, make.subtract(self.value(a), self.value(b)))
        either = make.add(self._units(apart), make.add(present[1], present[2]))
        return make.function(Op.SELECT, self.margin(condition), own, either)

    def _units(self, size: int) -> int:
        """Return a magnitude in units of u."""
        return self._builder.multiply(self._builder.constant(1 / self._arithmetic.roundoff), size)

    def _where_positive(self, value: int) -> int:
        """Return a value where it is positive, NaN elsewhere."""
        make = self._builder
        root = make.function(Op.SQRT, value)
        return make.multiply(value, make.divide(root, root))

    def _error_of_product(self, i: int, a: int, b: int) -> int | None:
        """Return E of a product; a power of two of at least 1 only moves the error of its other factor."""
        make = self._builder
        for factor, other in ((a, b), (b, a)):
            instruction = self._program.instructions[factor]
            if instruction.op is Op.CONSTANT and _is_power_of_two(instruction):
                inner = self.error(other)
                return None if inner is None else make.multiply(inner, self.size(factor))
        left, right = self.error(a), self.error(b)
        return self._sum(
            [
                None if left is None else make.multiply(left, self.largest(b)),
                None if right is None else make.multiply(right, self.size(a)),
                self.size(i),
                self.least,
            ]
        )

    def _error_of_quotient(self, i: int, a: int, b: int) -> int:
        """Return E of a quotient."""
        make = self._builder
        above, below = self.error(a), self.error(b)
        parts = [above, None if below is None else make.multiply(self.size(i), below)]
        moved = self._sum(parts)
        total = self._sum(
            [None if moved is None else make.divide(moved, self.divisor(b)), self.size(i), self.least]
        )
        assert total is not None
        return total

    def _sum(self, parts: list[int | None]) -> int | None:
        """Return the sum of the parts that are not None; None if there are none."""
        total: int | None = None
        for part in parts:
            if part is not None:
                total = part if total is None else self._builder.add(total, part)
        return total

    def _nearest(self, instruction: Instruction) -> float:
        """Return a constant as C rounds it, once."""
        return self._arithmetic.precision.rounded(instruction.number, "a constant")

    def _error_of_constant(self, instruction: Instruction) -> int | None:
        """Return E of a constant, rounded up; None if the precision holds the constant."""
        exact = _fraction(instruction)
        off = abs(Fraction(self._nearest(instruction)) - exact) / Fraction(self._arithmetic.roundoff)
        if off == 0:
            return None
        return self._builder.constant(math.nextafter(float(off), math.inf) + self._arithmetic.least)


def slack_holds(program: Program, arithmetic: Arithmetic) -> bool:
    """Return whether `SLACK` covers the rounding of the instructions that compute the bounds of a program.

    Each of them lowers a bound by at most u, so that no bound is lower by more than u times the number of
    instructions on the longest path, d: (1 - u)^-d < 1 + 2 u d. Factors and divisors do not add to that: they
    contain u E with a u that is raised by `RAISED`, which is more.
    """
    depths: list[int] = []
    for instruction in program.instructions:
        depths.append(1 + max((depths[j] for j in instruction.operands), default=0))
    return 2 * arithmetic.roundoff * max(depths, default=0) <= SLACK


def _is_power_of_two(instruction: Instruction) -> bool:
    """Return whether a constant is a power of two of at least 1, by which products are exact."""
    fraction, _ = math.frexp(abs(float(instruction.number)))
    return (
        fraction == 0.5 and abs(instruction.number) >= 1 and float(instruction.number) == instruction.number
    )


def _fraction(instruction: Instruction) -> Fraction:
    """Return the exact number of a constant."""
    if isinstance(instruction.number, float | int):
        return Fraction(instruction.number)
    return as_fraction(MULTIPRECISION.mpf(instruction.number))
