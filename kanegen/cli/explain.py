"""`kanegen explain`: a receipt on the terminal, and as a page."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from kanegen.cli.loading import loaded, reporting
from kanegen.cli.options import (
    AsJson,
    Coordinates,
    FloatingBase,
    Model,
    Outputs,
    Poses,
    Reactions,
    RightAngles,
    Speeds,
)
from kanegen.cli.terminal import progress, screen
from kanegen.errors import OptionError
from kanegen.files import require_writable, write_whole
from kanegen.model.right_angles import AS_WRITTEN
from kanegen.recursion.outputs import EQUATIONS
from kanegen.studies.explain import page, receipt
from kanegen.studies.explain.markdown import markdown as in_markdown
from kanegen.studies.explain.receipt import Receipt
from kanegen.studies.explain.tables import bodies, heads, outputs, rows


def explain(
    model: Model,
    output: Outputs = list(EQUATIONS),  # noqa: B006  (as for generate)
    poses: Poses = None,
    reactions: Reactions = None,
    floating_base: FloatingBase = False,
    right_angles: RightAngles = AS_WRITTEN,
    speeds: Speeds = None,
    coordinates: Coordinates = None,
    compile_: Annotated[
        bool, typer.Option("--compile", help="Compile the C of the first and the last program, and time it.")
    ] = False,
    as_json: AsJson = False,
    html: Annotated[
        Path | None, typer.Option("--html", metavar="FILE.html", help="Write a page with the tree drawn.")
    ] = None,
    markdown: Annotated[
        Path | None, typer.Option("--markdown", metavar="FILE.md", help="Write a page of Markdown.")
    ] = None,
) -> None:
    """Set the program for MODEL beside the general one of its tree: what it saves, and what is left."""
    for option, path, ending in (("--html", html, ".html"), ("--markdown", markdown, ".md")):
        if path is not None and path.suffix.lower() != ending:
            raise OptionError(f"{option}: {path} does not end in {ending}.")
    require_writable(html, markdown)
    system = loaded(model, floating_base, right_angles, speeds, coordinates)
    system = reporting(system, output, poses, reactions)
    with progress() as report:
        found = receipt(system, output, compile_, report)
    if as_json:
        typer.echo(json.dumps(found.as_dict(), indent=2))
    else:
        _show(found, screen)
    if html is not None:
        write_whole(html, page.html(found))
    if markdown is not None:
        write_whole(markdown, in_markdown(found))


def _show(receipt: Receipt, console: Console) -> None:
    """Print a receipt for people."""
    names = ", ".join(receipt.outputs)
    console.print(
        f"[bold]{escape(receipt.system.name)}[/]: {names} in {receipt.steps[-1].total} operations, "
        f"1/{receipt.ratio:.1f} of the general program of the same tree\n",
        soft_wrap=True,
    )
    console.print("[bold]What the scene does without[/], one after the other")
    console.print(_table(heads(receipt), rows(receipt)))
    console.print("[bold]Where the operations go[/]")
    console.print(_table(["body", "operations"], bodies(receipt)))
    if alone := outputs(receipt):
        console.print("[bold]Each output by itself[/]")
        console.print(_table(["output", "operations"], alone))


def _table(head: Sequence[str], lines: Sequence[Sequence[str]]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for place, title in enumerate(head):
        table.add_column(title, justify="right" if place else "left")
    for line in lines:
        table.add_row(*map(escape, line))
    return table
