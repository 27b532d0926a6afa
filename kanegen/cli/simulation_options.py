"""Options of `kanegen simulate`: duration, inputs, events, method and accuracy, results and pictures."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

Duration = Annotated[
    float | None,
    typer.Option("--duration", metavar="S", help="Duration in s; --until may end it earlier."),
]
Every = Annotated[
    float | None,
    typer.Option(
        "--every",
        metavar="S",
        help="Interval between the states in s; by default duration/200.",
    ),
]
InputExpressions = Annotated[
    list[str] | None,
    typer.Option(
        "--input",
        metavar="NAME=EXPRESSION",
        help="What acts (repeatable), a number or an expression of t, x.NAME and y.NAME, such as "
        "pole=0.5*sin(t): the generalized force on a freedom, the value of a prescribed freedom, or "
        "force.BODY.x, torque.BODY.x, point_force.POINT.x, point_moment.POINT.x.",
        show_default=False,
    ),
]
InputTables = Annotated[
    list[Path] | None,
    typer.Option(
        "--inputs",
        metavar="FILE",
        help="Values of inputs over the time (repeatable), .csv, .parquet or .npz, with a column t in s.",
        show_default=False,
    ),
]
Hold = Annotated[
    str,
    typer.Option("--hold", metavar="NAME", help="How values of --inputs continue: zero or linear."),
]
RecordedEvents = Annotated[
    list[str] | None,
    typer.Option(
        "--event",
        metavar="CONDITION",
        help="Record the times at which this begins to hold (repeatable), such as 'x.pole > pi/2', or at "
        "which an expression crosses zero.",
        show_default=False,
    ),
]
TerminalEvents = Annotated[
    list[str] | None,
    typer.Option(
        "--until",
        metavar="CONDITION",
        help="End with this event (repeatable), such as 'point_positions.tip.z < 0'.",
        show_default=False,
    ),
]
MethodName = Annotated[
    str | None,
    typer.Option(
        "--method",
        metavar="NAME",
        help="RK4, euler, semi_implicit_euler, leapfrog, implicit_midpoint, variational_midpoint, "
        "linearly_implicit or extrapolation with a step; DOP853 or Radau, for stiff systems, with a "
        "tolerance. By default RK4 with a step, and DOP853 without.",
    ),
]
LargestStep = Annotated[float | None, typer.Option("--step", metavar="S", help="Largest fixed step, s.")]
Tolerance = Annotated[
    float | None,
    typer.Option(
        "--tolerance",
        metavar="TOL",
        help="Error of an adaptive step, relative and absolute; 1e-10 without.",
    ),
]
LargestError = Annotated[
    float | None,
    typer.Option(
        "--error",
        metavar="E",
        help="Error of the motion, such as 1e-6, in place of a method with step or tolerance, which are "
        "chosen by measurement, with the precision. Exit status 1 if it cannot be promised to the end.",
    ),
]
Compensated = Annotated[bool, typer.Option("--compensated", help="Add fixed steps with a compensated sum.")]
FurtherOutputs = Annotated[
    list[str] | None,
    typer.Option(
        "--output",
        metavar="NAME",
        help="Output over the time (repeatable), such as point_positions, body_poses or reaction_loads, "
        "beside energies and momentum.",
        show_default=False,
    ),
]
ResultFiles = Annotated[
    list[Path] | None,
    typer.Option(
        "-o",
        "--write",
        metavar="FILE",
        help="Write all columns (repeatable): .csv, .parquet, .nc (NetCDF) or .npz.",
        show_default=False,
    ),
]
PlotFile = Annotated[
    Path | None,
    typer.Option("--plot", metavar="FILE", help="Draw the motion: .svg, .png or .pdf."),
]
PageFile = Annotated[
    Path | None,
    typer.Option("--view", metavar="FILE.html", help="Write a page in which the model moves."),
]
ShownColumns = Annotated[
    list[str] | None,
    typer.Option(
        "--show",
        metavar="NAME",
        help="Column to print and to draw (repeatable), such as x.pole or point_positions.tip.z.",
        show_default=False,
    ),
]
