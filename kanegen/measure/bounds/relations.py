"""Structure in a list of steps that makes ranges tight: turns, in which sine and cosine of one angle meet.

Two forms are found in the list itself, whatever passes have done to it. A turn is the part x cos + y sin of a
sum. A double turn is the part of a sum that is linear in some values with coefficients of second degree in
sine and cosine, as in a turned inertia: it is written in the double angle.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from kanegen.measure.bounds.arithmetic import Step
from kanegen.program.ir import Op

LONGEST_SUM = 12
"""Most terms of a sum that is taken apart."""

Term = tuple[int, int]
"""A term of a sum: its sign and the number of a step."""

Component = tuple[Term, ...]
"""A component of a vector as a sum of terms."""

Polynomial = tuple[float, float, float]
"""Coefficients of 1, of the cosine and of the sine of the double angle."""


@dataclass(frozen=True, slots=True)
class Factor:
    """The sine or the cosine of an angle.

    Attributes:
        angle: Number of the step that is the angle.
        is_sine: Whether it is the sine.
    """

    angle: int
    is_sine: bool

    def times(self, other: Factor, scale: float) -> Polynomial:
        """Return `scale` times the product with a factor of the same angle, in the double angle."""
        half = scale / 2
        if self.is_sine != other.is_sine:
            return 0.0, 0.0, half
        return (half, -half, 0.0) if self.is_sine else (half, half, 0.0)


@dataclass(frozen=True, slots=True)
class Turn:
    """The part x cos + y sin of a sum.

    Attributes:
        angle: Number of the step that is the angle.
        x: Sign and number of the step that the cosine multiplies.
        y: Sign and number of the step that the sine multiplies.
        others: The terms beside these two.
    """

    angle: int
    x: Term
    y: Term
    others: Component

    def is_beside(self, other: Turn) -> bool:
        """Return whether both are components of one vector (x, y) in turned axes, up to a sign."""
        swapped = self.x[1] == other.y[1] and self.y[1] == other.x[1]
        right_angle = self.x[0] * self.y[0] == -other.x[0] * other.y[0]
        return self.angle == other.angle and swapped and right_angle


@dataclass(frozen=True, slots=True)
class DoubleTurn:
    """The part of a sum that is linear in values, with coefficients of second degree in sine and cosine.

    Attributes:
        angle: Number of the step that is the angle.
        values: Coefficient of each value, by the number of its step.
        others: The terms beside these.
    """

    angle: int
    values: Mapping[int, Polynomial]
    others: Component


class Relations:
    """The turns among the steps of a function."""

    def __init__(self, steps: Sequence[Step]) -> None:
        self._steps = steps
        self._uses = Counter(j for step in steps for j in step.operands)
        self.factors = {
            i: Factor(step.operands[0], step.op is Op.SIN)
            for i, step in enumerate(steps)
            if step.op in (Op.SIN, Op.COS)
        }
        self._sums: dict[Term, Component] = {}
        self._turns: dict[Component, tuple[Turn, ...]] = {}
        self._scaled = {i: (factor, 1.0) for i, factor in self.factors.items()} | dict(self._multiples())

    @cached_property
    def companions(self) -> Mapping[int, frozenset[int]]:
        """For every step the steps that are components of the same turned vector."""
        groups: dict[tuple[int, frozenset[int]], set[int]] = defaultdict(set)
        for number in range(len(self._steps)):
            for turn in self.turns(self.terms(number)):
                groups[turn.angle, frozenset((turn.x[1], turn.y[1]))].add(number)
        found: dict[int, frozenset[int]] = defaultdict(frozenset)
        for group in groups.values():
            for number in group:
                found[number] |= group - {number}
        return found

    def terms(self, number: int, sign: int = 1) -> Component:
        """Return a step as a sum of terms; sums that other steps use, too, are one term."""
        if (number, sign) not in self._sums:
            found = tuple(self._terms(number, sign, outermost=True))
            self._sums[number, sign] = found if len(found) <= LONGEST_SUM else ((sign, number),)
        return self._sums[number, sign]

    def turns(self, terms: Component) -> tuple[Turn, ...]:
        """Return every turn among terms."""
        if terms not in self._turns:
            self._turns[terms] = tuple(self._found_turns(terms))
        return self._turns[terms]

    def _found_turns(self, terms: Component) -> Iterator[Turn]:
        for i, (sign, number) in enumerate(terms):
            for factor, other in self._products(number):
                for k, (other_sign, other_number) in enumerate(terms) if not factor.is_sine else ():
                    for partner, across in self._products(other_number) if k != i else ():
                        if partner == Factor(factor.angle, is_sine=True):
                            others = tuple(term for n, term in enumerate(terms) if n not in (i, k))
                            yield Turn(factor.angle, (sign, other), (other_sign, across), others)

    def double_turn(self, terms: Component) -> DoubleTurn | None:
        """Return the first double turn among terms; None if there is none."""
        for place, (sign, number) in enumerate(terms):
            for outer, scale, inner in self._scaled_products(number):
                values = self._second_degree(outer, scale * sign, self.terms(inner))
                if values is not None:
                    others = [term for k, term in enumerate(terms) if k != place]
                    for own_sign, own in [term for term in others if term[1] in values]:
                        constant, *double = values[own]
                        values[own] = (constant + own_sign, double[0], double[1])
                        others.remove((own_sign, own))
                    return DoubleTurn(outer.angle, values, tuple(others))
        return None

    def _second_degree(self, outer: Factor, scale: float, terms: Component) -> dict[int, Polynomial] | None:
        """Return the coefficients of values in a factor times terms that all hold a factor of its angle."""
        found: dict[int, Polynomial] = {}
        for sign, number in terms:
            readings = [(f, k, v) for f, k, v in self._scaled_products(number) if f.angle == outer.angle]
            if not readings:
                return None
            inner, inner_scale, value = readings[0]
            for own_sign, own in self.terms(value):
                added = outer.times(inner, scale * inner_scale * sign * own_sign)
                before = found.get(own, (0.0, 0.0, 0.0))
                found[own] = (before[0] + added[0], before[1] + added[1], before[2] + added[2])
        return found

    def _terms(self, number: int, sign: int, *, outermost: bool = False) -> Iterator[Term]:
        """Yield signs and numbers of the terms of a sum."""
        step = self._steps[number]
        if step.op is Op.NEGATE:
            yield from self._terms(step.operands[0], -sign, outermost=outermost)
        elif step.op in (Op.ADD, Op.SUBTRACT) and (outermost or self._uses[number] == 1):
            a, b = step.operands
            yield from self._terms(a, sign)
            yield from self._terms(b, sign if step.op is Op.ADD else -sign)
        else:
            yield sign, number

    def _products(self, number: int) -> Iterator[tuple[Factor, int]]:
        """Yield each way to read a step as sine or cosine times another step."""
        for factor, scale, other in self._scaled_products(number):
            if scale == 1.0:
                yield factor, other

    def _scaled_products(self, number: int) -> Iterator[tuple[Factor, float, int]]:
        """Yield each way to read a step as a multiple of sine or cosine, times another step."""
        step = self._steps[number]
        if step.op is Op.MULTIPLY:
            a, b = step.operands
            for one, other in ((a, b), (b, a)) if a != b else ():
                if one in self._scaled:
                    factor, scale = self._scaled[one]
                    yield factor, scale, other

    def _multiples(self) -> Iterator[tuple[int, tuple[Factor, float]]]:
        """Yield the steps that are twice a sine or cosine."""
        for number, step in enumerate(self._steps):
            if step.op is Op.MULTIPLY:
                for one, other in (step.operands, step.operands[::-1]):
                    constant = self._steps[one]
                    if constant.op is Op.CONSTANT and constant.number == 2 and other in self.factors:
                        yield number, (self.factors[other], 2.0)
