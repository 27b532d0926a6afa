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
    only: Annotated[
        str | None,
        typer.Option(
            "--only",
            metavar="PART",
            help="Print nothing else: blocks (3 x 3 blocks, by the numbers of the notes), definitions (named "
            "intermediates, [A] and {f} in them), closed (the closed form), linear (small deviations from "
            "rest, see `kanegen linearize`).",
        ),
    ] = None,
    body: Annotated[
        str | None,
        typer.Option(
            "--body",
            metavar="BODY",
            help="Print the equations of one body, by its name or number: its blocks, its definitions, and "
            "the rows of [A] and {f} of its freedoms.",
        ),
    ] = None,
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
    """Print the equations of motion of MODEL: closed forms of a small tree, else blocks and definitions."""
    from kanegen import compiler
    from kanegen.symbolic.printing import render

    system = load_system(model, floating_base, right_angles, speeds, coordinates, lock, joint_dynamics)
    system = with_places(system, points, loads)
    if symbolic:
        system = system.symbolic()
    with progress() as report:
        derived = compiler.derive(system, progress=report)
        report("printing")
        text = render(derived, format_, only=only, body=body)
    typer.echo(text, nl=False)
