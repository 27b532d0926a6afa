"""Arguments and options of the commands; those of a budget stand apart in `budget_options`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from kanegen.errors import OptionError
from kanegen.extras import BENCH, require
from kanegen.model.freedoms import ORIENTATIONS, SPEEDS
from kanegen.model.right_angles import TYPED
from kanegen.options import TIERS
from kanegen.program.passes import NAMES
from kanegen.program.precision import PRECISIONS
from kanegen.recursion.outputs import OUTPUTS

Model = Annotated[
    Path, typer.Argument(metavar="MODEL", help="Model file, .toml or .urdf.", show_default=False)
]
FloatingBase = Annotated[
    bool, typer.Option("--floating-base", help="Give the root link of a .urdf six freedoms.")
]
RightAngles = Annotated[
    float,
    typer.Option(
        "--right-angles",
        metavar="TOL",
        help=f"Make exact what misses a right angle by no more (rad); {TYPED:g} takes 1.5708 for pi/2.",
    ),
]
Outputs = Annotated[
    list[str],
    typer.Option("--output", metavar="NAME", help=f"What to compute, repeatable: {', '.join(OUTPUTS)}."),
]
Poses = Annotated[
    str | None,
    typer.Option("--poses", metavar="NAMES", help="Bodies of output body_poses, such as tool,base."),
]
Reactions = Annotated[
    str | None,
    typer.Option(
        "--reactions", metavar="NAMES", help="Directions of output reaction_loads, such as arm.theta2,arm.s1."
    ),
]
Without = Annotated[
    list[str] | None,
    typer.Option("--without", metavar="PASS", help=f"Leave a pass out, repeatable: {', '.join(NAMES)}."),
]
Numbers = Annotated[
    str | None,
    typer.Option("--precision", metavar="NAME", help=f"Arithmetic in C: {', '.join(PRECISIONS)}."),
]
Stored = Annotated[
    str | None,
    typer.Option("--storage", metavar="NAME", help="Arrays in C, where they differ: a precision."),
]
Waves = Annotated[
    str | None,
    typer.Option(
        "--sincos", metavar="NAME", help="Sine and cosine: shared, libm, or polynomial-5 to polynomial-15."
    ),
]
Tier = Annotated[
    str, typer.Option("--tier", metavar="NAME", help=f"Speed against accuracy: {' or '.join(TIERS)}.")
]
Speeds = Annotated[
    str | None,
    typer.Option("--speeds", metavar="NAME", help=f"Where three angles are free: {' or '.join(SPEEDS)}."),
]
Coordinates = Annotated[
    str | None,
    typer.Option(
        "--coordinates", metavar="NAME", help=f"Where three angles are free: {' or '.join(ORIENTATIONS)}."
    ),
]
Reanchoring = Annotated[
    bool,
    typer.Option(
        "--reanchoring", help="Add a header that turns joint frames, where these are parameters, at run time."
    ),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON instead of text.")]
JsonFile = Annotated[
    Path | None,
    typer.Option("--json", metavar="FILE", help="Write every number and the machine as JSON."),
]
Plot = Annotated[Path | None, typer.Option("--plot", metavar="FILE.svg", help="Draw the times as SVG.")]


def require_plot(path: Path | None, extra: str = BENCH) -> None:
    """Say at once what would only fail minutes later.

    Raises:
        OptionError: If the file is no .svg.
        MissingError: If what draws is not installed; names the `extra` that brings it.
    """
    if path is not None:
        if path.suffix != ".svg":
            raise OptionError(f"--plot: {path} does not end in .svg.")
        require("matplotlib", extra)
