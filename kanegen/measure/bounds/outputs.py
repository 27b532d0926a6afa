"""Proven bounds of the errors of all outputs of a module, over a box of inputs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from kanegen.c.formats import Formats
from kanegen.measure.bounds.arithmetic import Evaluation, Step, evaluation, needed
from kanegen.measure.bounds.intervals import Intervals
from kanegen.measure.bounds.known_values import with_known_values
from kanegen.measure.bounds.lengths import Routes
from kanegen.measure.bounds.ranges import Ranges, ranges
from kanegen.measure.bounds.relations import Relations
from kanegen.measure.bounds.rounding import Roundings
from kanegen.measure.bounds.sensitivities import Dependents, output_errors
from kanegen.measure.bounds.subdivision import PARTS, Box, Element, Subdivision, columns_of
from kanegen.model.arrays import Floats
from kanegen.program.ir import Array, Module, Op
from kanegen.recursion.legend import meaning_at_places

MOST_ADJOINTS = 8_000_000
"""Most adjoints, those of one box times the number of its parts."""

LEAST_ADJOINTS = 200
"""Least number of adjoints, as a multiple of that of steps, for whose sake all steps are run once more."""

AT_ONCE = 2**17
"""Most numbers that one operation on arrays computes."""

_NOTHING_BEFORE = "an input"


@dataclass(frozen=True)
class OutputBound:
    """Bounds of one output array.

    Attributes:
        errors: Bounds of |computed - exact|, in the shape of the array.
        magnitudes: Bounds of |exact|.
        reason: Why there is no bound; "" where there is one.
    """

    errors: Floats
    magnitudes: Floats
    reason: str = ""

    def worse(self, other: OutputBound) -> OutputBound:
        """Return bounds that hold for two programs of the same output."""
        return OutputBound(
            np.maximum(self.errors, other.errors),
            np.minimum(self.magnitudes, other.magnitudes),
            self.reason or other.reason,
        )


class Bounder:
    """Bounds of the outputs of the functions of one module.

    Args:
        module: The programs.
        formats: Precisions of arithmetic and arrays.
        roundings: Bounds of single rounding errors.
        box: Intervals (size, B) of the elements of every input array, by name.
    """

    def __init__(
        self, module: Module, formats: Formats, roundings: Roundings, box: Mapping[str, Intervals]
    ) -> None:
        self._module = module
        self._formats = formats
        self._roundings = roundings
        self._box = box
        self._known: dict[tuple[object, ...], OutputBound] = {}

    def bound(self, array: str) -> OutputBound:
        """Return the bounds of an output array, which hold for every function that fills it."""
        found: OutputBound | None = None
        for name, program in self._module.functions.items():
            if any(output.array.name == array for output in program.outputs):
                own = self._of_function(name, array)
                found = own if found is None else found.worse(own)
        if found is None:
            raise KeyError(array)
        return found

    def _of_function(self, function: str, name: str) -> OutputBound:
        """Return the bounds of an output array of one function."""
        whole = evaluation(self._module, function, self._formats)
        array = next(array for array in whole.outputs if array.name == name)
        alone = needed(whole, array)
        alone = replace(alone, steps=with_known_values(alone.steps, self._box))
        key = (alone.steps, alone.outputs[array], alone.conditions[array])
        if key not in self._known:
            self._known[key] = self._of_steps(alone, array)
        return self._known[key]

    def _of_steps(self, alone: Evaluation, array: Array) -> OutputBound:
        steps, relations = alone.steps, Relations(alone.steps)
        routes = Routes(steps, relations)
        numbers = sorted({number for _, number in alone.outputs[array]})
        dependents = Dependents(steps, numbers)

        def found_in(box: Box) -> Ranges:
            return ranges(steps, relations, box, self._roundings, routes)

        def bounds(box: Box) -> Floats:
            at_once = max(1, AT_ONCE // max(1, len(numbers)))
            parts = columns_of(box, at_once)
            every = [output_errors(steps, relations, found_in(part), dependents) for part in parts]
            return np.concatenate(every, axis=1)

        most = MOST_ADJOINTS // max(1, dependents.adjoints)
        least = max(PARTS, LEAST_ADJOINTS * len(steps) // max(1, dependents.adjoints))
        division = Subdivision(self._box, _angles(steps) if most > PARTS else ())
        found = found_in(division.first)
        reason = _no_bound(steps, found, alone.conditions[array])
        if reason:
            errors = np.full(len(numbers), np.inf)
        else:
            errors = division.bounds(output_errors(steps, relations, found, dependents), least, most, bounds)
        magnitudes = {i: float(found.exact[i].magnitude.max()) for i in numbers}
        by_number = dict(zip(numbers, errors, strict=True))
        return OutputBound(
            _filled(array, alone.outputs[array], by_number),
            _filled(array, alone.outputs[array], magnitudes),
            reason,
        )


def _filled(array: Array, elements: Sequence[tuple[int, int]], values: Mapping[int, float]) -> Floats:
    """Return an array of the values of its elements, 0 where an element is not filled."""
    found = np.zeros(array.size)
    for place, number in elements:
        found[place] = values[number]
    return found.reshape(array.shape)


def _angles(steps: Sequence[Step]) -> list[Element]:
    """Return the elements of input arrays of which sine or cosine is taken."""
    angles = {step.operands[0] for step in steps if step.op in (Op.SIN, Op.COS)}
    found = {(steps[i].array, steps[i].index) for i in angles if steps[i].op is Op.INPUT}
    return sorted(found)


def _no_bound(steps: Sequence[Step], found: Ranges, conditions: Sequence[int]) -> str:
    """Return why there is no bound; "" if nothing is undefined, overflows or fails."""
    for number in range(len(steps)):
        if not found.computed[number].is_bounded or not np.isfinite(found.rounding[number]).all():
            return _undefined(steps, found, number)
    for number in conditions:
        low = found.computed[number].low.min()
        if not low > 0:
            what = _called(steps, number)
            return f"{what}, which must be positive, is only known to be above {low:.3g} in the box"
    return ""


def _undefined(steps: Sequence[Step], found: Ranges, number: int) -> str:
    """Return what may be undefined, or too large, in the first step without bound."""
    step, what = steps[number], _called(steps, number)
    if step.op is Op.DIVIDE and not found.computed[number].is_bounded:
        divisor = found.computed[step.operands[1]]
        if (divisor.low <= 0).any() and (divisor.high >= 0).any():
            return f"the divisor {_called(steps, step.operands[1])} of {what} may be 0 in the box"
    if step.op is Op.SQRT and (found.computed[step.operands[0]].low <= 0).any():
        return f"{_called(steps, step.operands[0])}, whose root is taken, may be 0 or negative in the box"
    if step.op is Op.LOG and (found.computed[step.operands[0]].low <= 0).any():
        return (
            f"{_called(steps, step.operands[0])}, whose logarithm is taken, may be 0 or negative in the box"
        )
    if step.op is Op.ATAN2:
        return f"the point whose angle is {what} may be the origin in the box"
    if step.op in (Op.SIN, Op.COS):
        return f"the angle {_called(steps, step.operands[0])} may be larger than kanegen's sine is proven for"
    return f"{what} may leave the range of {step.precision.label} precision in the box"


def _called(steps: Sequence[Step], number: int) -> str:
    """Return the name of a step, or what it is a part of."""
    step = steps[number]
    if step.op is Op.INPUT:
        return f"{step.array}[{step.index}]"
    if step.name:
        meaning = meaning_at_places(step.name) or step.note
        return f"{step.name} ({meaning})" if meaning else step.name
    users = (k for k in range(number, len(steps)) if number in steps[k].operands and steps[k].name)
    user = next(users, None)
    return f"a value of operation {step.op}" if user is None else f"a part of {_called(steps, user)}"
