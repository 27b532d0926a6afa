"""`kanegen equations`: the equations of motion as text, LaTeX or code."""

from __future__ import annotations

from typing import Annotated

import typer

from kanegen import compiler
from kanegen.cli.loading import loaded
from kanegen.cli.options import Coordinates, FloatingBase, Model, RightAngles, Speeds
from kanegen.cli.terminal import progress
from kanegen.model.right_angles import AS_WRITTEN
from kanegen.symbolic.printing import FORMATS, render


def equations(
    model: Model,
    format_: Annotated[
        str, typer.Option("--format", metavar="FORMAT", help=f"One of {', '.join(FORMATS)}.")
    ] = "text",
    floating_base: FloatingBase = False,
    right_angles: RightAngles = AS_WRITTEN,
    speeds: Speeds = None,
    coordinates: Coordinates = None,
) -> None:
    """Print the equations of motion of MODEL: in closed form for a small tree, else by definitions."""
    system = loaded(model, floating_base, right_angles, speeds, coordinates)
    with progress() as report:
        derived = compiler.derive(system, progress=report)
        report("printing")
        text = render(derived, format_)
    typer.echo(text, nl=False)
