"""Whether a precision can hold the numbers of a model.

Constants are folded in double precision and rounded once. One that is too large is refused. One that is too
small becomes 0 or loses digits, as a sum would make of it beside anything of ordinary size: what is left of
`cos(pi/2)` in a model of ordinary numbers is such a constant. But 0 is refused as a divisor, and where the
results hold only if it is positive.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from kanegen.c.interface import PREPARE, Function, ModelFacts
from kanegen.errors import ModelError
from kanegen.precision import DOUBLE, Precision
from kanegen.program.ir import Op, Program


def require_range(
    model: ModelFacts, programs: Mapping[Function, Sequence[Program]], precision: Precision
) -> None:
    """Refuse what `precision` cannot hold; `prepare` computes in double precision whatever it is.

    Raises:
        ModelError: If a parameter or a constant is too large, or a divisor too small.
    """
    if precision is DOUBLE:
        return
    for name, default in model.parameters:
        precision.rounded(default, f"system {model.name!r}: parameter {name!r}")
    for function, pieces in programs.items():
        for piece in pieces if function.name != PREPARE else ():
            _require_constants(piece, precision, f"system {model.name!r}: a constant")


def _require_constants(program: Program, precision: Precision, what: str) -> None:
    vanished = set()
    for i, instruction in enumerate(program.instructions):
        if instruction.op is Op.CONSTANT:
            number = instruction.number
            if precision.rounded(number, what) == 0.0 and number != 0.0:
                vanished.add(i)
    refused = vanished.intersection(_not_zero(program))
    if refused:
        raise ModelError(
            f"{what}: {program.instructions[min(refused)].number!r} is 0 in {precision.words} precision, "
            "but something is divided by it; choose units nearer to 1, or double precision."
        )


def _not_zero(program: Program) -> Iterator[int]:
    """Values that are divided by or must be positive."""
    for instruction in program.instructions:
        if instruction.op is Op.DIVIDE:
            yield instruction.operands[1]
    for output in program.outputs:
        yield from output.positive
