"""The precision of every array, and the check that it can hold the numbers of a model.

States, loads and results have the precision that was chosen for storage. Parameters have the default storage
precision of the arithmetic. Prepared constants and the workspace have the precision of the arithmetic and are
not rounded.

Constants are folded in 320 bits and rounded once. A constant that is too large is refused.
A constant that is too small becomes 0 or loses digits, which is harmless in a sum: `cos(pi/2)` leaves such
constants in a model of ordinary numbers. But 0 is refused as a divisor, and where a value must be positive.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from kanegen.c.description import ModelDescription
from kanegen.c.interface import PREPARE, Function
from kanegen.errors import ModelError, quoted
from kanegen.options import Variant
from kanegen.program import precision as precisions
from kanegen.program.ir import PARAMETERS, PREPARED, WORKSPACE, Op, Program
from kanegen.program.precision import DOUBLE, Precision


@dataclass(frozen=True)
class Formats:
    """The precisions of the arrays and of the arithmetic of one model.

    Attributes:
        arithmetic: Precision of everything that is computed from a state.
        storage: Precision of states, loads and results.
    """

    arithmetic: Precision = DOUBLE
    storage: Precision = DOUBLE

    @property
    def parameters(self) -> Precision:
        """Precision of run-time parameters."""
        return precisions.storage_precision(self.arithmetic.name)

    @property
    def preparing(self) -> Precision:
        """Precision in which parameter-only values are computed: at least double."""
        return max(DOUBLE, self.arithmetic, key=lambda precision: precision.significand_bits)

    @property
    def is_mixed(self) -> bool:
        """Whether states and results are converted before and after the arithmetic."""
        return self.arithmetic is not self.storage

    @property
    def every(self) -> tuple[Precision, ...]:
        """All precisions that occur, each once."""
        return tuple(dict.fromkeys((self.storage, self.parameters, self.arithmetic)))

    def of(self, array: str) -> Precision:
        """Return the precision of the array of this name."""
        if array == PARAMETERS:
            return self.parameters
        return self.arithmetic if array in (PREPARED, WORKSPACE) else self.storage


def formats(variant: Variant) -> Formats:
    """Return the precisions that `variant` asks for."""
    return Formats(
        precisions.precision_named(variant.precision),
        precisions.storage_precision(variant.precision, variant.storage),
    )


def uniform(precision: Precision) -> Formats:
    """Return one precision for all arrays and the arithmetic."""
    return Formats(precision, precision)


def require_range(
    model: ModelDescription, programs: Mapping[Function, Sequence[Program]], formats: Formats
) -> None:
    """Refuse numbers that the precisions cannot hold; `prepare` computes at least in double precision.

    Raises:
        ModelError: If a parameter or a constant is too large, or a divisor too small.
    """
    for name, default in model.parameters:
        formats.parameters.rounded(default, f"system {quoted(model.shown)}: parameter {name!r}")
    for function, parts in programs.items():
        for part in parts if function.name != PREPARE else ():
            _require_constants(part, formats.arithmetic, f"system {quoted(model.shown)}: a constant")
            _require_results(part, formats.storage, f"system {quoted(model.shown)}: a result")


def _require_constants(program: Program, precision: Precision, label: str) -> None:
    numbers = {i: x.number for i, x in enumerate(program.instructions) if x.op is Op.CONSTANT}
    vanished = {i for i, number in numbers.items() if precision.rounded(number, label) == 0.0 and number != 0}
    refused = vanished.intersection(_not_zero(program))
    if refused:
        number = float(program.instructions[min(refused)].number)
        raise ModelError(
            f"{label}: {number!r} is 0 in {precision.label} precision, "
            "but something is divided by it; choose units nearer to 1, or double precision."
        )


def _require_results(program: Program, precision: Precision, label: str) -> None:
    for value in program.results():
        if program.instructions[value].op is Op.CONSTANT:
            precision.rounded(program.instructions[value].number, label)


def _not_zero(program: Program) -> Iterator[int]:
    """Yield the values that something is divided by or that must be positive."""
    for instruction in program.instructions:
        if instruction.op is Op.DIVIDE:
            yield instruction.operands[1]
    for output in program.outputs:
        yield from output.exists_if_positive
