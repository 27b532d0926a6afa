"""`kanegen view`: a picture of a model as one page that any browser shows."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from kanegen.cli.loading import load_system, with_places
from kanegen.cli.options import (
    AS_WRITTEN,
    Coordinates,
    FloatingBase,
    Lock,
    Model,
    Points,
    RightAngles,
)
from kanegen.cli.state_options import X, numbers_by_name
from kanegen.cli.terminal import print_plain, progress


def view(
    model: Model,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE.html",
            help="The page; by default the name of the model in the current folder.",
            show_default=False,
        ),
    ] = None,
    x: X = None,
    open_: Annotated[bool, typer.Option("--open", help="Show the page in the browser.")] = False,
    floating_base: FloatingBase = False,
    right_angles: RightAngles = AS_WRITTEN,
    coordinates: Coordinates = None,
    lock: Lock = None,
    points: Points = None,
) -> None:
    """Write a page that shows MODEL and moves it, with a slider for every coordinate.

    The page needs neither a network nor a server. Bodies without geometry are drawn as the ellipsoids of
    uniform density that have their mass and inertia, with their joints and the lines between them.
    """
    from kanegen.model.numbers import value_of
    from kanegen.viewer.view import view as picture

    system = load_system(model, floating_base, right_angles, None, coordinates, lock)
    system = with_places(system, points, None)
    values = {name: value_of(number) for name, number in numbers_by_name("--x", x, system).items()}
    with progress() as report:
        report("drawing")
        file = output or Path(f"{system.identifier}.html")
        picture(system, x=values).save(file)
    print_plain(f"wrote {file}")
    if open_:
        typer.launch(str(file.resolve()))
