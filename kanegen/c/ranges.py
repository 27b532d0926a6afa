"""Whether a precision can hold the numbers of a model.

Constants are folded in double precision and rounded once. One that is too large is refused. One that is too
small becomes 0 or loses digits, as a sum would make of it beside anything of ordinary size: what is left of
`cos(pi/2)` in a model of ordinary numbers is such a constant. But 0 is refused as a divisor, and where the
results hold only if it is positive.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from kanegen.c.formats import Formats
from kanegen.c.interface import PREPARE, Function, ModelFacts
from kanegen.errors import ModelError
from kanegen.program.ir import Op, Program
from kanegen.program.precision import Precision


def require_range(
    model: ModelFacts, programs: Mapping[Function, Sequence[Program]], formats: Formats
) -> None:
    """Refuse what the precisions cannot hold; `prepare` computes at least in double precision.

    Raises:
        ModelError: If a parameter or a constant is too large, or a divisor too small.
    """
    for name, default in model.parameters:
        formats.parameters.rounded(default, f"system {model.name!r}: parameter {name!r}")
    for function, pieces in programs.items():
        for piece in pieces if function.name != PREPARE else ():
            _require_constants(piece, formats.arithmetic, f"system {model.name!r}: a constant")
            _require_results(piece, formats.storage, f"system {model.name!r}: a result")


def _require_constants(program: Program, precision: Precision, what: str) -> None:
    vanished = set()
    for i, instruction in enumerate(program.instructions):
        if instruction.op is Op.CONSTANT:
            number = float(instruction.number)
            if precision.rounded(number, what) == 0.0 and number != 0.0:
                vanished.add(i)
    refused = vanished.intersection(_not_zero(program))
    if refused:
        number = float(program.instructions[min(refused)].number)
        raise ModelError(
            f"{what}: {number!r} is 0 in {precision.label} precision, "
            "but something is divided by it; choose units nearer to 1, or double precision."
        )


def _require_results(program: Program, precision: Precision, what: str) -> None:
    for value in program.results():
        if program.instructions[value].op is Op.CONSTANT:
            precision.rounded(program.instructions[value].number, what)


def _not_zero(program: Program) -> Iterator[int]:
    """Values that are divided by or must be positive."""
    for instruction in program.instructions:
        if instruction.op is Op.DIVIDE:
            yield instruction.operands[1]
    for output in program.outputs:
        yield from output.exists_if_positive
