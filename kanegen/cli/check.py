"""`kanegen check`: the compiled C compared with the NumPy reference."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from kanegen.cli.loading import load_system, with_places
from kanegen.cli.options import (
    AS_WRITTEN,
    AsJson,
    Coordinates,
    FloatingBase,
    JointDynamics,
    Loads,
    Lock,
    Model,
    Points,
    Precision,
    RightAngles,
    Sincos,
    Speeds,
    Storage,
    Tier,
    require_plot,
)
from kanegen.cli.terminal import FAILED, progress
from kanegen.files import require_writable

MOST_DRAWN = 128
"""Largest number of states that a picture shows."""


def check(
    model: Model,
    states: Annotated[int, typer.Option(min=1, help="Number of random states.")] = 1000,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random states.")] = 0,
    floating_base: FloatingBase = False,
    joint_dynamics: JointDynamics = False,
    right_angles: RightAngles = AS_WRITTEN,
    precision: Precision = None,
    storage: Storage = None,
    sincos: Sincos = None,
    tier: Tier = "strict",
    speeds: Speeds = None,
    coordinates: Coordinates = None,
    lock: Lock = None,
    points: Points = None,
    loads: Loads = None,
    as_json: AsJson = False,
    plot: Annotated[
        Path | None,
        typer.Option(
            "--plot",
            metavar="FILE.svg",
            help="Also measure closed form, definitions, reference and C in double and single precision in "
            "the same states, against certified truth, and draw their errors as SVG.",
        ),
    ] = None,
) -> None:
    """Compile the C for MODEL and compare its results with those of an independent NumPy program.

    States are random; others follow, at rest, at the origin and at kinks of expressions. With --plot, half of
    the states that are drawn approach gimbal lock; needs `pip install 'kanegen[study]'`.

    The exit status is 1 if a difference exceeds what rounding errors explain.
    """
    from kanegen import compiler, options
    from kanegen.measure.programs.picture import EXTRA

    require_plot(plot, EXTRA)
    require_writable(plot)
    system = load_system(model, floating_base, right_angles, speeds, coordinates, lock, joint_dynamics)
    system = with_places(system, points, loads)
    with progress() as report:
        variant = options.chosen_variant(tier, precision=precision, storage=storage, sincos=sincos)
        result = compiler.compare(system, states=states, seed=seed, progress=report, tier=variant)
        programs = None if plot is None else result.programs(min(max(states, 2), MOST_DRAWN), report)
    typer.echo(json.dumps(result.as_dict(), indent=2) if as_json else str(result))
    if programs is not None and plot is not None:
        programs.plot().write(plot)
        if not as_json:
            typer.echo(f"\n{programs}")
    if not result.passed:
        raise typer.Exit(FAILED)
