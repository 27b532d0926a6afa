"""The commands and their options."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from kanegen import compiler
from kanegen.cli import info as information
from kanegen.cli.terminal import FAILED, fail, progress, screen, show_warnings
from kanegen.errors import KanegenError
from kanegen.printing import FORMATS, render
from kanegen.readers import load
from kanegen.signature import EQUATIONS, OUTPUTS
from kanegen.version import __version__

app = typer.Typer(
    name="kanegen",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="markdown",
    help="Kane's equations of motion [A]{ydot} = {f} for a tree of rigid bodies, as C made for that tree.",
    epilog="Exit status: 0 done, 1 a check did not pass, 2 bad input.",
)

Model = Annotated[
    Path, typer.Argument(metavar="MODEL", help="Model file, .toml or .urdf.", show_default=False)
]
FloatingBase = Annotated[
    bool, typer.Option("--floating-base", help="Give the root link of a .urdf six freedoms.")
]
Outputs = Annotated[
    list[str],
    typer.Option("--output", metavar="NAME", help=f"What to compute, repeatable: {', '.join(OUTPUTS)}."),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON instead of text.")]


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


@app.command()
def generate(
    model: Model,
    output_dir: Annotated[
        Path, typer.Option("--output-dir", "-o", help="Folder for the files; made if absent.")
    ],
    output: Outputs = list(EQUATIONS),  # noqa: B006  (typer reads the default, nobody changes it)
    floating_base: FloatingBase = False,
    force: Annotated[
        bool, typer.Option("--force", help="Write also where the folder holds files of another origin.")
    ] = False,
) -> None:
    """Write the C for MODEL: header, source, example, CMake and pkg-config files, README."""
    system = load(model, floating_base=floating_base)
    with progress() as report:
        source = compiler.generate(system, outputs=output, progress=report)
    source.write(output_dir, force=force)
    cost = ", ".join(f"{kind} {number}" for kind, number in source.operations.items())
    screen.print(f"{system.name}: {len(system.freedoms)} freedoms, {' and '.join(source.outputs)}")
    screen.print(f"operations: {cost}")
    screen.print(f"wrote {', '.join(source.files)} to {output_dir}", soft_wrap=True)


@app.command()
def check(
    model: Model,
    states: Annotated[int, typer.Option(min=1, help="Number of random states.")] = 1000,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random states.")] = 0,
    floating_base: FloatingBase = False,
    as_json: AsJson = False,
) -> None:
    """Compile the C for MODEL and compare it with the NumPy reference; status 1 if it does not pass."""
    system = load(model, floating_base=floating_base)
    with progress() as report:
        result = compiler.compare(system, states=states, seed=seed, progress=report)
    typer.echo(json.dumps(result.as_dict(), indent=2) if as_json else str(result))
    if not result.passed:
        raise typer.Exit(FAILED)


@app.command()
def equations(
    model: Model,
    format_: Annotated[
        str, typer.Option("--format", metavar="FORMAT", help=f"One of {', '.join(FORMATS)}.")
    ] = "text",
    floating_base: FloatingBase = False,
) -> None:
    """Print the equations of motion of MODEL: in closed form for a small tree, else by definitions."""
    system = load(model, floating_base=floating_base)
    with progress() as report:
        derived = compiler.derive(system, progress=report)
        report("printing")
        text = render(derived, format_)
    typer.echo(text, nl=False)


@app.command()
def info(model: Model, floating_base: FloatingBase = False, as_json: AsJson = False) -> None:
    """Show the tree of MODEL, its freedoms and parameters, and what its equations cost."""
    system = load(model, floating_base=floating_base)
    with progress() as report:
        facts = information.gather(system, report)
    if as_json:
        typer.echo(json.dumps(facts.as_dict(), indent=2))
    else:
        information.show(facts, screen)


def main() -> None:
    """Entry point: errors of kanegen become one line and status 2."""
    show_warnings()
    try:
        app()
    except KanegenError as error:
        fail(error)
