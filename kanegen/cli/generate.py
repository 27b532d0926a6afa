"""`kanegen generate`: the C for a model, the usual one or the one that keeps a budget."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from kanegen import compiler
from kanegen import options as variants
from kanegen.artifacts.reanchoring import with_anchors
from kanegen.c.source import Source
from kanegen.cli.budget_options import (
    Attempts,
    Confidence,
    Domain,
    ErrorBudget,
    Objective,
    Quantile,
    Reproducible,
    Search,
    Seed,
    SelectStates,
    TimeBudget,
    has_budget,
)
from kanegen.cli.loading import loaded, reporting
from kanegen.cli.options import (
    Coordinates,
    FloatingBase,
    Model,
    Numbers,
    Outputs,
    Poses,
    Reactions,
    Reanchoring,
    RightAngles,
    Speeds,
    Stored,
    Tier,
    Waves,
    Without,
)
from kanegen.cli.terminal import progress, screen
from kanegen.extras import module
from kanegen.model.reanchorable import anchors
from kanegen.model.right_angles import AS_WRITTEN
from kanegen.model.system import System
from kanegen.recursion.outputs import EQUATIONS
from kanegen.studies.tradeoff import EXTRA as STUDY
from kanegen.studies.tradeoff import NEEDS


def generate(  # noqa: PLR0913  (an argument for every option)
    context: typer.Context,
    *,
    model: Model,
    output_dir: Annotated[
        Path, typer.Option("--output-dir", "-o", help="Folder for the files; made if absent.")
    ],
    output: Outputs = list(EQUATIONS),  # noqa: B006  (typer reads the default, nobody changes it)
    poses: Poses = None,
    reactions: Reactions = None,
    floating_base: FloatingBase = False,
    right_angles: RightAngles = AS_WRITTEN,
    force: Annotated[
        bool, typer.Option("--force", help="Write also where the folder holds files of another origin.")
    ] = False,
    without: Without = None,
    precision: Numbers = None,
    storage: Stored = None,
    sincos: Waves = None,
    tier: Tier = "strict",
    # From here to seed: the terms of a budget, which reads them from the context by name.
    error: ErrorBudget = None,
    budget: TimeBudget = None,
    domain: Domain = None,
    objective: Objective = "latency",
    quantile: Quantile = "max",
    confidence: Confidence = 0.95,
    attempts: Attempts = 2,
    states: SelectStates = 512,
    search: Search = 512,
    reproducible: Reproducible = False,
    seed: Seed = 0,
    speeds: Speeds = None,
    coordinates: Coordinates = None,
    reanchoring: Reanchoring = False,
) -> None:
    """Write the C for MODEL: header, source, example, CMake and pkg-config files, README.

    With --error the fastest variant of forward dynamics whose error stays below a budget, with --budget the
    most accurate one whose time does: all are measured on this machine, the chosen one is validated in fresh
    states and searched for counterexamples, and a certificate says what was found. This takes minutes, and
    `pip install 'kanegen[study]'`.
    """
    keeps_budget = has_budget(context)
    system = loaded(model, floating_base, right_angles, speeds, coordinates)
    system = reporting(system, output, poses, reactions)
    wanted = anchors(system) if reanchoring else ()
    if keeps_budget:
        source = _within_budget(system, context, output_dir, force)
    else:
        with progress() as report:
            variant = variants.chosen(
                tier, precision=precision, without=without, storage=storage, sincos=sincos
            )
            source = compiler.generate(system, outputs=output, progress=report, tier=variant)
    source = with_anchors(source, wanted) if wanted else source
    source.write(output_dir, force=force)
    _show(system, source, output_dir)


def _within_budget(system: System, context: typer.Context, folder: Path, force: bool) -> Source:
    """The C that keeps the budget that was typed, with its certificate; says which variant it is."""
    command = module("kanegen.cli.budget", *NEEDS, extra=STUDY)
    terms = command.BudgetOptions.typed(context.params)
    with progress() as report:
        found = command.generate(system, terms, folder, force, report)
    command.show(found, screen)
    source: Source = found.source
    return source


def _show(system: System, source: Source, folder: Path) -> None:
    cost = ", ".join(f"{kind} {number}" for kind, number in source.operations.items())
    screen.print(f"{system.name}: {len(system.freedoms)} freedoms, {' and '.join(source.outputs)}")
    screen.print(f"operations: {cost}")
    screen.print(f"wrote {', '.join(source.files)} to {folder}", soft_wrap=True)
