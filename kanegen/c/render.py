"""Rendering: the programs of a module become the code of a target."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from kanegen.c.c99 import C99_TARGET
from kanegen.c.cuda import CUDA_TARGET
from kanegen.c.description import ModelDescription
from kanegen.c.formats import require_range
from kanegen.c.provenance import with_provenance
from kanegen.c.source import Source
from kanegen.c.steps import arrays_of_rates
from kanegen.c.target import RenderInput, Target
from kanegen.choices import require_one, several
from kanegen.errors import OptionError, quoted
from kanegen.options import NO_DECISIONS, STRICT, Variant
from kanegen.program import count
from kanegen.program.expand import expanded_module, has_loops
from kanegen.program.ir import EVALUATE, Module
from kanegen.program.split import select_functions
from kanegen.recursion.outputs import INTEGRATORS, differentiates

TARGETS: dict[str, Target] = {target.name: target for target in (C99_TARGET, CUDA_TARGET)}
"""The targets that users can name."""


def render(
    model: ModelDescription,
    module: Module,
    operations: Mapping[str, int],
    variant: Variant = STRICT,
    decided: Mapping[str, str] = NO_DECISIONS,
    target: Target | str = C99_TARGET,
    functions: Iterable[str] | None = None,
    parameters_by_state: bool = False,
    batches: bool = True,
) -> Source:
    """Return the code for the programs of `module`, without artifacts beside it.

    Args:
        model: Names and sizes that the code and its documentation mention.
        module: The programs.
        operations: Operation counts of all functions, for the documentation and `Source.operations`; those of
            chosen functions are counted anew.
        variant: The choices that shape the code; the programs follow theirs already.
        decided: Values and reasons of choices that were left to kanegen, as text by name of the choice.
        target: The language, a name of `TARGETS` or another target.
        functions: Names of the functions to print, by default all; `prepare` is always printed. "evaluate" is
            the function of all outputs together, also where there is only one output.
        parameters_by_state: Whether each state of a batch has its own parameters.
        batches: Whether to print functions for many states at once, too.

    Raises:
        ModelError: If the target cannot use the name of the model, or the precision cannot hold a number.
        OptionError: If there is no such target or function, there are no parameters to differ by state, or no
            batches in which they could.
    """
    if parameters_by_state and not batches:
        raise OptionError("parameters_by_state: there are no batches. Leave out one or the other choice.")
    if parameters_by_state and module.prepare is None:
        raise OptionError(
            f"parameters_by_state: system {quoted(model.shown)} has no run-time parameters. Leave it out, or "
            "give numbers of the model names in [parameters]."
        )
    target = target_named(target)
    target.require_name(model.name)
    if not target.has_loops and has_loops(module):
        module = expanded_module(module)
        operations = count.operations(module)
    chosen = _chosen(functions, module, model.speeds_are_rates)
    if chosen is not None:
        operations = count.operations(select_functions(module, chosen))
    longest = target.longest_part
    render_input = RenderInput(
        model, module, operations, variant, dict(decided), longest, chosen, parameters_by_state, batches
    )
    require_range(model, render_input.programs, render_input.formats)
    return printed(render_input, target)


def printed(render_input: RenderInput, target: Target) -> Source:
    """Return the code that a target prints, without artifacts beside it.

    Args:
        render_input: The programs and the choices for the code; `replace(source.render_input, batches=False)`
            are those of a source for one state alone.
        target: The language.

    Example:
        printed(replace(source.render_input, batches=False), target_named(source.target))
    """
    made = target.printed(render_input)
    return Source(
        model=render_input.model,
        outputs=render_input.outputs,
        functions=render_input.functions,
        operations=dict(render_input.operations),
        files={name: with_provenance(name, text) for name, text in made.files.items()},
        cdef=made.declarations,
        code_files=tuple(made.files),
        variant=render_input.variant,
        target=target.name,
        render_input=render_input,
        rollouts=render_input.rollouts,
        integrators=tuple(render_input.steps),
        footprints=made.footprints,
        pieces=made.pieces,
    )


def _chosen(
    functions: Iterable[str] | None, module: Module, speeds_are_rates: bool
) -> tuple[str, ...] | None:
    """Return the names of functions, checked, in the order of the module; None for all.

    `EVALUATE` is the function of all outputs together, also where there is only one output. Functions that
    follow a motion bring the one that computes its rates.
    """
    if functions is None:
        return None
    known = (*module.functions, *module.integrators)
    together = EVALUATE if EVALUATE in known else known[0]
    chosen = several("functions", "function", functions, dict.fromkeys((*known, EVALUATE)))
    if not chosen:
        raise OptionError(f"functions: name one at least. There are {', '.join(known)}.")
    needed = {together if name == EVALUATE else name for name in chosen}
    for name in needed.intersection(module.integrators):
        needed.update(() if differentiates(name) else INTEGRATORS[name].called)
        arrays = arrays_of_rates(name, speeds_are_rates)
        programs = module.functions.items()
        needed.add(
            next(one for one, program in programs if arrays == {o.array.name for o in program.outputs})
        )
    return tuple(name for name in known if name in needed)


def target_named(target: Target | str) -> Target:
    """Return a target from itself or from its name.

    Raises:
        OptionError: If there is no target of that name, or `target` is neither a target nor a name.
    """
    if isinstance(target, Target):
        return target
    require_one("target", target, TARGETS)
    return TARGETS[target]
