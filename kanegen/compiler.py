"""The compiler: from a tree of rigid bodies to C that computes its equations of motion, and its check.

TOML / URDF / arrays
    |  readers      text -> System
System
    |  accept       a system, outputs that it has, and a variant -> Request
    |  condition    the ways to derive them that lose no accuracy -> Candidates
    |  derive       Kane's equations by recursion, every intermediate named -> RecursiveForm
    |  lower        every definition becomes a few instructions; derivatives -> Program
    |  passes       Program -> Program, with operations counted
    |  split        a program for each function; values of parameters alone go into `prepare`
Module              the one with the fewest operations among the candidates
    |  c            Jinja templates print header, source and further files
Source
    |  build        a C compiler, behind a cache
Library             NumPy in, NumPy out
    |  check        against an independent NumPy reference
Report

Conditioning comes before derivation because iterative refinement of {ydot} is part of what is derived. Beside
this line stands the literal derivation, Eqs. (2)-(45) of the notes in SymPy as they are written, to read.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Unpack

from numpy.typing import ArrayLike

from kanegen import library as libraries
from kanegen import recursion, symbolic
from kanegen.artifacts import chosen, outputs_with, require_language, variant_with, with_artifacts
from kanegen.c import Source, description, render
from kanegen.c.c99 import C99_TARGET
from kanegen.c.render import target_named
from kanegen.c.target import Target
from kanegen.choices import flag
from kanegen.errors import OptionError, SingularError, quoted
from kanegen.library.equilibria import OUTPUTS as EQUILIBRIUM_OUTPUTS
from kanegen.library.equilibria import Equilibria, find_equilibria
from kanegen.library.linearization import LINEAR_OUTPUTS, outputs_needed
from kanegen.library.long_work import long_work
from kanegen.library.native.status import OnStatus
from kanegen.linear import LinearModel
from kanegen.linear.names import names_of
from kanegen.lowering.accept import accept, reformulated
from kanegen.lowering.compilation import Candidate, Compiled, Request
from kanegen.lowering.conditioning import condition
from kanegen.lowering.error_bound import error_bound
from kanegen.lowering.lower import lower
from kanegen.measure.bounds import Bounds, InputBox, bound_source, read_domain
from kanegen.measure.comparison import Report
from kanegen.measure.comparison import compare as compare_with_reference
from kanegen.measure.programs import Programs, measure_programs
from kanegen.measure.programs.program import USUAL_VARIANTS, of_library
from kanegen.model.arguments import NamedInputs
from kanegen.model.system import System
from kanegen.options import STRICT, Progress, Variant, chosen_variant, quiet
from kanegen.program import passes
from kanegen.program.garbage import paused_search
from kanegen.program.precision import precision_named
from kanegen.program.split import split
from kanegen.program.triangle import FULL, with_form
from kanegen.recursion.outputs import (
    EQUATIONS,
    ERROR_BOUNDS,
    OUTPUTS,
    function_signatures,
    method_of_program,
    require_available,
    together,
)
from kanegen.reference.range import require_range
from kanegen.reference.states import random_states


@paused_search()
def compile_module(
    system: System,
    outputs: Iterable[str] = EQUATIONS,
    progress: Progress = quiet,
    variant: Variant = STRICT,
    *,
    regular: bool = True,
    mass_matrix: str = FULL,
) -> Compiled:
    """Compile `outputs` to straight-line programs, by the candidate with the fewest operations.

    `regular` says whether to refuse outputs that solve with [A], if [A] is singular in every state, and
    `mass_matrix` in which form functions fill [A], one of `triangle.FORMS`.
    """
    request = accept(system, outputs, variant, regular=regular, mass_matrix=mass_matrix)
    candidates = [compile_candidate(request, candidate, progress) for candidate in condition(request)]
    return min(candidates, key=lambda compiled: compiled.cost)


def compile_candidate(request: Request, candidate: Candidate, progress: Progress = quiet) -> Compiled:
    """Compile the outputs of a request by one way of derivation."""
    system, outputs, without = request.system, request.outputs, request.variant.without
    constants = precision_named(request.variant.precision).constants
    progress("deriving")
    form = recursion.derive(system, candidate.methods, constants, candidate.refinement)
    progress("lowering")
    fixed = {name: error_bound(system, request.variant) for name in outputs if name in ERROR_BOUNDS}
    program = lower(form, [name for name in outputs if name not in fixed], constants)
    program = with_form(program, OUTPUTS["mass_matrix"].array(system).name, request.mass_matrix)
    progress("optimising")
    program, shared = passes.run(program, passes.all_but(without, passes.ON_ALL_OUTPUTS))
    signatures = function_signatures(system, outputs, together(system, request.integrators))
    module, own = split(program, signatures, passes.all_but(without, passes.ON_EACH_FUNCTION), fixed)
    module = replace(module, integrators=request.integrators)
    methods = {name: candidate.methods.get(name, method_of_program(name)) for name in outputs}
    return Compiled(module, methods, (*shared, *own), candidate.reason)


def derive(
    system: System, progress: Progress = quiet, speeds: str | None = None, coordinates: str | None = None
) -> symbolic.Equations:
    """Derive the equations of motion in SymPy, literally as in the notes.

    `progress` is called with the name of each stage. `speeds` and `coordinates` replace those of the system,
    as `System.with_speeds` and `System.with_coordinates` do.

    Raises:
        OptionError: If there are no such speeds or coordinates.
        ModelError: If numbers of the model leave the range of doubles.

    Example:
        equations = kg.derive(kg.load("models/double_pendulum.toml"))
        print(equations.A)
    """
    system = reformulated(system, speeds, coordinates)
    progress("deriving")
    require_range(system)
    return symbolic.derive(system)


@paused_search()
def generate(
    system: System,
    outputs: Iterable[str] | None = None,
    progress: Progress = quiet,
    without: Iterable[str] | None = None,
    precision: str | None = None,
    tier: Variant | str = STRICT,
    speeds: str | None = None,
    reanchoring: bool = False,
    coordinates: str | None = None,
    functions: Iterable[str] | None = None,
    artifacts: Iterable[str] | str = (),
    target: Target | str = C99_TARGET,
    parameters_by_state: bool = False,
    batches: bool = True,
    mass_matrix: str = FULL,
) -> Source:
    """Generate C for `outputs`, specialised to `system`.

    Args:
        system: The tree of bodies.
        outputs: Names among `recursion.outputs.OUTPUTS`; the code for several shares its intermediates. Also
            names among `recursion.outputs.INTEGRATORS`, such as "rollout_rk4", which add what they call. By
            default mass_matrix, forcing, and what `artifacts` call.
        progress: Function that is called with the name of each stage.
        without: Passes to leave out; see `options.chosen_variant`, as for `precision` and `tier`.
        precision: Arithmetic of the C, by default double, or what `artifacts` take.
        tier: Name of a tier, or a `Variant`: all other choices between speed and accuracy.
        speeds: Generalized speeds, as for `System.with_speeds`; by default those of the system.
        reanchoring: Whether to add `<model>_reanchor.h`, which does in C what `kanegen.reanchored` does.
        coordinates: Coordinates of orientations, as for `System.with_coordinates`.
        functions: Functions to print, by default all: one for each output, and "evaluate" for all together,
            which is the function of the output where there is only one.
        artifacts: Names of further files beside the source; `Source.artifacts` says which there can be.
        target: Language of the code, by default C99.
        parameters_by_state: Whether each state of a batch has its own run-time parameters: a row of the array
            `prepared`, which the batch form of `prepare` fills. By default all states have one set.
        batches: Whether to write functions for many states at once, too. Without them the code has the
            functions for one state alone, as on a microcontroller.
        mass_matrix: Form in which functions fill [A], whose numbers are the same in every form: "full";
            "lower", which leaves the elements above the diagonal of the n x n array as they are; "packed", an
            array of the n (n + 1)/2 elements of the lower triangle by rows, LAPACK's packed storage of the
            upper triangle by columns; or "sparse", the same without what is zero in every state. Macros
            `<MODEL>_A_ROW_STARTS` and `<MODEL>_A_COLUMNS` tell where elements of the last two belong.

    Raises:
        OptionError: If an output, a tier or another choice is unknown, an artifact cannot stand beside the
            code or calls outputs that it lacks, or the system has no run-time parameters, or no batches, in
            which they could differ from state to state.
        ModelError: If numbers of the model leave the range of doubles, or a constant that of the precision.
        SingularError: If an output solves with [A], as forward_dynamics does, and [A] is singular in every
            state; the message names the bodies, the freedoms and the outputs that remain.

    Example:
        kg.generate(kg.load("models/eight_body.toml"), precision="float").write("build/")
    """
    system = reformulated(system, speeds, coordinates)
    asked = (*chosen(artifacts), *(["reanchoring"] if flag("reanchoring", reanchoring) else []))
    variant = variant_with(
        asked, chosen_variant(tier, precision=precision, without=without), precision=precision
    )
    language = target_named(target)
    require_language(asked, language.name)
    needed = outputs_with(asked, system, outputs)
    compiled = compile_module(system, needed, progress, variant, mass_matrix=mass_matrix)
    progress("printing")
    decided = {"refinement": compiled.refinement}
    model = description(system)
    source = render(
        model,
        compiled.module,
        compiled.operations,
        variant,
        decided,
        language,
        functions,
        flag("parameters_by_state", parameters_by_state),
        flag("batches", batches),
    )
    return with_artifacts(replace(source, system=system), asked)


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
    speeds: str | None = None,
    coordinates: str | None = None,
    functions: Iterable[str] | None = None,
    on_status: OnStatus = "warn",
    parameters_by_state: bool = False,
    mass_matrix: str = FULL,
) -> libraries.Library:
    """Generate C as `generate` does, compile it and load it.

    `precision` is the arithmetic, "double", "float" or another; `tier` is "strict", "fast", "exact" or a
    `Variant` with all choices between speed and accuracy, such as `tier=kg.Variant(machine="portable")` for
    code that runs on older processors, too; by default it is made for the processor of this machine.
    `compiler` is the command of a C compiler, by default the first that is found; `flags` are its flags, by
    default optimised with IEEE semantics kept. With `threads`, OpenMP shares batches of 1024 states and more
    among threads; see `library.load`. `on_status` says what the library does where a result is missing, not
    finite or not accurate: "warn", "raise", "ignore" or a function; see `Library.with_on_status`. With
    `parameters_by_state`, the argument `parameters` of every method may have a row for each state of a batch.
    `mass_matrix` is the form of [A], as for `generate`; `Library.mass_matrix_places` says where the elements
    of a triangle belong.
    Without `progress`, a build of more than 5 s names its stages on a terminal, and nowhere else. In a log
    or a notebook, `progress=print` does.

    Raises:
        OptionError, ModelError, SingularError: As `generate`.
        BuildError: If there is no compiler, or it fails.

    Example:
        library = kg.build(kg.load("models/double_pendulum.toml"))
        A = library.mass_matrix([0.1, 0.2])
        shipped = kg.build(system, tier=kg.Variant(machine="multiversioned"), precision="float")
    """
    with long_work(str(getattr(system, "name", system)), progress) as stage:
        source = generate(
            system,
            outputs,
            stage,
            without,
            precision,
            tier,
            speeds,
            coordinates=coordinates,
            functions=functions,
            parameters_by_state=parameters_by_state,
            mass_matrix=mass_matrix,
        )
        stage("compiling")
        return libraries.load(source, compiler, flags, threads, on_status)


def linearize(
    system: System,
    x: ArrayLike | Mapping[str, float] | None = None,
    y: ArrayLike | Mapping[str, float] | None = None,
    tau: ArrayLike | Mapping[str, float] | None = None,
    *,
    inputs: Iterable[str] | str | None = None,
    outputs: Iterable[str] | str = (),
    **further: Unpack[NamedInputs],
) -> LinearModel:
    """Return the linear model of small deviations from one state, by compiled derivatives.

    It builds a library with the outputs that are needed and calls `Library.linearize`, which has the
    arguments. For symbols see `Equations.linearize`.

    Raises:
        ArrayError: If an argument has the wrong shape or type.
        OptionError: If a name does not exist, a value by name is no finite number, or the system has no
            points for an output of points.
        SingularError: If [A] is singular in the state.
        BuildError: As `build`.

    Example:
        model = kg.linearize(kg.load("models/cart_pole.toml"), {"pole": 0.0}, inputs=["cart_position"])
        print(model)
    """
    asked = names_of("outputs", outputs)
    require_available(system, [name for name in asked if name in LINEAR_OUTPUTS])
    library = build(system, outputs_needed(system.speeds_are_rates, asked))
    return library.linearize(x, y, tau, inputs=inputs, outputs=asked, **further)


def equilibria(
    system: System,
    speeds: Mapping[str, float] | None = None,
    tau: Mapping[str, float] | None = None,
    *,
    starts: int = 200,
    seed: int = 0,
    **further: Unpack[NamedInputs],
) -> Equilibria:
    """Search for states of rest, or for steady motions with given constant speeds.

    Zeros of {f} + {tau} are found from the neutral position and from random states at once, by the
    derivatives in C. The search is not proven to find all. Of a continuous family, such as the places of a
    cart that slides freely, it returns one state and names the free direction.

    Args:
        system: The tree.
        speeds: Constant speeds by name of the coordinate that turns or moves (rad/s, m/s), such as
            `{"spin": 100.0}`; all others are 0. Forces must not depend on these coordinates.
        tau: Constant generalized forces by name of the freedom (N m, N).
        starts: Number of random states from which the search begins.
        seed: Seed of these states.
        further: Inputs that only some systems have, held at these values, by default 0.

    Raises:
        OptionError: If a name does not exist, a value is no finite number, or a motion with these speeds is
            not steady.
        SingularError: If [A] is singular in every state.
        BuildError: As `build`.

    Example:
        for one in kg.equilibria(kg.load("models/double_pendulum.toml")):
            print(one)
    """
    if isinstance(starts, bool) or not isinstance(starts, int) or starts < 1:
        raise OptionError(f"starts: {quoted(starts)} is no positive number of states.")
    library = build(system, EQUILIBRIUM_OUTPUTS, on_status="ignore")
    sample = random_states(system, starts, seed).x
    return find_equilibria(library, sample, speeds, tau, elements=system.named_force_elements, **further)


def compare(
    system: System,
    states: int = 1000,
    seed: int = 0,
    progress: Progress = quiet,
    precision: str | None = None,
    tier: Variant | str = STRICT,
    speeds: str | None = None,
    coordinates: str | None = None,
) -> Report:
    """Compare the C that `generate` makes for `system`, compiled, with the NumPy reference.

    `states` is the number of random states and `seed` their seed. The reference computes in double precision.

    Example:
        assert kg.compare(kg.load("models/eight_body.toml"), states=100).passed
    """
    system = reformulated(system, speeds, coordinates)
    variant = chosen_variant(tier, precision=precision)
    library = build(system, progress=progress, tier=variant, on_status="ignore")
    progress("comparing")
    arithmetic, storage = precision_named(library.precision), precision_named(library.storage)
    report = compare_with_reference(system, library, states, seed, arithmetic, storage)
    return replace(report, measure=partial(_programs, system, variant))


def _programs(system: System, variant: Variant, states: int, seed: int, progress: Progress) -> Programs:
    """Measure the symbolic and compiled programs of a system in the same states; see `Report.programs`."""
    variants = dict(USUAL_VARIANTS)
    if variant not in variants.values():
        variants["C as checked"] = variant
    compiled = []
    for name, tier in variants.items():
        try:
            outputs = (*EQUATIONS, "forward_dynamics")
            library = build(system, outputs, tier=tier, progress=progress, on_status="ignore")
        except SingularError:
            library = build(system, tier=tier, progress=progress, on_status="ignore")
        compiled.append(of_library(name, library, precision_named(library.storage)))
    return measure_programs(system, compiled, states, seed, progress)


def bound(
    source: Source | libraries.Library, domain: InputBox | Mapping[str, Any] | str | Path | None = None
) -> Bounds:
    """Return proven bounds of the errors of generated code, for all states of a box.

    The bounds hold for every entry of every output, in every function that fills it. The precision, the
    sines and the order of operations are those of the code.

    Args:
        source: Generated code, or a library that was compiled from it.
        domain: Ranges of all inputs: a table such as `{"x": {"angles": [-1.0, 1.0]}}`, the path of a .toml
            file or the content of one; see `measure.bounds.domain`. None is the box of random states. A
            run-time parameter without a range has the value of the library, or the model's default.

    Raises:
        OptionError: If `source` is neither, the domain is none of this system, or there are no bounds for
            the variant, as for relaxed semantics and for double-double.
        ModelError: If no model has the values of the library's parameters, such as a negative mass.
        ReadError: If the file does not exist, or is not valid TOML.

    Example:
        library = kg.build(kg.load("models/double_pendulum.toml"), precision="float")
        print(kg.bound(library, {"x": {"angles": [-1.0, 1.0]}, "y": {"angles": [-2.0, 2.0]}}))
    """
    code = source.source if isinstance(source, libraries.Library) else source
    if isinstance(code, System):
        raise OptionError(f"bound: system {code.name!r} is no code yet. Give kg.build(system), for example.")
    if not isinstance(code, Source):
        raise OptionError(
            f"bound: {quoted(source)} is not generated code. Give what kg.build or kg.generate returns."
        )
    if code.system is None:
        raise OptionError("bound: this source does not carry its system. Generate it anew with kg.generate.")
    system = code.system
    if isinstance(source, libraries.Library) and source.parameters:
        system = system.with_parameters(source.parameters)
    return bound_source(code, read_domain(domain, system))
