"""`kanegen info`: facts about a model, for people or as JSON."""

from __future__ import annotations

import json

import typer

from kanegen.cli import facts
from kanegen.cli.drawing import show
from kanegen.cli.loading import loaded
from kanegen.cli.options import AsJson, Coordinates, FloatingBase, Model, RightAngles, Speeds, Without
from kanegen.cli.right_angles import Angles
from kanegen.cli.terminal import progress, screen, unheard
from kanegen.model.right_angles import AS_WRITTEN, TYPED
from kanegen.studies.explain import exactness


def info(
    model: Model,
    floating_base: FloatingBase = False,
    right_angles: RightAngles = AS_WRITTEN,
    without: Without = None,
    speeds: Speeds = None,
    coordinates: Coordinates = None,
    as_json: AsJson = False,
) -> None:
    """Show the tree of MODEL, its freedoms and parameters, and what its equations cost."""
    system = loaded(model, floating_base, right_angles, speeds, coordinates)
    tolerance = right_angles or TYPED
    with unheard():
        written, exact = (
            loaded(model, floating_base, limit, speeds, coordinates) for limit in (AS_WRITTEN, tolerance)
        )
    with progress() as report:
        found = exactness(written, exact, report)
        angles = Angles(tolerance, bool(right_angles), found) if found else None
        gathered = facts.gather(system, report, without, angles)
    if as_json:
        typer.echo(json.dumps(gathered.as_dict(), indent=2))
    else:
        show(gathered, screen)
