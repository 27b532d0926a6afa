"""The commands and their options."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from kanegen import bench as benchmark
from kanegen import compiler
from kanegen import variant as variants
from kanegen.anchors import anchors
from kanegen.bench.optional import BENCH, module, require
from kanegen.bench.peers.field import PEERS
from kanegen.bench.plot import svg
from kanegen.bench.record import record
from kanegen.c.anchors import with_anchors
from kanegen.cli import bench as benchmark_table
from kanegen.cli import explain as explanation
from kanegen.cli.drawing import show as draw
from kanegen.cli.facts import gather
from kanegen.cli.given import has_budget
from kanegen.cli.options import (
    AsJson,
    Attempts,
    Confidence,
    Coordinates,
    Domain,
    ErrorBudget,
    FloatingBase,
    JsonFile,
    Model,
    Numbers,
    Objective,
    Outputs,
    Plot,
    Poses,
    Quantile,
    Reactions,
    Reanchoring,
    Reproducible,
    RightAngles,
    Search,
    Seed,
    SelectStates,
    Speeds,
    Stored,
    Tier,
    TimeBudget,
    Waves,
    Without,
)
from kanegen.cli.reported import reporting
from kanegen.cli.right_angles import Angles
from kanegen.cli.terminal import FAILED, fail, progress, screen, show_warnings, unheard
from kanegen.errors import KanegenError, OptionError
from kanegen.files import require_writable, write_whole
from kanegen.printing import FORMATS, render
from kanegen.readers import load
from kanegen.receipt import exactness, page, receipt
from kanegen.receipt.markdown import markdown as in_markdown
from kanegen.right_angles import AS_WRITTEN, TYPED
from kanegen.signature import EQUATIONS
from kanegen.study import EXTRA as STUDY
from kanegen.study import NEEDS
from kanegen.system import System
from kanegen.version import __version__

app = typer.Typer(
    name="kanegen",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="markdown",
    help="Kane's equations of motion [A]{ydot} = {f} for a tree of rigid bodies, as C made for that tree.",
    epilog="Exit status: 0 done, 1 a check did not pass, 2 bad input.",
)


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
def generate(  # noqa: PLR0913  (an argument for every option)
    context: typer.Context,
    *,
    model: Model,
    output_dir: Annotated[
        Path, typer.Option("--output-dir", "-o", help="Folder for the files; made if absent.")
    ],
    output: Outputs = list(EQUATIONS),  # noqa: B006  (typer reads the default, nobody changes it)
    poses: Poses = None,
    reactions: Reactions = None,
    floating_base: FloatingBase = False,
    right_angles: RightAngles = AS_WRITTEN,
    force: Annotated[
        bool, typer.Option("--force", help="Write also where the folder holds files of another origin.")
    ] = False,
    without: Without = None,
    precision: Numbers = None,
    storage: Stored = None,
    sincos: Waves = None,
    tier: Tier = "strict",
    error: ErrorBudget = None,
    budget: TimeBudget = None,
    domain: Domain = None,
    objective: Objective = "latency",
    quantile: Quantile = "max",
    confidence: Confidence = 0.95,
    attempts: Attempts = 2,
    states: SelectStates = 512,
    search: Search = 512,
    reproducible: Reproducible = False,
    seed: Seed = 0,
    speeds: Speeds = None,
    coordinates: Coordinates = None,
    reanchoring: Reanchoring = False,
) -> None:
    """Write the C for MODEL: header, source, example, CMake and pkg-config files, README.

    With --error the fastest variant of forward dynamics whose error stays below a budget, with --budget the
    most accurate one whose time does: all are measured on this machine, the chosen one is validated in fresh
    states and searched for counterexamples, and a certificate says what was found. This takes minutes, and
    `pip install 'kanegen[study]'`.
    """
    chosen = has_budget(context)
    loaded = _loaded(model, floating_base, right_angles, speeds, coordinates)
    system = reporting(loaded, output, poses, reactions)
    wanted = anchors(system) if reanchoring else ()
    if chosen:
        command = module("kanegen.cli.budget", *NEEDS, extra=STUDY)
        terms = command.Terms(
            error=error,
            budget=budget,
            domain=domain,
            objective=objective,
            quantile=quantile,
            confidence=confidence,
            attempts=attempts,
            states=states,
            search=search,
            reproducible=reproducible,
            precision=precision,
            seed=seed,
        )
        with progress() as report:
            found = command.generate(system, terms, output_dir, force, report)
        command.show(found, screen)
        source = found.source
    else:
        with progress() as report:
            variant = variants.chosen(
                tier, precision=precision, without=without, storage=storage, sincos=sincos
            )
            source = compiler.generate(system, outputs=output, progress=report, tier=variant)
    source = with_anchors(source, wanted) if wanted else source
    source.write(output_dir, force=force)
    cost = ", ".join(f"{kind} {number}" for kind, number in source.operations.items())
    screen.print(f"{system.name}: {len(system.freedoms)} freedoms, {' and '.join(source.outputs)}")
    screen.print(f"operations: {cost}")
    screen.print(f"wrote {', '.join(source.files)} to {output_dir}", soft_wrap=True)


@app.command()
def verify(
    certificate: Annotated[
        Path, typer.Argument(metavar="CERTIFICATE", help="The .json beside the C.", show_default=False)
    ],
    model: Annotated[
        Path | None, typer.Option("--model", metavar="MODEL", help="What it should be of, .toml or .urdf.")
    ] = None,
    states: Annotated[
        int | None, typer.Option(min=1, help="Fresh states; by default as many as it was validated by.")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of the fresh states.")] = 1,
    floating_base: FloatingBase = False,
    right_angles: RightAngles = AS_WRITTEN,
    speeds: Speeds = None,
    coordinates: Coordinates = None,
) -> None:
    """Make and measure anew what a CERTIFICATE of `generate` says; status 1 if something does not hold.

    Generates and compiles the variant, compares the C, its results and its worst states, and measures its
    error in states of its own. Times are not measured again. Needs `pip install 'kanegen[study]'`.
    """
    command = module("kanegen.cli.budget", *NEEDS, extra=STUDY)
    system = None if model is None else _loaded(model, floating_base, right_angles, speeds, coordinates)
    with progress() as report:
        found = command.verify(certificate, system, states, seed, report)
    command.show_verification(certificate, found, screen)
    if not found.passed:
        raise typer.Exit(FAILED)


@app.command()
def check(
    model: Model,
    states: Annotated[int, typer.Option(min=1, help="Number of random states.")] = 1000,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random states.")] = 0,
    floating_base: FloatingBase = False,
    right_angles: RightAngles = AS_WRITTEN,
    precision: Numbers = None,
    storage: Stored = None,
    sincos: Waves = None,
    tier: Tier = "strict",
    speeds: Speeds = None,
    coordinates: Coordinates = None,
    as_json: AsJson = False,
) -> None:
    """Compile the C for MODEL and compare it with the NumPy reference; status 1 if it does not pass."""
    system = _loaded(model, floating_base, right_angles, speeds, coordinates)
    with progress() as report:
        variant = variants.chosen(tier, precision=precision, storage=storage, sincos=sincos)
        result = compiler.compare(system, states=states, seed=seed, progress=report, tier=variant)
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
    right_angles: RightAngles = AS_WRITTEN,
    speeds: Speeds = None,
    coordinates: Coordinates = None,
) -> None:
    """Print the equations of motion of MODEL: in closed form for a small tree, else by definitions."""
    system = _loaded(model, floating_base, right_angles, speeds, coordinates)
    with progress() as report:
        derived = compiler.derive(system, progress=report)
        report("printing")
        text = render(derived, format_)
    typer.echo(text, nl=False)


@app.command()
def info(
    model: Model,
    floating_base: FloatingBase = False,
    right_angles: RightAngles = AS_WRITTEN,
    without: Without = None,
    speeds: Speeds = None,
    coordinates: Coordinates = None,
    as_json: AsJson = False,
) -> None:
    """Show the tree of MODEL, its freedoms and parameters, and what its equations cost."""
    system = _loaded(model, floating_base, right_angles, speeds, coordinates)
    tolerance = right_angles or TYPED
    with unheard():
        written, exact = (
            _loaded(model, floating_base, limit, speeds, coordinates) for limit in (AS_WRITTEN, tolerance)
        )
    with progress() as report:
        found = exactness(written, exact, report)
        angles = Angles(tolerance, bool(right_angles), found) if found else None
        facts = gather(system, report, without, angles)
    if as_json:
        typer.echo(json.dumps(facts.as_dict(), indent=2))
    else:
        draw(facts, screen)


@app.command()
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
    loaded = _loaded(model, floating_base, right_angles, speeds, coordinates)
    system = reporting(loaded, output, poses, reactions)
    with progress() as report:
        found = receipt(system, output, compile_, report)
    if as_json:
        typer.echo(json.dumps(found.as_dict(), indent=2))
    else:
        explanation.show(found, screen)
    if html is not None:
        write_whole(html, page.html(found))
    if markdown is not None:
        write_whole(markdown, in_markdown(found))


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
    json_: JsonFile = None,
    plot: Plot = None,
    floating_base: FloatingBase = False,
    right_angles: RightAngles = AS_WRITTEN,
) -> None:
    """Time the C for MODEL beside Pinocchio, CasADi, MuJoCo, SymPy + PyDy; status 1 if results differ.

    Everybody computes the same states and must agree before the times are taken, in turns. The peers come
    from `pip install 'kanegen[bench]'`; who is missing is named and left out. Loads are switched off and
    run-time parameters become constants. The first time, compiling Pinocchio takes minutes.
    """
    _require_plot(plot)
    require_writable(json_, plot)
    terms = benchmark.Terms(states, rounds, seconds)
    system = load(model, floating_base, right_angles)
    with progress() as report:
        outcome = benchmark.compete(system, terms, report, peer)
    benchmark_table.show(outcome, terms, screen)
    if json_ is not None:
        write_whole(json_, record([outcome], terms))
    if plot is not None:
        write_whole(plot, svg([outcome]))
    if not outcome.agrees:
        raise typer.Exit(FAILED)


@app.command()
def tradeoff(
    model: Model,
    states: Annotated[int, typer.Option(min=1, help="Random states of every sample.")] = 256,
    search: Annotated[int, typer.Option(min=0, help="States tried to find the largest error.")] = 64,
    rounds: Annotated[int, typer.Option(min=1, help="Rounds, in each of which all have one turn.")] = 7,
    seconds: Annotated[float, typer.Option(min=0.0, help="Of every way to call in every turn.")] = 0.02,
    seed: Annotated[int, typer.Option(min=0, help="Of all samples.")] = 0,
    quantile: Annotated[
        str, typer.Option(metavar="NAME", help="The error that counts: max, p99 or median.")
    ] = "max",
    objective: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Show one table only: latency or batch; repeatable."),
    ] = None,
    output_dir: Annotated[
        Path | None,
        typer.Option("--output-dir", "-o", help="Folder for tradeoff.md, .csv, .json and .svg."),
    ] = None,
    simulation: Annotated[
        bool, typer.Option("--simulation", help="Integrate a motion with the best variants, too.")
    ] = False,
    json_: JsonFile = None,
    plot: Plot = None,
    floating_base: FloatingBase = False,
    right_angles: RightAngles = AS_WRITTEN,
) -> None:
    """Speed against accuracy of MODEL: every variant measured; status 1 if one computes something wrong.

    Errors are against certified truth, in random and in hard states; times are taken in turns. What none
    beats in both is the front, measured again in fresh states. Loads are switched off and run-time parameters
    become constants. Needs `pip install 'kanegen[study]'`.
    """
    _require_plot(plot, STUDY)
    command = module("kanegen.cli.tradeoff", *NEEDS, extra=STUDY)
    system = load(model, floating_base, right_angles)
    outputs = command.Outputs.chosen(output_dir, json_, plot, simulation)
    terms = {"states": states, "search": search, "rounds": rounds, "seconds": seconds, "seed": seed}
    with progress() as report:
        wanted = command.Terms(**terms, quantile=quantile)
        found = command.run(system, wanted, objective, simulation, report)
    outputs.write(found)
    command.show(found, objective, screen)
    if any(entry.wrong for entry in found.entries):
        raise typer.Exit(FAILED)


def _loaded(
    model: Path, floating_base: bool, right_angles: float, speeds: str | None, coordinates: str | None
) -> System:
    """The system of a model file, with other speeds and coordinates if so wished."""
    return compiler.described(load(model, floating_base, right_angles), speeds, coordinates)


def _require_plot(path: Path | None, extra: str = BENCH) -> None:
    """Say at once what would only fail minutes later."""
    if path is not None:
        if path.suffix != ".svg":
            raise OptionError(f"--plot: {path} does not end in .svg.")
        require("matplotlib", extra)


def main() -> None:
    """Entry point: errors of kanegen become one line and status 2."""
    show_warnings()
    try:
        app()
    except KanegenError as error:
        fail(error)
