"""The commands and their options."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from kanegen import bench as benchmark
from kanegen import compiler
from kanegen.bench.optional import require
from kanegen.bench.peers.field import PEERS
from kanegen.bench.plot import svg
from kanegen.bench.record import record
from kanegen.cli import bench as benchmark_table
from kanegen.cli import info as information
from kanegen.cli.terminal import FAILED, fail, progress, screen, show_warnings
from kanegen.errors import KanegenError, OptionError
from kanegen.files import write_whole
from kanegen.precision import PRECISIONS
from kanegen.printing import FORMATS, render
from kanegen.program.passes import NAMES
from kanegen.readers import load
from kanegen.signature import EQUATIONS, OUTPUTS
from kanegen.variant import TIERS
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
Without = Annotated[
    list[str] | None,
    typer.Option("--without", metavar="PASS", help=f"Leave a pass out, repeatable: {', '.join(NAMES)}."),
]
Numbers = Annotated[
    str | None,
    typer.Option("--precision", metavar="NAME", help=f"Type of numbers in C: {' or '.join(PRECISIONS)}."),
]
Tier = Annotated[
    str, typer.Option("--tier", metavar="NAME", help=f"Speed against accuracy: {' or '.join(TIERS)}.")
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
    without: Without = None,
    precision: Numbers = None,
    tier: Tier = "strict",
) -> None:
    """Write the C for MODEL: header, source, example, CMake and pkg-config files, README."""
    system = load(model, floating_base=floating_base)
    with progress() as report:
        source = compiler.generate(
            system, outputs=output, progress=report, without=without, precision=precision, tier=tier
        )
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
    precision: Numbers = None,
    tier: Tier = "strict",
    as_json: AsJson = False,
) -> None:
    """Compile the C for MODEL and compare it with the NumPy reference; status 1 if it does not pass."""
    system = load(model, floating_base=floating_base)
    with progress() as report:
        result = compiler.compare(
            system, states=states, seed=seed, progress=report, precision=precision, tier=tier
        )
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
def info(
    model: Model,
    floating_base: FloatingBase = False,
    without: Without = None,
    as_json: AsJson = False,
) -> None:
    """Show the tree of MODEL, its freedoms and parameters, and what its equations cost."""
    system = load(model, floating_base=floating_base)
    with progress() as report:
        facts = information.gather(system, report, without)
    if as_json:
        typer.echo(json.dumps(facts.as_dict(), indent=2))
    else:
        information.show(facts, screen)


@app.command()
def bench(
    model: Model,
    rounds: Annotated[int, typer.Option(min=1, help="Rounds, in each of which everybody has one turn.")] = 9,
    seconds: Annotated[float, typer.Option(min=0.0, help="Of every task in every round.")] = 0.05,
    states: Annotated[int, typer.Option(min=1, help="Number of random states.")] = 256,
    peer: Annotated[
        list[str],
        typer.Option(metavar="NAME", help=f"Beside kanegen, repeatable: {', '.join(PEERS)}."),
    ] = list(PEERS),  # noqa: B006  (as for Outputs)
    json_: Annotated[
        Path | None,
        typer.Option("--json", metavar="FILE", help="Write every number and the machine as JSON."),
    ] = None,
    plot: Annotated[
        Path | None, typer.Option("--plot", metavar="FILE.svg", help="Draw the times as SVG.")
    ] = None,
    floating_base: FloatingBase = False,
) -> None:
    """Time the C for MODEL beside Pinocchio, CasADi, MuJoCo, SymPy + PyDy; status 1 if results differ.

    Everybody computes the same states and must agree before the times are taken, in turns. The peers come
    from `pip install 'kanegen[bench]'`; who is missing is named and left out. Loads are switched off and
    run-time parameters become constants. The first time, compiling Pinocchio takes minutes.
    """
    if plot is not None:
        _require_plot(plot)
    terms = benchmark.Terms(states, rounds, seconds)
    system = load(model, floating_base=floating_base)
    with progress() as report:
        outcome = benchmark.compete(system, terms, report, peer)
    benchmark_table.show(outcome, terms, screen)
    if json_ is not None:
        write_whole(json_, record([outcome], terms))
    if plot is not None:
        write_whole(plot, svg([outcome]))
    if not outcome.agrees:
        raise typer.Exit(FAILED)


def _require_plot(path: Path) -> None:
    """Say at once what would only fail minutes later."""
    if path.suffix != ".svg":
        raise OptionError(f"--plot: {path} does not end in .svg.")
    require("matplotlib")


def main() -> None:
    """Entry point: errors of kanegen become one line and status 2."""
    show_warnings()
    try:
        app()
    except KanegenError as error:
        fail(error)
