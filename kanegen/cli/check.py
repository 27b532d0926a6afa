"""`kanegen check`: the compiled C compared with the NumPy reference."""

from __future__ import annotations

import json
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
)
from kanegen.cli.terminal import FAILED, progress


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
) -> None:
    """Compile the C for MODEL and compare its results with those of an independent NumPy program.

    States are random; others follow, at rest, at the origin and at kinks of expressions.

    The exit status is 1 if a difference exceeds what rounding errors explain.
    """
    from kanegen import compiler, options

    system = load_system(model, floating_base, right_angles, speeds, coordinates, lock, joint_dynamics)
    system = with_places(system, points, loads)
    with progress() as report:
        variant = options.chosen_variant(tier, precision=precision, storage=storage, sincos=sincos)
        result = compiler.compare(system, states=states, seed=seed, progress=report, tier=variant)
    typer.echo(json.dumps(result.as_dict(), indent=2) if as_json else str(result))
    if not result.passed:
        raise typer.Exit(FAILED)
