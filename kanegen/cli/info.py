"""`kanegen info`: the tree of a model, its freedoms and parameters, and the cost of its equations."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Annotated

import typer

from kanegen.cli.loading import load_system, with_places, with_selection
from kanegen.cli.options import (
    AS_WRITTEN,
    AsJson,
    Contacts,
    Coordinates,
    FloatingBase,
    Frames,
    JointDynamics,
    Loads,
    Lock,
    Model,
    Points,
    Reactions,
    RightAngles,
    Speeds,
    Without,
)
from kanegen.cli.terminal import collected_warnings, progress, screen, without_warnings

if TYPE_CHECKING:
    from kanegen.model.system import System


def info(
    model: Model,
    floating_base: FloatingBase = False,
    joint_dynamics: JointDynamics = False,
    right_angles: RightAngles = AS_WRITTEN,
    without: Without = None,
    speeds: Speeds = None,
    coordinates: Coordinates = None,
    lock: Lock = None,
    frames: Frames = None,
    reactions: Reactions = None,
    contacts: Contacts = None,
    points: Points = None,
    loads: Loads = None,
    verbose: Annotated[
        bool, typer.Option("--verbose", help="Name all frames, limits and bodies that a line counts.")
    ] = False,
    every: Annotated[
        bool,
        typer.Option(
            "--all",
            help="Also count the operations of derivatives, error bounds and operational inertias of all "
            "bodies, which takes minutes for a large tree.",
        ),
    ] = False,
    sums: Annotated[
        bool,
        typer.Option(
            "--base-parameters", help="Name the base parameters, as sums over inertial parameters of bodies."
        ),
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Show the tree of MODEL, its freedoms and parameters, and the number of operations of its outputs.

    A section says what the reader left out or changed, which links are fixed in which bodies, which frames
    are turned, and which limits there are. A line counts the base parameters: the combinations of masses,
    first moments and inertias that forces and motions determine.

    The column "prepare" counts operations that depend on parameters alone and run once for each set of
    parameters. The rows "this after ..." count the operations of [A] and {f} together after each pass of the
    optimiser.
    """
    from kanegen.cli.summary import RightAngleChanges, summarize
    from kanegen.cli.summary_text import show
    from kanegen.model.right_angles import FOUR_DECIMALS
    from kanegen.recursion.outputs import OUTPUTS
    from kanegen.studies.explain import exactness

    def read(limit: float) -> System:
        system = load_system(model, floating_base, limit, speeds, coordinates, lock, joint_dynamics)
        system = with_places(system, points, loads)
        return with_selection(system, tuple(OUTPUTS), frames, reactions, contacts)

    with collected_warnings() as left_out:
        system = read(right_angles)
    tolerance = right_angles or FOUR_DECIMALS
    with without_warnings():
        written, exact = read(AS_WRITTEN), read(tolerance)
    with progress() as report:
        found = exactness(written, exact, report)
        changes = RightAngleChanges(tolerance, bool(right_angles), found) if found else None
        summary = summarize(system, report, without, changes, every=every, left_out=left_out)
    if as_json:
        typer.echo(json.dumps(summary.as_dict(), indent=2))
    else:
        show(summary, screen, verbose, sums)
