"""Some instructions of a program: which are needed, and the program that only they make."""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence
from dataclasses import replace

from kanegen.program.ir import Op, Program

PARAMETERS = "parameters"
"""The array of run-time parameters."""


def needed(program: Program, wanted: Iterable[int], known: Container[int] = ()) -> list[int]:
    """Instructions that the values `wanted` depend on, themselves included, in order.

    Args:
        program: Where they stand.
        wanted: Numbers of values.
        known: Values that are there already; nothing is computed for them.
    """
    found: set[int] = set()
    waiting = list(wanted)
    while waiting:
        i = waiting.pop()
        if i not in found and i not in known:
            found.add(i)
            waiting += program.instructions[i].operands
    return sorted(found)


def selected(program: Program, order: Sequence[int]) -> Program:
    """The program of the instructions `order`, in this order, with the same outputs.

    Args:
        program: Where they come from.
        order: Whatever the outputs need, operands before their users.
    """
    moved = {i: place for place, i in enumerate(order)}
    instructions = (program.instructions[i] for i in order)
    renumbered = tuple(replace(x, operands=tuple(moved[j] for j in x.operands)) for x in instructions)
    return Program(program.inputs, renumbered, tuple(output.renumbered(moved) for output in program.outputs))


def parameter_only(program: Program) -> list[bool]:
    """Which instructions need nothing else; a sign change stays with its user, where it is free."""
    early: list[bool] = []
    for instruction in program.instructions:
        if instruction.op is Op.INPUT:
            early.append(instruction.array == PARAMETERS)
        else:
            early.append(instruction.op is not Op.NEGATE and all(early[j] for j in instruction.operands))
    return early
