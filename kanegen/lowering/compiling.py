"""The middle of the pipeline: from a system to the programs of its functions, by the cheapest methods."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from kanegen.lowering.conditioning import Decision, decisions
from kanegen.lowering.differentiate import differentiated
from kanegen.lowering.lower import lower
from kanegen.lowering.request import require_system, require_usable
from kanegen.model.system import System
from kanegen.options import STRICT, Progress, Variant, quiet
from kanegen.program import passes
from kanegen.program import precision as precisions
from kanegen.program.constants import Constants
from kanegen.program.count import operations
from kanegen.program.ir import Module, Program
from kanegen.program.split import hoist, restrict
from kanegen.recursion import Methods, RecursiveForm, methods, recursive_form
from kanegen.recursion.outputs import (
    EQUATIONS,
    Derivative,
    chosen,
    functions,
    input_arrays,
    output_array,
    prerequisites,
    require_available,
)


@dataclass(frozen=True)
class Compiled:
    """The functions of a system, ready to be written as C, and how they came to cost what they cost."""

    module: Module
    methods: Methods
    stages: tuple[passes.Stage, ...]
    refinement: str

    @property
    def operations(self) -> dict[str, int]:
        """Operations of one evaluation of all outputs together."""
        return operations(self.module)


def compile_module(
    system: System,
    outputs: Iterable[str] = EQUATIONS,
    progress: Progress = quiet,
    variant: Variant = STRICT,
    *,
    regular: bool = True,
) -> Compiled:
    """Straight-line programs for `outputs`, every intermediate shared, by the cheapest methods.

    Args:
        system: The tree.
        outputs: Names among `OUTPUTS`.
        progress: Told the name of each stage.
        variant: The other choices.
        regular: Whether [A] must not be singular in every state.

    Raises:
        OptionError: If an output is unknown.
        SingularError: If [A] is singular in every state and must not be.
    """
    names = chosen(outputs)
    require_system(system)
    if regular:
        require_usable(system)
    require_available(system, names)
    constants = precisions.precision_named(variant.precision).constants
    choices = decisions(system, methods(system, prerequisites(names), variant.solver), variant)
    ways = [_compiled(system, names, choice, variant.without, progress, constants) for choice in choices]
    return min(ways, key=lambda compiled: sum(compiled.operations.values()) - compiled.operations["prepare"])


def _compiled(
    system: System,
    names: Sequence[str],
    choice: Decision,
    without: Sequence[str],
    progress: Progress,
    constants: Constants,
) -> Compiled:
    """The programs of one way to derive the outputs."""
    progress("deriving")
    form = recursive_form(system, choice.methods, constants, choice.refinement)
    progress("lowering")
    program = _lowered(system, names, form, constants)
    progress("optimising")
    program, together = passes.run(program, passes.all_but(without, passes.ON_ALL_OUTPUTS))
    programs = restrict(program, functions(system, names))
    module, apart = _module(programs, passes.all_but(without, passes.ON_EACH_FUNCTION))
    taken = {name: choice.methods.get(name, Derivative.method) for name in names}
    return Compiled(module, taken, (*together, *apart), choice.words)


def _lowered(system: System, names: Sequence[str], form: RecursiveForm, constants: Constants) -> Program:
    """One program for all outputs, derivatives among them."""
    arrays = {output_array(system, name, form.methods): values for name, values in form.outputs.items()}
    program = lower(input_arrays(system), form.definitions, arrays, constants)
    lowered = dict(zip(form.outputs, program.outputs, strict=True))
    return differentiated(program, system, lowered, names, constants)


def _module(
    programs: Mapping[str, Program], own: Sequence[passes.Pass]
) -> tuple[Module, tuple[passes.Stage, ...]]:
    """The functions, each after passes of its own, and what these did to that of all outputs together."""
    finished = {name: passes.run(alone, own) for name, alone in programs.items()}
    *_, (_, (_, *stages)) = finished.values()  # of all outputs together, which come last
    module = hoist({name: alone for name, (alone, _) in finished.items()})
    if module.prepare:
        module = replace(module, prepare=passes.run(module.prepare, own)[0])
    return module, tuple(stages)
