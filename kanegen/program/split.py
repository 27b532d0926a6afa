"""Cut one program for all outputs into the functions of a C file.

What depends on parameters alone goes into `prepare`, which runs once; the functions read its results.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from kanegen.program.arrange import arrange
from kanegen.program.builder import Builder
from kanegen.program.check import check
from kanegen.program.ir import Array, Module, Op, Output, Program
from kanegen.program.passes.prune import prune

PARAMETERS = "parameters"
"""The array of run-time parameters."""

PREPARED = "prepared"
"""The array of what depends on them alone."""


class Signature(NamedTuple):
    """Names of the arrays that a function reads and fills."""

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


def split(program: Program, functions: Mapping[str, Signature], parameters: str) -> Module:
    """One program for every function, and `prepare` where the program reads parameters.

    Args:
        program: All outputs together.
        functions: What every function reads and fills; `prepared` goes first where there is one.
        parameters: Name of the input array that holds run-time parameters.
    """
    prepare = None
    if any(array.name == parameters for array in program.inputs):
        prepare, program = _hoist(program, parameters)
    restricted = {name: _restrict(program, signature) for name, signature in functions.items()}
    return Module(prepare, restricted)


def _restrict(program: Program, signature: Signature) -> Program:
    inputs = tuple(array for array in program.inputs if array.name in (PREPARED, *signature.inputs))
    outputs = tuple(output for output in program.outputs if output.array.name in signature.outputs)
    return check(arrange(prune(replace(program, inputs=inputs, outputs=outputs))))


def _hoist(program: Program, parameters: str) -> tuple[Program, Program]:
    """The parameter-only part and the rest, which reads its results as the array `prepared`."""
    early = _parameter_only(program, parameters)
    needed = _frontier(program, early)
    array = Array(PREPARED, (max(1, len(needed)),), "SI", "constants that depend on parameters alone")
    source = tuple(a for a in program.inputs if a.name == parameters)
    first = Builder(source)
    moved: dict[int, int] = {}
    for i, instruction in enumerate(program.instructions):
        if early[i]:
            moved[i] = first.copy(instruction, [moved[j] for j in instruction.operands])
    results = tuple(moved[i] for i in needed) or (first.constant(0.0),)
    prepare = prune(first.program([Output(array, results)]))

    rest = Builder((array, *(a for a in program.inputs if a.name != parameters)))
    place = {value: index for index, value in enumerate(needed)}
    moved = {}
    for i, instruction in enumerate(program.instructions):
        if i in place:
            moved[i] = rest.input(PREPARED, place[i], instruction.name or f"c_{place[i] + 1}")
        elif not early[i] or instruction.op is Op.CONSTANT:
            moved[i] = rest.copy(instruction, [moved[j] for j in instruction.operands])
    return prepare, rest.program([output.renumbered(moved) for output in program.outputs])


def _parameter_only(program: Program, parameters: str) -> list[bool]:
    """Which instructions need nothing else; a sign change stays with its user, where it is free."""
    early: list[bool] = []
    for instruction in program.instructions:
        if instruction.op is Op.INPUT:
            early.append(instruction.array == parameters)
        else:
            early.append(instruction.op is not Op.NEGATE and all(early[j] for j in instruction.operands))
    return early


def _frontier(program: Program, early: Sequence[bool]) -> list[int]:
    """Parameter-only values that the rest or an output reads; numbers stay where they are."""
    read = {j for i, x in enumerate(program.instructions) if not early[i] for j in x.operands}
    read.update(program.results())
    return sorted(j for j in read if early[j] and program.instructions[j].op is not Op.CONSTANT)
