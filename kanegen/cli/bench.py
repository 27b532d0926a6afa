"""`kanegen bench`: a contest with other libraries, and its table."""

from __future__ import annotations

from typing import Annotated

import typer
from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from kanegen.cli.options import FloatingBase, JsonFile, Model, Plot, RightAngles, require_plot
from kanegen.cli.terminal import FAILED, progress, screen
from kanegen.files import require_writable, write_whole
from kanegen.model.right_angles import AS_WRITTEN
from kanegen.readers import load
from kanegen.studies.bench import BenchOptions, Outcome, compete, table
from kanegen.studies.bench.peers.field import PEERS
from kanegen.studies.bench.plot import svg
from kanegen.studies.bench.record import record
from kanegen.studies.bench.results import QUANTITIES


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
    require_plot(plot)
    require_writable(json_, plot)
    terms = BenchOptions(states, rounds, seconds)
    system = load(model, floating_base, right_angles)
    with progress() as report:
        outcome = compete(system, terms, report, peer)
    _show(outcome, terms, screen)
    if json_ is not None:
        write_whole(json_, record([outcome], terms))
    if plot is not None:
        write_whole(plot, svg([outcome]))
    if not outcome.agrees:
        raise typer.Exit(FAILED)


def _show(outcome: Outcome, terms: BenchOptions, console: Console) -> None:
    """Print the outcome for people."""
    console.print(
        f"[bold]{outcome.model}[/]: {outcome.n} freedoms, {terms.states} random states, "
        f"{terms.rounds} x {terms.seconds:g} s a task\n",
        soft_wrap=True,
    )
    for quantity in QUANTITIES:
        console.print(_table(outcome, quantity))
    overheads = [f"{title} {table.ns(value)} ns" for title, value in table.overheads(outcome).items()]
    if overheads:
        console.print(f"A call from Python takes beyond the C: {', '.join(overheads)}.", soft_wrap=True)
    for line in (*table.notes(outcome), *table.left_out(outcome)):
        console.print(escape(line), soft_wrap=True)


def _table(outcome: Outcome, quantity: str) -> Table:
    head, rows = table.head(outcome, quantity), table.rows(outcome, quantity)
    result = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for place, cells in enumerate(zip(head, *rows, strict=True)):
        longest = max(len(word) for cell in cells for word in cell.split(" "))  # lines break between words
        result.add_column(head[place], justify="left" if place < table.TEXTS else "right", min_width=longest)
    for row in rows:
        result.add_row(*map(escape, row))
    return result
