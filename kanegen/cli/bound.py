"""`kanegen bound`: proven bounds of the errors of the C, for all states of a box."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from kanegen.cli.loading import load_system, with_places, with_selection
from kanegen.cli.options import (
    AS_WRITTEN,
    DEFAULT_OUTPUTS,
    AsJson,
    Contacts,
    Coordinates,
    FloatingBase,
    Frames,
    JointDynamics,
    Loads,
    Lock,
    Model,
    Outputs,
    Points,
    Precision,
    Reactions,
    RightAngles,
    Sincos,
    Speeds,
    Storage,
)
from kanegen.cli.terminal import FAILED, print_plain, progress


def bound(  # noqa: PLR0913  (an argument for every option)
    *,
    model: Model,
    domain: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="Ranges of all inputs: a TOML file, or its content with ; for the ends of lines, such as "
            "'x.angles = [-1.0, 1.0]; y.angles = [-2.0, 2.0]'. What is left out has the scale of the model.",
            show_default=False,
        ),
    ] = None,
    output: Outputs = DEFAULT_OUTPUTS,
    frames: Frames = None,
    reactions: Reactions = None,
    contacts: Contacts = None,
    floating_base: FloatingBase = False,
    joint_dynamics: JointDynamics = False,
    right_angles: RightAngles = AS_WRITTEN,
    precision: Precision = None,
    storage: Storage = None,
    sincos: Sincos = None,
    speeds: Speeds = None,
    coordinates: Coordinates = None,
    lock: Lock = None,
    points: Points = None,
    loads: Loads = None,
    as_json: AsJson = False,
) -> None:
    """Prove bounds of |computed - exact| for every output of the C for MODEL, over a whole box of inputs.

    Nothing is sampled: ranges of all values are enclosed, and every rounding error counts, also those of
    sine, cosine and constants. The exit status is 1 if an output has no bound in the box, with the reason;
    the output error_bound, which is a bound itself, needs none.
    """
    from kanegen import compiler, options
    from kanegen.recursion.outputs import ERROR_BOUNDS

    system = load_system(model, floating_base, right_angles, speeds, coordinates, lock, joint_dynamics)
    system = with_places(system, points, loads)
    system = with_selection(system, output, frames, reactions, contacts)
    with progress() as report:
        variant = options.chosen_variant(precision=precision, storage=storage, sincos=sincos)
        source = compiler.generate(system, output, report, tier=variant)
        report("bounding")
        found = compiler.bound(source, domain)
    if as_json:
        typer.echo(json.dumps(found.as_dict(), indent=2))
    else:
        print_plain(str(found))
    if found.unbounded.keys() - ERROR_BOUNDS:
        raise typer.Exit(FAILED)
