"""Bounds of the errors of outputs: one reverse sweep that weighs the rounding error of every step.

The error e of a computed product is a^ b^ - a b = b e_a + a^ e_b, where a^ is computed and b is exact. It is
linear in the errors of the operands with a coefficient between computed and exact values, and so is every
other operation. Therefore the error of an output is a sum over all steps of an adjoint times the rounding
error of the step, without terms of second order, if the ranges of the coefficients hold both values.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from kanegen.measure.bounds.arithmetic import Step
from kanegen.measure.bounds.functions import FUNCTIONS, slopes
from kanegen.measure.bounds.intervals import Intervals, point, up_product, up_sum
from kanegen.measure.bounds.ranges import Ranges, root_slope
from kanegen.measure.bounds.relations import Factor, Relations
from kanegen.model.arrays import Floats
from kanegen.program.ir import Op


@dataclass
class Contributions:
    """What flows into the adjoint of one value from the steps that use it.

    Attributes:
        plain: Sum of all contributions without a sine or cosine as coefficient; None before the first.
        turned: Contributions to be multiplied by a sine or cosine, by this factor.
    """

    plain: Intervals | None = None
    turned: dict[Factor, Intervals] = field(default_factory=dict)

    def add(self, part: Intervals) -> None:
        """Add a contribution whose coefficient is neither a sine nor a cosine."""
        self.plain = part if self.plain is None else self.plain + part

    def add_turned(self, factor: Factor, part: Intervals) -> None:
        """Add a contribution that a sine or cosine multiplies."""
        known = self.turned.get(factor)
        self.turned[factor] = part if known is None else known + part


def output_errors(
    steps: Sequence[Step], relations: Relations, found: Ranges, outputs: Sequence[int]
) -> Floats:
    """Return bounds (outputs, B) of the errors of the steps `outputs`."""
    sweep = _ReverseSweep(steps, relations, found, len(outputs))
    with np.errstate(all="ignore"):
        for row, number in enumerate(outputs):
            unit = np.zeros((len(outputs), 1))
            unit[row] = 1.0
            sweep.waiting[number].add(point(unit))
        total: Floats = np.zeros((len(outputs), 1))
        for number in reversed(range(len(steps))):
            adjoint = sweep.adjoint(number)
            if adjoint is None:
                continue
            own = up_product(adjoint.magnitude, found.rounding[number])
            total = up_sum([total, own])
            sweep.pass_on(number, adjoint)
    return np.where(np.isnan(total), np.inf, total)


class _ReverseSweep:
    """Adjoints (outputs, B) of the values that steps after one step use."""

    def __init__(self, steps: Sequence[Step], relations: Relations, found: Ranges, outputs: int) -> None:
        self._steps = steps
        self._relations = relations
        self._found = found
        self.waiting = [Contributions() for _ in steps]

    def adjoint(self, number: int) -> Intervals | None:
        """Return the adjoint of a step, after all steps that use it; None if no output depends on it."""
        contributions = self.waiting[number]
        total = contributions.plain
        turned = dict(contributions.turned)
        self.waiting[number] = Contributions()
        while turned:
            factor, part = turned.popitem()
            partner = turned.pop(Factor(factor.angle, not factor.is_sine), None)
            arcs = self._found.arcs[factor.angle]
            if partner is None:
                own = (arcs.sine if factor.is_sine else arcs.cosine) * part
            else:
                cosine, sine = (partner, part) if factor.is_sine else (part, partner)
                own = arcs.combination(cosine, sine)
            total = own if total is None else total + own
        return total

    def pass_on(self, number: int, adjoint: Intervals) -> None:
        """Add what flows from a step into the adjoints of its operands."""
        step, waiting = self._steps[number], self.waiting
        if step.op is not None and step.op in FUNCTIONS:
            self._pass_function(step.op, step.operands, adjoint)
            return
        match step.op, step.operands:
            case ((Op.INPUT | Op.CONSTANT), _):
                return
            case Op.ADD, (a, b):
                waiting[a].add(adjoint)
                waiting[b].add(adjoint)
            case Op.SUBTRACT, (a, b):
                waiting[a].add(adjoint)
                waiting[b].add(-adjoint)
            case Op.NEGATE, (a,):
                waiting[a].add(-adjoint)
            case Op.MULTIPLY, (a, b):
                self._pass_product(a, b, adjoint)
            case Op.DIVIDE, (a, b):
                slope = adjoint * self._found.computed[b].reciprocal()
                waiting[a].add(slope)
                waiting[b].add(-(slope * self._found.exact[number]))
            case Op.ABS, (a,):
                waiting[a].add(adjoint * point(1.0).symmetric())
            case Op.SQRT, (a,):
                waiting[a].add(adjoint * root_slope(self._found.exact[a], self._found.computed[a]))
            case ((Op.SIN | Op.COS), (a,)):
                if self._steps[a].op is not Op.INPUT:
                    waiting[a].add(adjoint * point(1.0).symmetric())
            case _, (a,):
                waiting[a].add(adjoint)

    def _pass_function(self, op: Op, operands: Sequence[int], adjoint: Intervals) -> None:
        """Add what flows from a function into the adjoints of its operands."""
        by_operand = slopes(op, [self._found.computed[j] for j in operands])
        for j, slope in zip(operands, by_operand, strict=True):
            if slope is not None:
                self.waiting[j].add(adjoint * slope)

    def _pass_product(self, a: int, b: int, adjoint: Intervals) -> None:
        """Add what flows from a product: b exact times the error of a, a computed times that of b."""
        exact, computed, factors = self._found.exact, self._found.computed, self._relations.factors
        if a == b:
            self.waiting[a].add(adjoint * (exact[a] + computed[a]))
            return
        if b in factors:
            a, b = b, a
        if a in factors:
            self.waiting[b].add_turned(factors[a], adjoint)
            self.waiting[a].add(adjoint * computed[b])
        else:
            self.waiting[a].add(adjoint * exact[b])
            self.waiting[b].add(adjoint * computed[a])
