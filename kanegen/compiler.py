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

from collections.abc import Iterable, Sequence

from kanegen import library as libraries
from kanegen import options as variants
from kanegen import symbolic
from kanegen.artifacts import with_artifacts
from kanegen.c import Source, description, render
from kanegen.lowering.compiling import Compiled, compile_module
from kanegen.lowering.request import described, require_usable
from kanegen.measure.comparison import Report
from kanegen.measure.comparison import compare as compare_with_reference
from kanegen.model.system import System
from kanegen.options import STRICT, Progress, Variant, quiet
from kanegen.program import precision as precisions
from kanegen.recursion.outputs import EQUATIONS

__all__ = [
    "Compiled",
    "Progress",
    "build",
    "compare",
    "compile_module",
    "derive",
    "described",
    "description",
    "generate",
    "quiet",
]


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
    require_usable(system)
    return symbolic.derive(system)


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
    source = render(description(system), compiled.module, compiled.operations, variant, decided)
    return with_artifacts(source, ["reanchoring"] if reanchoring else [])


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
    arithmetic, storage = (
        precisions.precision_named(built.precision),
        precisions.precision_named(built.storage),
    )
    return compare_with_reference(system, built, states, seed, arithmetic, storage)
