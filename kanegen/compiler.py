"""The pipeline.

TOML / URDF / arrays
    |  readers      text -> System
System
    |  symbolic     Eqs. (2)-(45) of the notes in SymPy, literally -> Equations, to read
    |  recursion    the same values by recursion, every intermediate named -> RecursiveForm
    |  lowering     every definition becomes a few instructions
Program
    |  passes       Program -> Program, counted
    |  split        the parameter-only part goes into `prepare`; long functions are arranged by rows
Module
    |  c            long functions are cut; Jinja templates write header, source and what goes with them
Source
    |  build        a C compiler, behind a cache
Library             NumPy in, NumPy out
    |  check        against an independent NumPy reference
Report
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from kanegen import library as libraries
from kanegen import precision as precisions
from kanegen import symbolic
from kanegen import variant as variants
from kanegen.c import ModelFacts, Source, render
from kanegen.check import regularity
from kanegen.check.compare import Report
from kanegen.check.compare import compare as compare_with_reference
from kanegen.errors import OptionError
from kanegen.lowering import lower
from kanegen.program import passes
from kanegen.program.count import operations
from kanegen.program.ir import Module
from kanegen.program.split import split
from kanegen.recursion import Methods, methods, recursive_form
from kanegen.recursion.legend import LEGEND
from kanegen.signature import EQUATIONS, PARAMETERS, chosen, functions, input_arrays, output_array
from kanegen.system import System
from kanegen.variant import STRICT, Variant

Progress = Callable[[str], None]
"""Told the name of each stage as it begins."""


def quiet(stage: str) -> None:
    """Progress that nobody watches."""


@dataclass(frozen=True)
class Compiled:
    """The functions of a system, ready to be written as C, and how they came to cost what they cost."""

    module: Module
    methods: Methods
    stages: tuple[passes.Stage, ...]

    @property
    def operations(self) -> dict[str, int]:
        """Operations of one evaluation of all outputs together."""
        return operations(self.module)


def derive(system: System, progress: Progress = quiet) -> symbolic.Equations:
    """The equations of motion in SymPy, literally as the notes derive them.

    Raises:
        SingularError: If [A] is singular in every state.
    """
    progress("deriving")
    _require_usable(system)
    return symbolic.derive(system)


def compile_module(
    system: System,
    outputs: Iterable[str] = EQUATIONS,
    progress: Progress = quiet,
    variant: Variant = STRICT,
) -> Compiled:
    """Straight-line programs for `outputs`, every intermediate shared, by the cheapest methods.

    Raises:
        OptionError: If an output is unknown.
        SingularError: If [A] is singular in every state.
    """
    names, kept = chosen(outputs), passes.all_but(variant.without)
    _require_usable(system)
    ways = [_compiled(system, way, kept, progress) for way in methods(system, names, variant.solver)]
    return min(ways, key=lambda compiled: sum(compiled.operations.values()) - compiled.operations["prepare"])


def _require_usable(system: System) -> None:
    if not isinstance(system, System):
        raise OptionError(f"{system!r} is no System. Make one with kg.load or kg.System.from_arrays.")
    regularity.require_regular(system)


def _compiled(system: System, way: Methods, kept: Sequence[passes.Pass], progress: Progress) -> Compiled:
    """The programs of one way to derive the outputs."""
    progress("deriving")
    form = recursive_form(system, way)
    progress("lowering")
    arrays = {output_array(system, name, form.methods): form.outputs[name] for name in way}
    program = lower(input_arrays(system), form.definitions, arrays)
    progress("optimising")
    program, stages = passes.run(program, kept)
    return Compiled(split(program, functions(system, tuple(way)), PARAMETERS), way, stages)


def generate(
    system: System,
    outputs: Iterable[str] = EQUATIONS,
    progress: Progress = quiet,
    without: Iterable[str] | None = None,
    precision: str | None = None,
    tier: Variant | str = STRICT,
) -> Source:
    """C for `outputs`, specialised to `system`.

    Args:
        system: The tree.
        outputs: Names among `OUTPUTS`; the code for several shares its intermediates.
        progress: Told the name of each stage.
        without: Passes to leave out, among "fold", "prune" and "factor": the C computes the same by more
            operations.
        precision: Type of all numbers in C, "double" or "float". For float, too, constants are computed in
            double; they are rounded once.
        tier: The other choices: a name of `variant.TIERS`, or a `Variant` of one's own, where `without` and
            `precision` stand as well.

    Raises:
        OptionError: If an output, a tier or a choice is unknown.
        ModelError: If a constant leaves the range of the precision.
        SingularError: If [A] is singular in every state; names the body and the freedom.
    """
    variant = variants.chosen(tier, precision=precision, without=without)
    compiled = compile_module(system, outputs, progress, variant)
    progress("printing")
    return render(facts(system), compiled.module, compiled.operations, variant)


def build(
    system: System,
    outputs: Iterable[str] = EQUATIONS,
    compiler: str | None = None,
    flags: str | Sequence[str] | None = None,
    progress: Progress = quiet,
    threads: bool = False,
    without: Iterable[str] | None = None,
    precision: str | None = None,
    tier: Variant | str = STRICT,
) -> libraries.Library:
    """Generate, compile and load.

    Args:
        system: The tree.
        outputs: Names among `OUTPUTS`.
        compiler: Command of a C compiler; by default the first that is found.
        flags: Its flags; by default optimised with IEEE semantics kept.
        progress: Told the name of each stage.
        threads: Let OpenMP share batches of 1024 states and more among threads; see `library.load`.
        without: Passes to leave out, as in `generate`.
        precision: As in `generate`.
        tier: As in `generate`.

    Raises:
        OptionError, ModelError, SingularError: As `generate`.
        BuildError: If there is no compiler, or it fails.
    """
    source = generate(system, outputs, progress, without, precision, tier)
    progress("compiling")
    return libraries.load(source, compiler, flags, threads)


def compare(
    system: System,
    states: int = 1000,
    seed: int = 0,
    progress: Progress = quiet,
    precision: str | None = None,
    tier: Variant | str = STRICT,
) -> Report:
    """The compiled C of `system` against the NumPy reference over random states.

    Args:
        system: The tree.
        states: How many.
        seed: Of the random states.
        progress: Told the name of each stage.
        precision: As in `generate`; the reference computes in double.
        tier: As in `generate`.
    """
    built = build(system, progress=progress, precision=precision, tier=tier)
    progress("comparing")
    return compare_with_reference(system, built, states, seed, precisions.named(built.precision))


def facts(system: System) -> ModelFacts:
    """What the C says about the model beside its programs."""
    return ModelFacts(
        name=system.name,
        freedom_names=system.freedom_names,
        freedom_units=tuple(freedom.unit for freedom in system.freedoms),
        body_names=tuple(body.name for body in system.bodies),
        loaded=tuple(body.loads for body in system.bodies),
        parameters=tuple((parameter.name, parameter.value) for parameter in system.parameters),
        legend=LEGEND,
    )
