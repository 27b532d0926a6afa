"""The entry point of the command line, which joins the commands of the modules beside this one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import typer

from kanegen import __version__
from kanegen.cli import cache
from kanegen.cli.bench import bench
from kanegen.cli.bound import bound
from kanegen.cli.check import check
from kanegen.cli.equations import equations
from kanegen.cli.equilibria import equilibria
from kanegen.cli.explain import explain
from kanegen.cli.generate import generate
from kanegen.cli.info import info
from kanegen.cli.linearize import linearize
from kanegen.cli.simulate import simulate
from kanegen.cli.sweep import sweep
from kanegen.cli.terminal import fail, notices, show_warnings
from kanegen.cli.tradeoff import tradeoff
from kanegen.cli.verify import verify
from kanegen.cli.view import view
from kanegen.cli.web import web
from kanegen.errors import KanegenError

COMMANDS: tuple[Callable[..., None], ...] = (
    generate,
    verify,
    check,
    bound,
    equations,
    linearize,
    equilibria,
    simulate,
    info,
    view,
    web,
    explain,
    bench,
    tradeoff,
    sweep,
)
"""All commands, in the order in which `kanegen --help` lists them."""

app = typer.Typer(
    name="kanegen",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="markdown",
    help="Derive Kane's equations of motion [A]{ydot} = {f} of a tree of rigid bodies and write C for "
    "exactly that tree.",
    epilog="Exit status: 0 success, 1 a check did not pass, 2 bad input, 130 interrupted.",
)
for command in COMMANDS:
    app.command()(command)
app.add_typer(cache.app, name="cache")


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"kanegen {__version__}")
        raise typer.Exit


@app.callback()
def common(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and exit."),
    ] = False,
) -> None:
    """Accept the options that stand before a command."""


def main() -> None:
    """Run the command line; an error of kanegen becomes one line on standard error and exit status 2."""
    show_warnings()
    try:
        app()
    except KanegenError as error:
        fail(error)
    finally:
        notices.release()
