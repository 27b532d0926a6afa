"""`kanegen generate`: the C for a model, in the chosen variant or in the one that keeps a budget."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape

from kanegen.cli.budget_options import (
    Attempts,
    Confidence,
    Domain,
    ErrorBudget,
    Objective,
    Quantile,
    RelativeTo,
    Reproducible,
    Search,
    Seed,
    SelectStates,
    TimeBudget,
    has_budget,
    is_typed,
)
from kanegen.cli.loading import load_system, names_of, with_places, with_selection
from kanegen.cli.options import (
    AS_WRITTEN,
    DEFAULT_OUTPUTS,
    Contacts,
    Coordinates,
    FloatingBase,
    For,
    Frames,
    Functions,
    JointDynamics,
    Loads,
    Lock,
    Machine,
    MassMatrix,
    Model,
    NoBatches,
    Outputs,
    ParametersByState,
    Platforms,
    Points,
    Precision,
    Reactions,
    Reanchoring,
    RightAngles,
    Sincos,
    Speeds,
    Storage,
    Target,
    Tier,
    Without,
)
from kanegen.cli.targets import chosen_targets
from kanegen.cli.terminal import progress, screen
from kanegen.errors import OptionError, counted
from kanegen.extras import require
from kanegen.studies.tradeoff import EXTRA, NEEDS

if TYPE_CHECKING:
    from kanegen.c.source import Source
    from kanegen.model.system import System


def generate(  # noqa: PLR0913  (an argument for every option)
    context: typer.Context,
    *,
    model: Model,
    output_dir: Annotated[
        Path, typer.Option("--output-dir", "-o", help="Folder for the files; it is made if absent.")
    ],
    output: Outputs = DEFAULT_OUTPUTS,
    name: Annotated[
        str | None,
        typer.Option(
            "--name",
            metavar="NAME",
            help="Name of the system, by default that of MODEL; files begin with it.",
        ),
    ] = None,
    target: Target = "c99",
    for_: For = None,
    platform: Platforms = None,
    function: Functions = None,
    frames: Frames = None,
    reactions: Reactions = None,
    contacts: Contacts = None,
    points: Points = None,
    loads: Loads = None,
    floating_base: FloatingBase = False,
    joint_dynamics: JointDynamics = False,
    right_angles: RightAngles = AS_WRITTEN,
    force: Annotated[
        bool, typer.Option("--force", help="Write even if the folder holds files that kanegen did not write.")
    ] = False,
    without: Without = None,
    precision: Precision = None,
    storage: Storage = None,
    sincos: Sincos = None,
    machine: Machine = None,
    tier: Tier = "strict",
    # From here to seed: the options of a budget, which are read from the context by their names.
    error: ErrorBudget = None,
    budget: TimeBudget = None,
    domain: Domain = None,
    objective: Objective = "latency",
    relative_to: RelativeTo = "terms",
    quantile: Quantile = "max",
    confidence: Confidence = 0.95,
    attempts: Attempts = 2,
    states: SelectStates = 512,
    search: Search = 512,
    reproducible: Reproducible = False,
    seed: Seed = 0,
    speeds: Speeds = None,
    coordinates: Coordinates = None,
    lock: Lock = None,
    reanchoring: Reanchoring = False,
    parameters_by_state: ParametersByState = False,
    no_batches: NoBatches = False,
    mass_matrix: MassMatrix = "full",
) -> None:
    """Write the C for MODEL: header, source, example, CMake and pkg-config files, README.

    With --target cuda it is CUDA C++ for GPUs: device functions, kernels, and functions that launch them.
    With --for, files for other languages and programs are added, such as `--for cpp,rust`. Files of an
    earlier call for the same model that this one does not make are removed, unless they were edited.

    With --error, kanegen chooses the fastest variant of forward dynamics whose error stays below a budget;
    with --budget, the most accurate one whose time does. It measures all variants on this machine, validates
    the chosen one in fresh states, searches for counterexamples and writes a certificate of the result. This
    takes minutes and needs `pip install 'kanegen[study]'`.
    """
    from kanegen import artifacts, compiler, options, products
    from kanegen.c import folder

    keeps_budget = has_budget(context)
    if keeps_budget and target != "c99":
        raise OptionError(
            f"--target {target}: a budget is kept by measured C. Leave out the one or the other."
        )
    system = load_system(model, floating_base, right_angles, speeds, coordinates, lock, joint_dynamics)
    system = system if name is None else system.with_name(name)
    system = with_places(system, points, loads)
    platforms = names_of("--platform", platform) or None
    asked, compiled = chosen_targets(for_, platforms)
    outputs = artifacts.outputs_with(asked, system, output if is_typed(context, "output") else None)
    system = with_selection(system, outputs, frames, reactions, contacts)
    if keeps_budget:
        source = _within_budget(system, context, output_dir, force)
    else:
        with progress() as report:
            variant = options.chosen_variant(
                tier, precision=precision, without=without, storage=storage, sincos=sincos, machine=machine
            )
            variant = artifacts.variant_with(asked, variant, precision=precision)
            source = compiler.generate(
                system,
                outputs,
                report,
                precision=variant.precision,
                tier=variant,
                reanchoring=reanchoring,
                artifacts=asked,
                functions=function,
                parameters_by_state=parameters_by_state,
                batches=not no_batches,
                target=target,
                mass_matrix=mass_matrix,
            )
    files: dict[str, str | bytes] = {**source.files, **products.compiled_files(source, compiled, platforms)}
    removed = folder.write(files, output_dir, force, source.model.name, source.places)
    _show(system, source, files, output_dir)
    if removed:
        screen.print(f"removed {', '.join(removed)}, which this call does not make", soft_wrap=True)


def _within_budget(system: System, context: typer.Context, folder: Path, force: bool) -> Source:
    """Find the variant that keeps the budget, print it, and return its C with the certificate."""
    for package in NEEDS:
        require(package, EXTRA)
    from kanegen.cli.budget import BudgetOptions, generate, show

    options = BudgetOptions.typed(context.params)
    with progress() as report:
        found = generate(system, options, folder, force, report)
    show(found)
    return found.source


def _show(system: System, source: Source, files: Iterable[str], folder: Path) -> None:
    """Print the size of the system, the operations and the files."""
    cost = ", ".join(f"{kind} {number}" for kind, number in source.operations.items())
    freedoms = counted(len(system.freedoms), "freedom")
    screen.print(f"{escape(system.name)}: {freedoms}, {' and '.join((*source.outputs, *source.integrators))}")
    screen.print(f"operations: {cost}")
    screen.print(f"wrote {', '.join(files)} to {folder}", soft_wrap=True)
