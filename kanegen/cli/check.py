"""`kanegen check`: the compiled C beside the NumPy reference."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from kanegen import compiler
from kanegen import options as variants
from kanegen.cli.loading import loaded
from kanegen.cli.options import (
    AsJson,
    Coordinates,
    FloatingBase,
    Model,
    Numbers,
    RightAngles,
    Speeds,
    Stored,
    Tier,
    Waves,
)
from kanegen.cli.terminal import FAILED, progress
from kanegen.model.right_angles import AS_WRITTEN


def check(
    model: Model,
    states: Annotated[int, typer.Option(min=1, help="Number of random states.")] = 1000,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random states.")] = 0,
    floating_base: FloatingBase = False,
    right_angles: RightAngles = AS_WRITTEN,
    precision: Numbers = None,
    storage: Stored = None,
    sincos: Waves = None,
    tier: Tier = "strict",
    speeds: Speeds = None,
    coordinates: Coordinates = None,
    as_json: AsJson = False,
) -> None:
    """Compile the C for MODEL and compare it with the NumPy reference; status 1 if it does not pass."""
    system = loaded(model, floating_base, right_angles, speeds, coordinates)
    with progress() as report:
        variant = variants.chosen(tier, precision=precision, storage=storage, sincos=sincos)
        result = compiler.compare(system, states=states, seed=seed, progress=report, tier=variant)
    typer.echo(json.dumps(result.as_dict(), indent=2) if as_json else str(result))
    if not result.passed:
        raise typer.Exit(FAILED)
