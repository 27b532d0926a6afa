"""The operations of one C function as they are rounded: each with its precision, conversions included.

A function reads prepared constants, so the operations of `prepare` come first. What is read or written in
another precision than that of the arithmetic is converted, which is an operation of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from kanegen.c.formats import Formats
from kanegen.program.ir import PREPARED, Array, Instruction, Module, Op, Program
from kanegen.program.precision import Precision


@dataclass(frozen=True, slots=True)
class Step:
    """One rounded operation.

    Attributes:
        op: The operation; None is the conversion of a value to `precision`.
        operands: Numbers of earlier steps.
        precision: Precision of the result.
        number: The exact value of a constant.
        array: Name of the input array that is read.
        index: Index of the element that is read.
        name: Name of the quantity in C; "" for a part of an expression.
        note: The group of quantities that it belongs to.
        computed: The value that a constant has in C; None is `number` in its precision.
    """

    op: Op | None
    operands: tuple[int, ...]
    precision: Precision
    number: Any = 0.0
    array: str = ""
    index: int = 0
    name: str = ""
    note: str = ""
    computed: float | None = None

    @property
    def value_in_c(self) -> float:
        """The value that a constant has in C, or the nearest double where that has fewer digits."""
        return self.precision.rounded(self.number, "a constant") if self.computed is None else self.computed


@dataclass(frozen=True)
class Evaluation:
    """The steps of one C function.

    Attributes:
        steps: Steps in order.
        outputs: For each output array the numbers of the steps that are its elements, and their places.
        conditions: Numbers of the steps that must be positive for an output to exist, by output array.
    """

    steps: tuple[Step, ...]
    outputs: dict[Array, tuple[tuple[int, int], ...]]
    conditions: dict[Array, tuple[int, ...]]


def evaluation(module: Module, function: str, formats: Formats) -> Evaluation:
    """Return the rounded operations of a function of a module, those of `prepare` first."""
    recorder = _Recorder(formats)
    prepared: list[int] = []
    if module.prepare is not None:
        (output,) = module.prepare.outputs
        values = recorder.run(module.prepare, formats.preparing, [])
        prepared = [recorder.converted(values[i], formats.arithmetic) for i in output.values]
    program = module.functions[function]
    values = recorder.run(program, formats.arithmetic, prepared)
    outputs = {
        output.array: tuple(
            (place, recorder.converted(values[i], formats.of(output.array.name)))
            for place, i in output.elements()
        )
        for output in program.outputs
    }
    conditions = {
        output.array: tuple(values[i] for i in output.exists_if_positive) for output in program.outputs
    }
    return Evaluation(tuple(recorder.steps), outputs, conditions)


def needed(whole: Evaluation, array: Array) -> Evaluation:
    """Return the steps that one output array and its conditions need, and no others."""
    wanted = {number for _, number in whole.outputs[array]} | set(whole.conditions[array])
    for number in reversed(range(len(whole.steps))):
        if number in wanted:
            wanted.update(whole.steps[number].operands)
    moved = {number: place for place, number in enumerate(sorted(wanted))}
    steps = (whole.steps[number] for number in sorted(wanted))
    return Evaluation(
        tuple(replace(step, operands=tuple(moved[j] for j in step.operands)) for step in steps),
        {array: tuple((place, moved[number]) for place, number in whole.outputs[array])},
        {array: tuple(moved[number] for number in whole.conditions[array])},
    )


class _Recorder:
    """Steps of several programs in the order of their evaluation, while they are put together."""

    def __init__(self, formats: Formats) -> None:
        self.steps: list[Step] = []
        self._formats = formats

    def run(self, program: Program, precision: Precision, prepared: Sequence[int]) -> list[int]:
        """Append the instructions of a program, and return the number of the step for each of them."""
        found: list[int] = []
        for instruction in program.instructions:
            if instruction.array == PREPARED:
                found.append(prepared[instruction.index])
            elif instruction.op is Op.INPUT:
                found.append(self._read(instruction, precision))
            else:
                operands = tuple(found[j] for j in instruction.operands)
                found.append(self._append(instruction, operands, precision))
        return found

    def converted(self, value: int, precision: Precision) -> int:
        """Return the step of a value in a precision, converted where this one has fewer digits."""
        if self.steps[value].precision.significand_bits <= precision.significand_bits:
            return value
        self.steps.append(Step(None, (value,), precision, name=self.steps[value].name))
        return len(self.steps) - 1

    def _read(self, instruction: Instruction, precision: Precision) -> int:
        """Append the reading of an input, which is exact in the precision of its array."""
        stored = self._formats.of(instruction.array)
        return self.converted(self._append(instruction, (), stored), precision)

    def _append(self, x: Instruction, operands: tuple[int, ...], precision: Precision) -> int:
        self.steps.append(Step(x.op, operands, precision, x.number, x.array, x.index, x.name, x.note))
        return len(self.steps) - 1
