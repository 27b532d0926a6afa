"""Steps whose results are known numbers, since all that they depend on is: constants of fixed parameters.

Such a step is computed as the C does, and exactly in 320 bits; the difference is its error.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from kanegen.measure.bounds.arithmetic import Step
from kanegen.measure.bounds.intervals import Intervals
from kanegen.program.constants import MULTIPRECISION
from kanegen.program.ir import Op


def with_known_values(steps: Sequence[Step], box: Mapping[str, Intervals]) -> tuple[Step, ...]:
    """Return steps in which every one whose result is known is a constant.

    Args:
        steps: Steps of a function.
        box: Intervals (size, 1) of the elements of every input array, by name.
    """
    found: list[Step] = []
    for step in steps:
        known = _fixed_input(step, box) if step.op is Op.INPUT else _result(step, found)
        found.append(step if known is None else known)
    return tuple(found)


def _fixed_input(step: Step, box: Mapping[str, Intervals]) -> Step | None:
    """Return an input that has one value in the whole box as a constant; C has it rounded to its array."""
    elements = box[step.array]
    low, high = float(elements.low[step.index].min()), float(elements.high[step.index].max())
    if low != high:
        return None
    is_short = step.precision.significand_bits <= np.finfo(np.float64).nmant
    return _constant(step, MULTIPRECISION.mpf(low), step.precision.dtype.type(low) if is_short else low)


def _result(step: Step, before: Sequence[Step]) -> Step | None:
    """Return an operation on known values as a constant."""
    operands = [before[j] for j in step.operands]
    if not operands or any(one.op is not Op.CONSTANT for one in operands):
        return None
    exact = [MULTIPRECISION.mpf(one.number) for one in operands]
    computed = [step.precision.dtype.type(one.value_in_c) for one in operands]
    if step.precision.significand_bits > np.finfo(np.float64).nmant + 1:
        return None
    with np.errstate(all="ignore"):
        match step.op, exact, computed:
            case Op.ADD, (a, b), (u, v):
                return _constant(step, a + b, u + v)
            case Op.SUBTRACT, (a, b), (u, v):
                return _constant(step, a - b, u - v)
            case Op.MULTIPLY, (a, b), (u, v):
                return _constant(step, a * b, u * v)
            case Op.DIVIDE, (a, b), (u, v) if b and v:
                return _constant(step, a / b, u / v)
            case Op.SQRT, (a,), (u,) if a > 0 and u > 0:
                return _constant(step, MULTIPRECISION.sqrt(a), np.sqrt(u))
            case Op.NEGATE, (a,), (u,):
                return _constant(step, -a, -u)
            case None, (a,), (u,):
                return _constant(step, a, u)
    return None


def _constant(step: Step, exact: Any, computed: Any) -> Step | None:
    """Return a step as a constant; None where its value is not finite."""
    value = float(computed)
    if not np.isfinite(value):
        return None
    return replace(step, op=Op.CONSTANT, operands=(), number=exact, computed=value)
