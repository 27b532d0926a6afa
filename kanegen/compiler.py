"""The pipeline.

TOML / URDF / arrays
    |  readers      text -> System
System
    |  symbolic     Eqs. (2)-(45) of the notes in SymPy, literally -> Equations, to read
    |  recursion    the same values by recursion, every intermediate named -> RecursiveForm
    |  lowering     every definition becomes a few instructions
Program
    |  passes       Program -> Program, counted
    |  split        a program for each function; the parameter-only part goes into `prepare`; long functions
    |               are arranged by rows
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
from dataclasses import dataclass, replace

from kanegen import derivatives, symbolic
from kanegen import library as libraries
from kanegen import precision as precisions
from kanegen import variant as variants
from kanegen.anchors import anchors
from kanegen.c import ModelFacts, Source, render
from kanegen.c.anchors import with_anchors
from kanegen.check import regularity
from kanegen.check.compare import Report
from kanegen.check.compare import compare as compare_with_reference
from kanegen.constants import Constants
from kanegen.derivatives import with_needs
from kanegen.differentiating import differentiated
from kanegen.errors import OptionError
from kanegen.lowering import lower
from kanegen.program import passes
from kanegen.program.count import operations
from kanegen.program.ir import Module
from kanegen.program.split import hoisted, restricted
from kanegen.recursion import Methods, methods, recursive_form
from kanegen.recursion.legend import legend
from kanegen.refining import Decision, decisions
from kanegen.sequences import NOTES
from kanegen.signature import (
    EQUATIONS,
    chosen,
    functions,
    input_arrays,
    output_array,
    require_available,
)
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
    refinement: str

    @property
    def operations(self) -> dict[str, int]:
        """Operations of one evaluation of all outputs together."""
        return operations(self.module)


def derive(
    system: System, progress: Progress = quiet, speeds: str | None = None, coordinates: str | None = None
) -> symbolic.Equations:
    """The equations of motion in SymPy, literally as the notes derive them.

    Args:
        system: The tree.
        progress: Told the name of each stage.
        speeds: Generalized speeds, as in `System.with_speeds`; default those of the system.
        coordinates: Of orientations, as in `System.with_coordinates`; default those of the system.

    Raises:
        OptionError: If there are no such speeds or coordinates.
        SingularError: If [A] is singular in every state.
    """
    system = described(system, speeds, coordinates)
    progress("deriving")
    _require_usable(system)
    return symbolic.derive(system)


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
    _require_system(system)
    if regular:
        _require_usable(system)
    require_available(system, names)
    constants = precisions.named(variant.precision).constants
    choices = decisions(system, methods(system, with_needs(names), variant.solver), variant)
    ways = [_compiled(system, names, choice, variant.without, progress, constants) for choice in choices]
    return min(ways, key=lambda compiled: sum(compiled.operations.values()) - compiled.operations["prepare"])


def described(system: System, speeds: str | None = None, coordinates: str | None = None) -> System:
    """The same tree with other generalized speeds and coordinates, where they are not None.

    Raises:
        OptionError: If there are no such speeds or coordinates, or they do not go together.
    """
    _require_system(system)
    if (speeds, coordinates) == ("angle_rates", "quaternion"):
        raise OptionError(
            'speeds "angle_rates" are for angles, and coordinates "quaternion" leave none. Leave out one.'
        )
    if coordinates is not None:
        system = system.with_coordinates(coordinates)
    return system if speeds is None else system.with_speeds(speeds)


def _require_system(system: object) -> None:
    if not isinstance(system, System):
        raise OptionError(f"{system!r} is no System. Make one with kg.load or kg.System.from_arrays.")


def _require_usable(system: System) -> None:
    _require_system(system)
    regularity.require_regular(system)


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
    way = choice.methods
    form = recursive_form(system, way, constants, choice.refinement)
    progress("lowering")
    arrays = {output_array(system, name, form.methods): form.outputs[name] for name in way}
    program = lower(input_arrays(system), form.definitions, arrays, constants)
    lowered = dict(zip(way, program.outputs, strict=True))
    program = differentiated(program, system, lowered, names, constants)
    progress("optimising")
    program, stages = passes.run(program, passes.all_but(without, passes.SHARED))
    own = passes.all_but(without, passes.OWN)
    finished = {
        name: passes.run(alone, own) for name, alone in restricted(program, functions(system, names)).items()
    }
    *_, (_, (_, *later)) = finished.values()  # of all outputs together, which come last
    module = hoisted({name: alone for name, (alone, _) in finished.items()})
    if module.prepare:
        module = replace(module, prepare=passes.run(module.prepare, own)[0])
    taken = {name: way.get(name, derivatives.METHOD) for name in names}
    return Compiled(module, taken, (*stages, *later), choice.words)


def generate(
    system: System,
    outputs: Iterable[str] = EQUATIONS,
    progress: Progress = quiet,
    without: Iterable[str] | None = None,
    precision: str | None = None,
    tier: Variant | str = STRICT,
    speeds: str | None = None,
    reanchoring: bool = False,
    coordinates: str | None = None,
) -> Source:
    """C for `outputs`, specialised to `system`.

    Args:
        system: The tree.
        outputs: Names among `OUTPUTS`; the code for several shares its intermediates.
        progress: Told the name of each stage.
        without: Passes to leave out, among "fold", "prune" and "factor": the C computes the same by more
            operations.
        precision: Arithmetic in C, "double", "float", "long double" or "double-double". For float, too,
            constants are computed in double, for the last two in 96 digits; they are rounded once.
        tier: The other choices: a name of `variant.TIERS`, or a `Variant` of one's own, where `without` and
            `precision` stand as well.
        speeds: Generalized speeds, as in `System.with_speeds`; default those of the system. With
            "angular_velocity" [A] is regular everywhere; the output "coordinate_rates" then gives {xdot}.
        reanchoring: Add the header `<model>_reanchor.h`, which does in C what `kanegen.reanchored` does, for
            joints whose orientation is three parameters.
        coordinates: Of orientations, as in `System.with_coordinates`; default those of the system. With
            "quaternion" the rates of the coordinates, too, exist in every orientation.

    Raises:
        OptionError: If an output, a tier or a choice is unknown, or there is nothing to re-anchor.
        ModelError: If a constant leaves the range of the precision.
        SingularError: If [A] is singular in every state; names the body and the freedom.
    """
    system = described(system, speeds, coordinates)
    variant = variants.chosen(tier, precision=precision, without=without)
    compiled = compile_module(system, outputs, progress, variant)
    progress("printing")
    decided = {"refinement": compiled.refinement}
    source = render(facts(system), compiled.module, compiled.operations, variant, decided)
    return with_anchors(source, anchors(system)) if reanchoring else source


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
        speeds: As in `generate`.
        coordinates: As in `generate`.

    Raises:
        OptionError, ModelError, SingularError: As `generate`.
        BuildError: If there is no compiler, or it fails.
    """
    source = generate(system, outputs, progress, without, precision, tier, speeds, coordinates=coordinates)
    progress("compiling")
    return libraries.load(source, compiler, flags, threads)


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
    """The compiled C of `system` against the NumPy reference over random states.

    Args:
        system: The tree.
        states: How many.
        seed: Of the random states.
        progress: Told the name of each stage.
        precision: As in `generate`; the reference computes in double.
        tier: As in `generate`.
        speeds: As in `generate`.
        coordinates: As in `generate`.
    """
    system = described(system, speeds, coordinates)
    built = build(system, progress=progress, precision=precision, tier=tier)
    progress("comparing")
    arithmetic, storage = precisions.named(built.precision), precisions.named(built.storage)
    return compare_with_reference(system, built, states, seed, arithmetic, storage)


