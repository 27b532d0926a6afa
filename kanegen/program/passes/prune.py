"""Drop every instruction that no output needs."""

from __future__ import annotations

from dataclasses import replace

from kanegen.program.ir import Instruction, Program


def prune(program: Program) -> Program:
    """The same outputs without dead code; the order of what remains is kept."""
    needed = [False] * len(program.instructions)
    for value in program.results():
        needed[value] = True
    for i in range(len(needed) - 1, -1, -1):
        if needed[i]:
            for operand in program.instructions[i].operands:
                needed[operand] = True
    moved: dict[int, int] = {}
    kept: list[Instruction] = []
    for i, instruction in enumerate(program.instructions):
        if needed[i]:
            moved[i] = len(kept)
            kept.append(replace(instruction, operands=tuple(moved[j] for j in instruction.operands)))
    outputs = tuple(output.renumbered(moved) for output in program.outputs)
    return Program(program.inputs, tuple(kept), outputs)
