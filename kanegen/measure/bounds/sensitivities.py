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
from numpy.typing import NDArray

from kanegen.measure.bounds.arithmetic import Step
from kanegen.measure.bounds.functions import FUNCTIONS, slopes
from kanegen.measure.bounds.intervals import Intervals, point, up_product, up_total
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
    steps: Sequence[Step], relations: Relations, found: Ranges, dependents: Dependents
) -> Floats:
    """Return bounds (outputs, B) of the errors of outputs."""
    sweep = _ReverseSweep(steps, relations, found, dependents)
    with np.errstate(all="ignore"):
        return sweep.run()


class Dependents:
    """For every step the outputs that depend on it.

    Args:
        steps: Steps of a function.
        outputs: Numbers of the steps that are outputs.
    """

    def __init__(self, steps: Sequence[Step], outputs: Sequence[int]) -> None:
        self.outputs = outputs
        self._masks = [0] * len(steps)
        self._rows: dict[int, NDArray[np.intp]] = {}
        for row, number in enumerate(outputs):
            self._masks[number] |= 1 << row
        for number in reversed(range(len(steps))):
            for operand in steps[number].operands:
                self._masks[operand] |= self._masks[number]

    def rows(self, number: int) -> NDArray[np.intp]:
        """Return the places of the outputs that depend on a step, in order."""
        mask = self._masks[number]
        if mask not in self._rows:
            bits = bin(mask)[:1:-1]
            self._rows[mask] = np.array([row for row, bit in enumerate(bits) if bit == "1"], dtype=np.intp)
        return self._rows[mask]

    @property
    def adjoints(self) -> int:
        """Number of pairs of a step and an output that depends on it."""
        return sum(mask.bit_count() for mask in self._masks)


class _ReverseSweep:
    """Adjoints of the values that steps after one step use: a row for every output that depends on it."""

    def __init__(
        self, steps: Sequence[Step], relations: Relations, found: Ranges, dependents: Dependents
    ) -> None:
        self._steps = steps
        self._relations = relations
        self._found = found
        self._dependents = dependents
        self._waiting = [Contributions() for _ in steps]

    def run(self) -> Floats:
        """Return bounds (outputs, B) of the errors of the outputs."""
        outputs = self._dependents.outputs
        boxes = max(end.size for one in self._found.computed for end in (one.low, one.high))
        total = np.zeros((len(outputs), boxes))
        for row, number in enumerate(outputs):
            rows = self._dependents.rows(number)
            self._waiting[number].add(point((rows == row).astype(float)[:, None]))
        for number in reversed(range(len(self._steps))):
            adjoint = self.adjoint(number)
            if adjoint is None:
                continue
            rows = self._dependents.rows(number)
            own = up_product(adjoint.magnitude, self._found.rounding[number])
            total[rows] = up_total(total[rows], own)
            self.pass_on(number, adjoint)
        return np.where(np.isnan(total), np.inf, total)

    def adjoint(self, number: int) -> Intervals | None:
        """Return the adjoint of a step, after all steps that use it; None if no output depends on it."""
        contributions = self._waiting[number]
        total, turned = contributions.plain, contributions.turned
        self._waiting[number] = Contributions()
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
        step, found = self._steps[number], self._found
        if step.op is not None and step.op in FUNCTIONS:
            self._pass_function(number, step.op, adjoint)
            return
        match step.op, step.operands:
            case ((Op.INPUT | Op.CONSTANT), _):
                return
            case Op.ADD, (a, b):
                self._add(number, a, adjoint)
                self._add(number, b, adjoint)
            case Op.SUBTRACT, (a, b):
                self._add(number, a, adjoint)
                self._add(number, b, -adjoint)
            case Op.NEGATE, (a,):
                self._add(number, a, -adjoint)
            case Op.MULTIPLY, (a, b):
                self._pass_product(number, a, b, adjoint)
            case Op.DIVIDE, (a, b):
                slope = adjoint * found.computed[b].reciprocal()
                self._add(number, a, slope)
                self._add(number, b, -(slope * found.exact[number]))
            case Op.ABS, (a,):
                self._add(number, a, adjoint * point(1.0).symmetric())
            case Op.SQRT, (a,):
                self._add(number, a, adjoint * root_slope(found.exact[a], found.computed[a]))
            case ((Op.SIN | Op.COS), (a,)):
                if self._steps[a].op is not Op.INPUT:
                    self._add(number, a, adjoint * point(1.0).symmetric())
            case _, (a,):
                self._add(number, a, adjoint)

    def _pass_function(self, number: int, op: Op, adjoint: Intervals) -> None:
        """Add what flows from a function into the adjoints of its operands."""
        operands = self._steps[number].operands
        by_operand = slopes(op, [self._found.computed[j] for j in operands])
        for j, slope in zip(operands, by_operand, strict=True):
            if slope is not None:
                self._add(number, j, adjoint * slope)

    def _pass_product(self, number: int, a: int, b: int, adjoint: Intervals) -> None:
        """Add what flows from a product: b exact times the error of a, a computed times that of b."""
        exact, computed, factors = self._found.exact, self._found.computed, self._relations.factors
        if a == b:
            self._add(number, a, adjoint * (exact[a] + computed[a]))
            return
        if b in factors:
            a, b = b, a
        if a in factors:
            self._add(number, b, adjoint, factors[a])
            self._add(number, a, adjoint * computed[b])
        else:
            self._add(number, a, adjoint * exact[b])
            self._add(number, b, adjoint * computed[a])

    def _add(self, number: int, operand: int, part: Intervals, factor: Factor | None = None) -> None:
        """Add what flows from a step to an operand, on which more outputs may depend.

        A constant has no error that flows farther than its own rounding.
        """
        if self._steps[operand].op is Op.CONSTANT and not np.any(self._found.rounding[operand]):
            return
        rows, all_rows = self._dependents.rows(number), self._dependents.rows(operand)
        if len(rows) < len(all_rows):
            part = part.scattered(np.searchsorted(all_rows, rows), len(all_rows))
        if factor is None:
            self._waiting[operand].add(part)
        else:
            self._waiting[operand].add_turned(factor, part)
