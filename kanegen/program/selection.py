"""Selection of instructions of a program: the dependencies of values, and programs of some instructions."""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence

from kanegen.program.ir import PARAMETERS, Op, Program


def dependencies(program: Program, wanted: Iterable[int], known: Container[int] = ()) -> list[int]:
    """Return the instructions that the values `wanted` depend on, themselves included, in order.

    Args:
        program: The program in which they stand.
        wanted: Numbers of values.
        known: Values that are available already; nothing is computed for them.
    """
    found: set[int] = set()
    waiting = list(wanted)
    while waiting:
        i = waiting.pop()
        if i not in found and i not in known:
            found.add(i)
            waiting += program.instructions[i].operands
    return sorted(found)


def subprogram(program: Program, order: Sequence[int]) -> Program:
    """Return the program of the instructions `order`, in this order, with the same outputs.

    Args:
        program: The program from which they come.
        order: Numbers of all instructions that the outputs need, operands before their users.
    """
    moved = {i: place for place, i in enumerate(order)}
    instructions = (program.instructions[i] for i in order)
    renumbered = tuple(x.with_operands(tuple([moved[j] for j in x.operands])) for x in instructions)
    return Program(program.inputs, renumbered, tuple(output.renumbered(moved) for output in program.outputs))


def parameter_only(program: Program) -> list[bool]:
    """Return for every instruction whether it depends on nothing but parameters and numbers.

    A sign change does not count: it stays with the instruction that uses it, where it is free.
    """
    early: list[bool] = []
    for instruction in program.instructions:
        if instruction.op is Op.INPUT:
            early.append(instruction.array == PARAMETERS)
        else:
            early.append(instruction.op is not Op.NEGATE and all(early[j] for j in instruction.operands))
    return early
