"""Split one program for all outputs into the functions of a C file.

Values that depend on parameters alone are computed by the function `prepare`, which runs once for a set of
parameters; the other functions read its results from the array `PREPARED`.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

from kanegen.program.arrange import arrange
from kanegen.program.builder import Builder
from kanegen.program.check import check
from kanegen.program.ir import EVALUATE, PARAMETERS, PREPARED, Array, Instruction, Module, Op, Output, Program
from kanegen.program.passes import Pass, Stage, run
from kanegen.program.passes.prune import prune
from kanegen.program.selection import parameter_only


class Signature(NamedTuple):
    """The arrays of a function.

    Attributes:
        inputs: Names of the arrays that it reads.
        outputs: Names of the arrays that it fills.
    """

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


def restrict(program: Program, functions: Mapping[str, Signature]) -> dict[str, Program]:
    """Return a program for every function, with the instructions that it needs and no others.

    Args:
        program: The program of all outputs.
        functions: Signatures by name of function; run-time parameters are read by all.
    """
    return {name: _restrict_to(program, signature) for name, signature in functions.items()}


def split(
    program: Program,
    functions: Mapping[str, Signature],
    own: Sequence[Pass],
    fixed: Mapping[str, Program] = MappingProxyType({}),
) -> tuple[Module, tuple[Stage, ...]]:
    """Split the program of all outputs into the functions of a module, each improved by passes of its own.

    Args:
        program: The program of all outputs.
        functions: Signatures by name of function; the function of all outputs comes last.
        own: Passes that run on every function by itself.
        fixed: Programs of further functions, by name, whose instructions must stay as they are, because they
            bound the rounding of just these instructions.

    Returns:
        The module, and the operation counts of the last function after each of its passes.
    """
    alone = restrict(program, {name: one for name, one in functions.items() if name not in fixed})
    finished = {name: run(one, own) for name, one in alone.items()}
    stages = [stages for _, stages in finished.values()] or [(Stage("lower", {}),)]
    programs = {name: one for name, (one, _) in finished.items()}
    for name, one in fixed.items():
        programs[name] = _restrict_to(one, functions[name])
    if fixed and EVALUATE in functions:
        together = [programs.pop(EVALUATE), *(programs[name] for name in fixed)]
        programs[EVALUATE] = joined(together, *functions[EVALUATE])
    module = hoist({name: programs[name] for name in functions})
    if module.prepare and not fixed:
        module = replace(module, prepare=run(module.prepare, own)[0])
    return module, stages[-1][1:]


def joined(programs: Sequence[Program], inputs: Sequence[str], wanted: Sequence[str]) -> Program:
    """Return the program of all outputs of several programs, whose instructions stay as they are.

    Args:
        programs: The programs. Of several that give one name to a value, only the first keeps it.
        inputs: Names of the arrays that they read beside parameters, in the order of the result.
        wanted: Names of the arrays that they fill, in the order of the result.
    """
    arrays = {array.name: array for program in programs for array in program.inputs}
    builder = Builder([arrays[name] for name in dict.fromkeys((PARAMETERS, *inputs)) if name in arrays])
    outputs: dict[str, Output] = {}
    taken: set[str] = set()
    for program in programs:
        moved: list[int] = []
        for x in program.instructions:
            bare = x.named("") if x.name in taken else x
            moved.append(builder.copy(bare, [moved[j] for j in x.operands]))
            taken.add(x.name)
        outputs |= {output.array.name: output.renumbered(moved) for output in program.outputs}
    return check(builder.program([outputs[name] for name in wanted]))


def _restrict_to(program: Program, signature: Signature) -> Program:
    inputs = tuple(array for array in program.inputs if array.name in (PARAMETERS, *signature.inputs))
    outputs = tuple(output for output in program.outputs if output.array.name in signature.outputs)
    return prune(replace(program, inputs=inputs, outputs=outputs))


def hoist(programs: Mapping[str, Program]) -> Module:
    """Return the functions of a module, with the function `prepare` where they read parameters.

    Values that depend on parameters alone are computed once, and all functions read them from the array
    `PREPARED`.

    Args:
        programs: Programs by name of function; all read parameters, or none does.
    """
    sources = {array for program in programs.values() for array in program.inputs if array.name == PARAMETERS}
    if not sources:
        return Module(None, {name: check(arrange(program)) for name, program in programs.items()})
    early = {name: parameter_only(program) for name, program in programs.items()}
    first, places = _collect_parameter_only(programs, early, tuple(sources))
    frontiers = {name: _frontier(program, early[name]) for name, program in programs.items()}
    needed = sorted({places[name][i] for name, frontier in frontiers.items() for i in frontier})
    array = Array(PREPARED, (max(1, len(needed)),), "SI", "constants that depend on parameters alone")
    prepare = prune(first.program([Output(array, tuple(needed) or (first.constant(0.0),))]))
    order = {value: place for place, value in enumerate(needed)}
    functions = {}
    for name, program in programs.items():
        read = {i: order[places[name][i]] for i in frontiers[name]}
        functions[name] = check(arrange(_with_prepared(program, early[name], read, array)))
    return Module(prepare, functions)


def select_functions(module: Module, names: Collection[str]) -> Module:
    """Return the module of the functions `names`, with a `prepare` that computes no more than these read.

    Args:
        module: The functions of a C file.
        names: Names among `module.functions` and `module.integrators`.
    """
    functions = {name: program for name, program in module.functions.items() if name in names}
    module = replace(module, integrators=tuple(name for name in module.integrators if name in names))
    if module.prepare is None or len(functions) == len(module.functions):
        return replace(module, functions=functions)
    read = {
        instruction.index
        for program in functions.values()
        for instruction in program.instructions
        if instruction.array == PREPARED
    }
    (output,) = module.prepare.outputs
    kept = sorted(read) or [0]
    places = {old: new for new, old in enumerate(kept)}
    array = replace(output.array, shape=(len(kept),))
    values = tuple(output.values[place] for place in kept)
    prepare = prune(replace(module.prepare, outputs=(Output(array, values),)))
    functions = {name: _reads(program, array, places) for name, program in functions.items()}
    return replace(module, prepare=prepare, functions=functions)


def _reads(program: Program, array: Array, places: Mapping[int, int]) -> Program:
    """Return a function that reads its prepared constants at other places of the array.

    Args:
        program: The function.
        array: The array of prepared constants.
        places: New places by old place.
    """
    inputs = tuple(array if old.name == PREPARED else old for old in program.inputs)
    instructions = tuple(
        x._replace(index=places[x.index]) if x.array == PREPARED else x for x in program.instructions
    )
    return check(replace(program, inputs=inputs, instructions=instructions))


def _collect_parameter_only(
    programs: Mapping[str, Program], early: Mapping[str, Sequence[bool]], source: tuple[Array, ...]
) -> tuple[Builder, dict[str, dict[int, int]]]:
    """Collect all instructions that depend on parameters alone, each value once.

    Args:
        programs: Programs by name of function.
        early: For each of them, which instructions depend on parameters alone.
        source: The array of parameters.

    Returns:
        The builder of `prepare`, and by function and instruction the value of that builder.
    """
    first = Builder(source)
    known: dict[Instruction, int] = {}
    places: dict[str, dict[int, int]] = {}
    for name in sorted(programs, key=lambda name: name != EVALUATE):  # first the one with all names
        moved = places[name] = {}
        for i, instruction in enumerate(programs[name].instructions):
            if early[name][i]:
                operands = tuple(moved[j] for j in instruction.operands)
                bare = instruction.with_operands(operands).named("")
                if bare not in known:
                    made = instruction if instruction.op is Op.INPUT else bare
                    known[bare] = first.name(first.copy(made, operands), instruction.name, instruction.note)
                moved[i] = known[bare]
    return first, places


def _with_prepared(program: Program, early: Sequence[bool], read: Mapping[int, int], array: Array) -> Program:
    """Return a function that reads prepared constants instead of computing them.

    Each is read where it is first used, as near as a number in the code.

    Args:
        program: The function.
        early: Which of its instructions depend on parameters alone.
        read: Place in `array` of each instruction of the frontier.
        array: The array that `prepare` fills.
    """
    rest = Builder((array, *(a for a in program.inputs if a.name != PARAMETERS)))
    moved: dict[int, int] = {}
    prepared: dict[int, int] = {}

    def value(i: int) -> int:
        """Return value i of the program in the function."""
        if i not in read:
            return moved[i]
        place = read[i]
        if place not in prepared:
            name = program.instructions[i].name or f"c_{place + 1}"
            prepared[place] = rest.input(PREPARED, place, name)
        return prepared[place]

    for i, instruction in enumerate(program.instructions):
        if not early[i] or instruction.op is Op.CONSTANT:
            moved[i] = rest.copy(instruction, [value(j) for j in instruction.operands])
    every = {i: value(i) for i in program.results()}
    return rest.program([output.renumbered(every) for output in program.outputs])


def _frontier(program: Program, early: Sequence[bool]) -> list[int]:
    """Return the parameter-only values, numbers excepted, that other instructions or outputs read."""
    read = {j for i, x in enumerate(program.instructions) if not early[i] for j in x.operands}
    read.update(program.results())
    return sorted(j for j in read if early[j] and program.instructions[j].op is not Op.CONSTANT)
