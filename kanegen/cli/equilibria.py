"""`kanegen equilibria`: states of rest and steady motions, with their stability."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from kanegen.cli.loading import load_system
from kanegen.cli.options import (
    AS_WRITTEN,
    AsJson,
    Coordinates,
    FloatingBase,
    JointDynamics,
    Lock,
    Model,
    RightAngles,
    Speeds,
)
from kanegen.cli.state_options import Tau, numbers_by_name
from kanegen.cli.terminal import progress


def equilibria(
    model: Model,
    speed: Annotated[
        list[str] | None,
        typer.Option(
            "--speed",
            metavar="NAME=VALUE",
            help="Constant rate of a coordinate that turns or moves, rad/s or m/s (repeatable), such as "
            "spin=100; all others rest.",
            show_default=False,
        ),
    ] = None,
    tau: Tau = None,
    starts: Annotated[int, typer.Option(min=1, help="Number of random states from which to search.")] = 200,
    seed: Annotated[int, typer.Option(min=0, help="Seed of these states.")] = 0,
    floating_base: FloatingBase = False,
    joint_dynamics: JointDynamics = False,
    right_angles: RightAngles = AS_WRITTEN,
    speeds: Speeds = None,
    coordinates: Coordinates = None,
    lock: Lock = None,
    as_json: AsJson = False,
) -> None:
    """Search for states of rest of MODEL, or steady motions with given constant speeds, and their stability.

    The search begins in the neutral position and in random states; it is not proven to find all. Of a
    continuous family one state is printed, with the free direction. Prescribed motions rest at zero.
    """
    from kanegen import compiler
    from kanegen.model.numbers import value_of

    system = load_system(model, floating_base, right_angles, speeds, coordinates, lock, joint_dynamics)
    pairs = (("--speed", speed), ("--tau", tau))
    given = [numbers_by_name(option, texts, system) for option, texts in pairs]
    rates, efforts = ({name: value_of(number) for name, number in part.items()} for part in given)
    with progress() as report:
        report("searching")
        found = compiler.equilibria(system, rates, efforts, starts=starts, seed=seed)
    typer.echo(json.dumps(found.as_dict(), indent=2) if as_json else str(found).rstrip())
