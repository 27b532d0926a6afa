"""All commands together, and the entry point; every command is a module of its own beside this one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import typer

from kanegen import __version__
from kanegen.cli.bench import bench
from kanegen.cli.check import check
from kanegen.cli.equations import equations
from kanegen.cli.explain import explain
from kanegen.cli.generate import generate
from kanegen.cli.info import info
from kanegen.cli.terminal import fail, show_warnings
from kanegen.cli.tradeoff import tradeoff
from kanegen.cli.verify import verify
from kanegen.errors import KanegenError

COMMANDS: tuple[Callable[..., None], ...] = (
    generate,
    verify,
    check,
    equations,
    info,
    explain,
    bench,
    tradeoff,
)
"""In the order of --help."""

app = typer.Typer(
    name="kanegen",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="markdown",
    help="Kane's equations of motion [A]{ydot} = {f} for a tree of rigid bodies, as C made for that tree.",
    epilog="Exit status: 0 done, 1 a check did not pass, 2 bad input.",
)
for command in COMMANDS:
    app.command()(command)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"kanegen {__version__}")
        raise typer.Exit


@app.callback()
def common(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Options before the command."""


def main() -> None:
    """Entry point: errors of kanegen become one line and status 2."""
    show_warnings()
    try:
        app()
    except KanegenError as error:
        fail(error)
