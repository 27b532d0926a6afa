"""The invariants of a program, which the builder establishes and every pass keeps."""

from __future__ import annotations

import math

from kanegen.program.ir import ARITY, Op, Program


class InvariantError(AssertionError):
    """An invariant of a program does not hold; this is a defect of kanegen, never of a model."""


def check(program: Program) -> Program:
    """Verify the invariants of `program` and return it.

    Operands are defined before use, and there are as many as the operation takes. Constants are finite.
    Inputs read an element of a declared array. Names of values are unique, and so are the names of input
    arrays and those of output arrays. Every output element is a defined value.

    Raises:
        InvariantError: If an invariant does not hold.
    """
    sizes = {array.name: array.size for array in program.inputs}
    arrays = [output.array.name for output in program.outputs]
    for group in ([array.name for array in program.inputs], arrays):
        _require(len(group) == len(set(group)), f"array names are not unique: {group}")
    names: set[str] = set()
    for i, instruction in enumerate(program.instructions):
        where = f"instruction {i} ({instruction.op})"
        _require(len(instruction.operands) == ARITY[instruction.op], f"{where}: wrong number of operands")
        _require(all(0 <= j < i for j in instruction.operands), f"{where}: operand not defined before use")
        if instruction.op is Op.CONSTANT:
            _require(math.isfinite(instruction.number), f"{where}: {instruction.number} is not finite")
        if instruction.op is Op.INPUT:
            size = sizes.get(instruction.array, 0)
            _require(
                0 <= instruction.index < size,
                f"{where}: no element {instruction.index} of {instruction.array!r}",
            )
        if instruction.name:
            _require(instruction.name not in names, f"{where}: name {instruction.name!r} assigned twice")
            names.add(instruction.name)
    for output in program.outputs:
        places = [place for place, _ in output.elements()]
        whole = len(places) == output.array.size or output.places is not None
        unique = len(places) == len(set(places)) and set(places) <= set(range(output.array.size))
        _require(whole and unique, f"output {output.array.name!r}: wrong size")
    defined = all(0 <= value < len(program.instructions) for value in program.results())
    _require(defined, f"an output of {arrays} holds an undefined value")
    return program


def _require(condition: bool, message: str) -> None:
    if not condition:
        raise InvariantError(message)
