"""Arguments and options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from kanegen.body import ORIENTATIONS, SPEEDS
from kanegen.precision import PRECISIONS
from kanegen.program.passes import NAMES
from kanegen.right_angles import TYPED
from kanegen.signature import OUTPUTS
from kanegen.variant import TIERS

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

_BUDGETS = "With a budget"

ErrorBudget = Annotated[
    str | None,
    typer.Option("--error", metavar="NUMBER", help="Budget of the relative error.", rich_help_panel=_BUDGETS),
]
TimeBudget = Annotated[
    str | None,
    typer.Option("--budget", metavar="TIME", help="Such as 200ns or 1.5us.", rich_help_panel=_BUDGETS),
]
Domain = Annotated[
    str | None,
    typer.Option(
        "--domain",
        metavar="FILE.toml",
        help="States that count, or such as 'x.angles = [-1, 1]; y.angles = [-2, 2]'.",
        rich_help_panel=_BUDGETS,
    ),
]
Objective = Annotated[
    str,
    typer.Option("--objective", metavar="NAME", help="Timed: latency or batch.", rich_help_panel=_BUDGETS),
]
Quantile = Annotated[
    str,
    typer.Option(
        "--quantile",
        metavar="SHARE",
        help="Of the states that keep the error, such as 0.999; max: no state that is tried exceeds it.",
        rich_help_panel=_BUDGETS,
    ),
]
Confidence = Annotated[
    float, typer.Option("--confidence", help="With which that is shown.", rich_help_panel=_BUDGETS)
]
Attempts = Annotated[
    int,
    typer.Option("--attempts", help="Variants that may be validated at most.", rich_help_panel=_BUDGETS),
]
SelectStates = Annotated[
    int,
    typer.Option("--states", help="Random states to choose a variant by.", rich_help_panel=_BUDGETS),
]
Search = Annotated[
    int,
    typer.Option(
        "--search", help="States tried in each search for a counterexample.", rich_help_panel=_BUDGETS
    ),
]
Reproducible = Annotated[
    bool,
    typer.Option(
        "--reproducible",
        help="Only variants with the same bits on every machine.",
        rich_help_panel=_BUDGETS,
    ),
]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Of all samples.", rich_help_panel=_BUDGETS)]
