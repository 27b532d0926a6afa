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
from kanegen.program.ir import EVALUATE, Array, Instruction, Module, Op, Output, Program
from kanegen.program.passes.prune import prune
from kanegen.program.selection import PARAMETERS, parameter_only

PREPARED = "prepared"
"""The array of what depends on them alone."""


class Signature(NamedTuple):
    """Names of the arrays that a function reads and fills."""

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


def restricted(program: Program, functions: Mapping[str, Signature]) -> dict[str, Program]:
    """One program for every function: what it needs, and nothing else.

    Args:
        program: All outputs together.
        functions: What every function reads and fills; run-time parameters are read by all.
    """
    return {name: _restrict(program, signature) for name, signature in functions.items()}


def _restrict(program: Program, signature: Signature) -> Program:
    inputs = tuple(array for array in program.inputs if array.name in (PARAMETERS, *signature.inputs))
    outputs = tuple(output for output in program.outputs if output.array.name in signature.outputs)
    return prune(replace(program, inputs=inputs, outputs=outputs))


def hoisted(programs: Mapping[str, Program]) -> Module:
    """The functions of a module, and `prepare` where they read parameters.

    What several functions need of the parameters alone is computed once, and all read it as the one array
    `prepared`.

    Args:
        programs: By name of function; all read parameters, or none does.
    """
    sources = {array for program in programs.values() for array in program.inputs if array.name == PARAMETERS}
    if not sources:
        return Module(None, {name: check(arrange(program)) for name, program in programs.items()})
    early = {name: parameter_only(program) for name, program in programs.items()}
    first, places = _collected(programs, early, tuple(sources))
    frontiers = {name: _frontier(program, early[name]) for name, program in programs.items()}
    needed = sorted({places[name][i] for name, frontier in frontiers.items() for i in frontier})
    array = Array(PREPARED, (max(1, len(needed)),), "SI", "constants that depend on parameters alone")
    prepare = prune(first.program([Output(array, tuple(needed) or (first.constant(0.0),))]))
    order = {value: place for place, value in enumerate(needed)}
    functions = {}
    for name, program in programs.items():
        read = {i: order[places[name][i]] for i in frontiers[name]}
        functions[name] = check(arrange(_rest(program, early[name], read, array)))
    return Module(prepare, functions)


def _collected(
    programs: Mapping[str, Program], early: Mapping[str, Sequence[bool]], source: tuple[Array, ...]
) -> tuple[Builder, dict[str, dict[int, int]]]:
    """What needs nothing but parameters, each value once; by function and instruction where it stands."""
    first = Builder(source)
    known: dict[Instruction, int] = {}
    places: dict[str, dict[int, int]] = {}
    for name in sorted(programs, key=lambda name: name != EVALUATE):  # which has the names of everything
        moved = places[name] = {}
        for i, instruction in enumerate(programs[name].instructions):
            if early[name][i]:
                operands = tuple(moved[j] for j in instruction.operands)
                bare = replace(instruction, operands=operands, name="", note="")
                if bare not in known:
                    made = instruction if instruction.op is Op.INPUT else bare
                    known[bare] = first.name(first.copy(made, operands), instruction.name, instruction.note)
                moved[i] = known[bare]
    return first, places


def _rest(program: Program, early: Sequence[bool], read: Mapping[int, int], array: Array) -> Program:
    """A function that reads `array` where it would compute what needs nothing but parameters.

    Args:
        program: The function.
        early: Which of its instructions that are.
        read: Places in `array`, by those that the others need.
        array: What `prepare` fills.
    """
    rest = Builder((array, *(a for a in program.inputs if a.name != PARAMETERS)))
    moved: dict[int, int] = {}
    prepared: dict[int, int] = {}
    for i, instruction in enumerate(program.instructions):
        if i in read:
            place = read[i]
            if place not in prepared:
                prepared[place] = rest.input(PREPARED, place, instruction.name or f"c_{place + 1}")
            moved[i] = prepared[place]
        elif not early[i] or instruction.op is Op.CONSTANT:
            moved[i] = rest.copy(instruction, [moved[j] for j in instruction.operands])
    return rest.program([output.renumbered(moved) for output in program.outputs])


def _frontier(program: Program, early: Sequence[bool]) -> list[int]:
    """Parameter-only values that the rest or an output reads; numbers stay where they are."""
    read = {j for i, x in enumerate(program.instructions) if not early[i] for j in x.operands}
    read.update(program.results())
    return sorted(j for j in read if early[j] and program.instructions[j].op is not Op.CONSTANT)
