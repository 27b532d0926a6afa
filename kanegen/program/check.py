"""The invariants of a program, which the builder establishes and every pass keeps."""

from __future__ import annotations

import math
from collections.abc import Mapping

from kanegen.program.ir import ARITY, Instruction, Op, Program


class InvariantError(AssertionError):
    """An invariant of a program does not hold; this is a defect of kanegen, never of a model."""


def check(program: Program) -> Program:
    """Verify the invariants of `program` and return it.

    Operands are defined before use, and there are as many as the operation takes. Constants are finite.
    Inputs read an element of a declared array. Names of values are unique, and so are the names of input
    arrays and those of output arrays. Every output element is a defined value, or loops compute it from as
    many values as they need.

    Raises:
        InvariantError: If an invariant does not hold.
    """
    sizes = {array.name: array.size for array in program.inputs}
    arrays = [output.array.name for output in program.outputs]
    for group in ([array.name for array in program.inputs], arrays):
        _require(len(group) == len(set(group)), f"array names are not unique: {group}")
    names: set[str] = set()
    for i, (op, operands, number, array, index, name, _) in enumerate(program.instructions):
        if operands:
            is_right = len(operands) == ARITY[op] and min(operands) >= 0 and max(operands) < i
        elif op is Op.INPUT:
            is_right = 0 <= index < sizes.get(array, 0)
        else:
            is_right = op is Op.CONSTANT and math.isfinite(number)
        if not is_right or name in names:
            raise InvariantError(f"instruction {i} ({op}): {_defect(i, program.instructions[i], sizes)}")
        if name:
            names.add(name)
    for output in program.outputs:
        if output.solution is not None:
            complete = len(output.values) == output.solution.number_of_values + len(output.places or ())
            _require(complete, f"output {output.array.name!r}: wrong number of values for its solution")
            continue
        places = [place for place, _ in output.elements()]
        whole = len(places) == output.array.size or output.places is not None
        unique = len(places) == len(set(places)) and set(places) <= set(range(output.array.size))
        _require(whole and unique, f"output {output.array.name!r}: wrong size")
    defined = all(0 <= value < len(program.instructions) for value in program.results())
    _require(defined, f"an output of {arrays} holds an undefined value")
    return program


def _defect(i: int, instruction: Instruction, sizes: Mapping[str, int]) -> str:
    """Return what is wrong with an instruction.

    Args:
        i: Number of its value.
        instruction: The instruction.
        sizes: Numbers of elements of the input arrays by name.
    """
    if len(instruction.operands) != ARITY[instruction.op]:
        return "wrong number of operands"
    if not all(0 <= j < i for j in instruction.operands):
        return "operand not defined before use"
    if instruction.op is Op.CONSTANT and not math.isfinite(instruction.number):
        return f"{instruction.number} is not finite"
    if instruction.op is Op.INPUT and not 0 <= instruction.index < sizes.get(instruction.array, 0):
        return f"no element {instruction.index} of {instruction.array!r}"
    return f"name {instruction.name!r} assigned twice"


def _require(condition: bool, message: str) -> None:
    if not condition:
        raise InvariantError(message)
