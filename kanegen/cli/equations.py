"""`kanegen equations`: the equations of motion as text, Markdown, LaTeX or Python."""

from __future__ import annotations

from typing import Annotated

import typer

from kanegen.cli.loading import load_system, with_places
from kanegen.cli.options import (
    AS_WRITTEN,
    Coordinates,
    FloatingBase,
    JointDynamics,
    Loads,
    Lock,
    Model,
    Points,
    RightAngles,
    Speeds,
)
from kanegen.cli.terminal import progress


def equations(
    model: Model,
    format_: Annotated[
        str,
        typer.Option("--format", metavar="FORMAT", help="Form of the text: text, markdown, latex, python."),
    ] = "text",
    symbolic: Annotated[
        bool,
        typer.Option(
            "--symbolic",
            help="Print symbols in place of numbers: m_K, r_K_i, q_K_i and I_K_ij of body K, and gravity g. "
            "Zeros stay zero.",
        ),
    ] = False,
    floating_base: FloatingBase = False,
    joint_dynamics: JointDynamics = False,
    right_angles: RightAngles = AS_WRITTEN,
    speeds: Speeds = None,
    coordinates: Coordinates = None,
    lock: Lock = None,
    points: Points = None,
    loads: Loads = None,
) -> None:
    """Print the equations of motion of MODEL: in closed form for a small tree, else by named definitions."""
    from kanegen import compiler
    from kanegen.symbolic.printing import render

    system = load_system(model, floating_base, right_angles, speeds, coordinates, lock, joint_dynamics)
    system = with_places(system, points, loads)
    if symbolic:
        system = system.symbolic()
    with progress() as report:
        derived = compiler.derive(system, progress=report)
        report("printing")
        text = render(derived, format_)
    typer.echo(text, nl=False)