def facts(system: System) -> ModelFacts:
    """What the C says about the model beside its programs."""
    return ModelFacts(
        name=system.name,
        freedom_names=system.freedom_names,
        freedom_units=tuple(freedom.unit for freedom in system.freedoms),
        body_names=tuple(body.name for body in system.bodies),
        loaded=tuple(body.loads for body in system.bodies),
        parameters=tuple((parameter.name, parameter.value) for parameter in system.parameters),
        legend=legend(system),
        freedom_bodies=tuple(system.bodies[freedom.body - 1].name for freedom in system.freedoms),
        planar=_planar(system),
        sequences=_sequences(system),
        speed_names=system.speed_names,
        points=tuple((point.name, system.bodies[k - 1].name) for k, point in system.points),
        loaded_points=tuple(point.loads for _, point in system.points),
        force_elements=tuple(element.words for element in system.force_elements),
        poses=system.pose_names,
        reactions=tuple(zip(system.reaction_names, (f.effort for f in system.reacting), strict=True)),
        coordinate_names=system.coordinate_names,
        coordinate_units=tuple(coordinate.unit for coordinate in system.coordinates),
        prescribed=tuple(
            (name, freedom.unit)
            for name, freedom in zip(system.prescribed_names, system.prescribed, strict=True)
        ),
    )


def _sequences(system: System) -> tuple[tuple[str, str], ...]:
    """`ModelFacts.sequences`."""
    turning = [body for body in system.bodies if any(body.joint.free[:3])]
    return tuple((b.name, b.joint.sequence) for b in turning if b.joint.sequence != NOTES)


def _planar(system: System) -> tuple[tuple[int, str], ...]:
    """`ModelFacts.planar`: cos(theta2) for three different axes, sin(theta2) where first and third agree."""
    found = []
    for k, body in enumerate(system.bodies, start=1):
        if body.joint.turns_freely and not body.joint.spins:
            found.append((system.coordinate_place(k, 1), "sin" if body.joint.ends_alike else "cos"))
    return tuple(found)
