"""`kanegen explain`: the cost report of a model on the terminal and as a page."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape

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
    Reactions,
    RightAngles,
    Speeds,
)
from kanegen.cli.terminal import print_table, progress, screen
from kanegen.errors import OptionError
from kanegen.files import require_writable, write_all

if TYPE_CHECKING:
    from kanegen.studies.explain import CostReport


def explain(
    *,
    model: Model,
    output: Outputs = DEFAULT_OUTPUTS,
    frames: Frames = None,
    reactions: Reactions = None,
    contacts: Contacts = None,
    points: Points = None,
    loads: Loads = None,
    floating_base: FloatingBase = False,
    joint_dynamics: JointDynamics = False,
    right_angles: RightAngles = AS_WRITTEN,
    speeds: Speeds = None,
    coordinates: Coordinates = None,
    lock: Lock = None,
    compile_: Annotated[
        bool,
        typer.Option(
            "--compile", help="Compile the general and the specialised C and print how long it takes."
        ),
    ] = False,
    as_json: AsJson = False,
    html: Annotated[
        Path | None,
        typer.Option("--html", metavar="FILE.html", help="Write the report as a page with the tree drawn."),
    ] = None,
    markdown: Annotated[
        Path | None, typer.Option("--markdown", metavar="FILE.md", help="Write the report as Markdown.")
    ] = None,
) -> None:
    """Compare the operations of the C for MODEL with those of the general program of its tree.

    In the general program every freedom is free, every number a run-time parameter, every body loaded.
    """
    from kanegen.studies.explain import cost_report, page, tables

    for option, path, ending in (("--html", html, ".html"), ("--markdown", markdown, ".md")):
        if path is not None and path.suffix.lower() != ending:
            raise OptionError(f"{option}: {path} does not end in {ending}.")
    require_writable(html, markdown)
    system = load_system(model, floating_base, right_angles, speeds, coordinates, lock, joint_dynamics)
    system = with_places(system, points, loads)
    system = with_selection(system, output, frames, reactions, contacts)
    with progress() as show_stage:
        found = cost_report(system, output, compile_, show_stage)
    if as_json:
        typer.echo(json.dumps(found.as_dict(), indent=2))
    else:
        _show(found)
    texts = {}
    if html is not None:
        texts[html] = page.html(found)
    if markdown is not None:
        texts[markdown] = tables.markdown(found)
    write_all(texts)


def _show(report: CostReport) -> None:
    """Print the tables of a cost report."""
    from kanegen.studies.explain import tables

    names = ", ".join(report.outputs)
    screen.print(
        f"[bold]{escape(report.system.name)}[/]: {names} in {report.steps[-1].total} operations, "
        f"1/{report.ratio:.1f} of the general program of the same tree\n",
        soft_wrap=True,
    )
    screen.print("[bold]What the scene does without[/], one after the other")
    print_table(tables.heads(report), tables.rows(report))
    screen.print("[bold]Where the operations go[/]")
    print_table(["body", "operations"], tables.bodies(report))
    if alone := tables.outputs(report):
        screen.print("[bold]Each output by itself[/]")
        print_table(["output", "operations"], alone)
