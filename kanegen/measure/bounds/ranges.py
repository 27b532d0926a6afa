"""Ranges of all values of a function over boxes of inputs: exact ones, and those of the computed values.

For every step there is an interval for its exact value, a bound of the error of its computed value, and the
interval widened by this bound, which holds both. The error bounds are crude; `sensitivities` sharpens them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product

import numpy as np

from kanegen.measure.bounds import functions
from kanegen.measure.bounds.arcs import Arcs
from kanegen.measure.bounds.arithmetic import Step
from kanegen.measure.bounds.intervals import Intervals, enclosed, up_product, up_sum, up_total
from kanegen.measure.bounds.lengths import Lengths, Routes
from kanegen.measure.bounds.relations import Component, DoubleTurn, Relations, Term, Turn
from kanegen.measure.bounds.rounding import Roundings
from kanegen.model.arrays import Floats
from kanegen.program.ir import Op

MOST_VALUES = 4
"""Most values of a double turn whose corners are looked at."""

_SLACK = 2.0**-46
"""More than the relative rounding error of a sum of `MOST_VALUES` products with coefficients up to 2."""


@dataclass
class Ranges:
    """Ranges over B boxes, by number of the step.

    Attributes:
        exact: (B,) intervals of the exact values.
        computed: (B,) intervals that hold the exact and the computed values.
        errors: (B,) bounds of |computed - exact|.
        rounding: (B,) bounds of the rounding error of the step itself, and of its jump.
        arcs: Arcs of the angles of sines and cosines, by number of the step.
    """

    exact: list[Intervals] = field(default_factory=list)
    computed: list[Intervals] = field(default_factory=list)
    errors: list[Floats] = field(default_factory=list)
    rounding: list[Floats] = field(default_factory=list)
    arcs: dict[int, Arcs] = field(default_factory=dict)


def ranges(
    steps: Sequence[Step],
    relations: Relations,
    box: Mapping[str, Intervals],
    roundings: Roundings,
    routes: Routes | None = None,
) -> Ranges:
    """Return the ranges of all steps over boxes of inputs.

    Args:
        steps: Steps of a function.
        relations: Their structure.
        box: Intervals (size, B) of the elements of every input array, by name.
        roundings: Bounds of single rounding errors.
        routes: Routes to bounds of lengths, known from a box that holds these; new ones are added.
    """
    found = Ranges()
    sweep = _Sweep(
        steps,
        relations,
        box,
        found,
        Lengths(found.exact, routes or Routes(steps, relations)),
    )
    with np.errstate(all="ignore"):
        for number, step in enumerate(steps):
            exact = sweep.exact(number)
            propagated = sweep.propagated(number)
            operands = [found.computed[j] for j in step.operands]
            jump = sweep.jump(number)
            own = roundings.of(step, steps, operands, up_sum([exact.magnitude, propagated, jump]))
            own = up_sum([own, jump]) if jump.any() else own
            found.exact.append(exact)
            found.rounding.append(own)
            found.errors.append(up_total(propagated, own))
            found.computed.append(exact.widened(found.errors[-1]))
    return found


@dataclass(frozen=True)
class _Sweep:
    """The ranges of the steps before one step."""

    steps: Sequence[Step]
    relations: Relations
    box: Mapping[str, Intervals]
    found: Ranges
    lengths: Lengths

    def exact(self, number: int) -> Intervals:
        """Return the range of the exact value of a step."""
        step = self.steps[number]
        values = [self.found.exact[j] for j in step.operands]
        match step.op, values:
            case Op.INPUT, _:
                elements = self.box[step.array]
                return Intervals(elements.low[step.index], elements.high[step.index])
            case Op.CONSTANT, _:
                return enclosed(step.number)
            case ((Op.ADD | Op.SUBTRACT), (a, b)):
                plain = a.plus(b if step.op is Op.ADD else -b)
                return self._as_turns(number, plain)
            case Op.MULTIPLY, (a, b):
                return a.square() if step.operands[0] == step.operands[1] else a.times(b)
            case Op.DIVIDE, (a, b):
                return a / b
            case Op.NEGATE, (a,):
                return -a
            case Op.ABS, (a,):
                return Intervals(np.maximum(0.0, np.maximum(a.low, -a.high)), a.magnitude)
            case Op.SQRT, (a,):
                return a.root()
            case ((Op.SIN | Op.COS), _):
                arcs = self._arcs(step.operands[0])
                return arcs.sine if step.op is Op.SIN else arcs.cosine
            case Op(), _ if step.op in functions.FUNCTIONS:
                return functions.range_of(step.op, values)
        return values[0]

    def propagated(self, number: int) -> Floats:
        """Return a bound of the error of a step that comes from the errors of its operands."""
        step = self.steps[number]
        exact = [self.found.exact[j] for j in step.operands]
        computed = [self.found.computed[j] for j in step.operands]
        errors = [self.found.errors[j] for j in step.operands]
        match step.op:
            case Op.INPUT | Op.CONSTANT:
                return np.zeros(())
            case Op.ADD | Op.SUBTRACT:
                return up_total(*errors)
            case Op.MULTIPLY:
                return up_total(
                    up_product(exact[1].magnitude, errors[0]),
                    up_product(computed[0].magnitude, errors[1]),
                )
            case Op.DIVIDE:
                quotient = exact[0] / exact[1]
                inner = up_total(errors[0], up_product(quotient.magnitude, errors[1]))
                return up_product(inner, computed[1].reciprocal().magnitude)
            case Op.SQRT:
                return up_product(_seen(errors[0]), root_slope(exact[0], computed[0]).magnitude)
            case Op() if step.op in functions.FUNCTIONS:
                pairs = zip(functions.slopes(step.op, computed), map(_seen, errors), strict=True)
                return up_sum([up_product(slope.magnitude, e) for slope, e in pairs if slope is not None])
        return errors[0]

    def jump(self, number: int) -> Floats:
        """Return a bound of the error of a step that jumps where rounding errors of its operands decide."""
        step = self.steps[number]
        if step.op is None or step.op not in functions.FUNCTIONS:
            return np.zeros(())
        computed = [self.found.computed[j] for j in step.operands]
        return functions.jump_of(step.op, computed, [self.found.errors[j] for j in step.operands])

    def _arcs(self, angle: int) -> Arcs:
        """Return the arcs of an angle."""
        if angle not in self.found.arcs:
            exact = self.found.exact[angle]
            self.found.arcs[angle] = Arcs(np.atleast_1d(exact.low), np.atleast_1d(exact.high))
        return self.found.arcs[angle]

    def _as_turns(self, number: int, plain: Intervals) -> Intervals:
        """Return the range of a sum, made tighter where sine and cosine of one angle meet in it."""
        terms = self.relations.terms(number)
        double = self.relations.double_turn(terms)
        if double is not None and len(double.values) <= MOST_VALUES:
            return self._double_turn(double).within(plain)
        total = None
        while turns := self.relations.turns(terms):
            part = self._turn(turns[0])
            total = part if total is None else total.plus(part)
            terms = turns[0].others
        return plain if total is None else self._plus(total, terms).within(plain)

    def _turn(self, turn: Turn) -> Intervals:
        """Return the range of x cos + y sin."""
        turned = self._arcs(turn.angle).combination(self._signed(turn.x), self._signed(turn.y))
        length = self.lengths.of_pair(turn.x[1], turn.y[1])
        return turned.within(Intervals(-length, length))

    def _double_turn(self, turn: DoubleTurn) -> Intervals:
        """Return the range of a sum with a double turn, the hull over the corners of its values."""
        ends = [(self.found.exact[number].low, self.found.exact[number].high) for number in turn.values]
        arcs = self._arcs(turn.angle).doubled
        low, high = np.asarray(np.inf), np.asarray(-np.inf)
        for corner in product(*ends):
            constant, cosine, sine = (
                sum(c[k] * v for c, v in zip(turn.values.values(), corner, strict=True)) for k in range(3)
            )
            least, most = arcs.extremes(np.asarray(cosine), np.asarray(sine))
            low, high = np.minimum(low, constant + least), np.maximum(high, constant + most)
        magnitude = sum(self.found.exact[number].magnitude for number in turn.values)
        total = Intervals(low, high).widened(np.asarray(_SLACK * magnitude))
        return self._plus(total, turn.others)

    def _plus(self, total: Intervals, terms: Component) -> Intervals:
        for term in terms:
            total = total.plus(self._signed(term))
        return total

    def _signed(self, term: Term) -> Intervals:
        sign, number = term
        return self.found.exact[number] if sign > 0 else -self.found.exact[number]


def _seen(error: Floats) -> Floats:
    """Return an error, or a tiny one instead of none, so that a slope without bound is not lost."""
    return np.maximum(error, 5e-324)


def root_slope(exact: Intervals, computed: Intervals) -> Intervals:
    """Return 1 / (sqrt of a computed number + sqrt of an exact one)."""
    return (exact.root() + computed.root()).reciprocal()
