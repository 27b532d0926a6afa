"""`kanegen tradeoff`: speed against accuracy, every variant measured."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from kanegen.cli.options import FloatingBase, JsonFile, Model, Plot, RightAngles, require_plot
from kanegen.cli.terminal import FAILED, progress, screen
from kanegen.extras import module
from kanegen.model.right_angles import AS_WRITTEN
from kanegen.readers import load
from kanegen.studies.tradeoff import EXTRA as STUDY
from kanegen.studies.tradeoff import NEEDS


def tradeoff(
    model: Model,
    states: Annotated[int, typer.Option(min=1, help="Random states of every sample.")] = 256,
    search: Annotated[int, typer.Option(min=0, help="States tried to find the largest error.")] = 64,
    rounds: Annotated[int, typer.Option(min=1, help="Rounds, in each of which all have one turn.")] = 7,
    seconds: Annotated[float, typer.Option(min=0.0, help="Of every way to call in every turn.")] = 0.02,
    seed: Annotated[int, typer.Option(min=0, help="Of all samples.")] = 0,
    quantile: Annotated[
        str, typer.Option(metavar="NAME", help="The error that counts: max, p99 or median.")
    ] = "max",
    objective: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Show one table only: latency or batch; repeatable."),
    ] = None,
    output_dir: Annotated[
        Path | None,
        typer.Option("--output-dir", "-o", help="Folder for tradeoff.md, .csv, .json and .svg."),
    ] = None,
    simulation: Annotated[
        bool, typer.Option("--simulation", help="Integrate a motion with the best variants, too.")
    ] = False,
    json_: JsonFile = None,
    plot: Plot = None,
    floating_base: FloatingBase = False,
    right_angles: RightAngles = AS_WRITTEN,
) -> None:
    """Speed against accuracy of MODEL: every variant measured; status 1 if one computes something wrong.

    Errors are against certified truth, in random and in hard states; times are taken in turns. What none
    beats in both is the front, measured again in fresh states. Loads are switched off and run-time parameters
    become constants. Needs `pip install 'kanegen[study]'`.
    """
    require_plot(plot, STUDY)
    command = module("kanegen.cli.study", *NEEDS, extra=STUDY)
    system = load(model, floating_base, right_angles)
    outputs = command.Outputs.chosen(output_dir, json_, plot, simulation)
    with progress() as report:
        terms = command.StudyOptions(
            states=states, search=search, rounds=rounds, seconds=seconds, seed=seed, quantile=quantile
        )
        found = command.run(system, terms, objective, simulation, report)
    outputs.write(found)
    command.show(found, objective, screen)
    if any(entry.wrong for entry in found.entries):
        raise typer.Exit(FAILED)
