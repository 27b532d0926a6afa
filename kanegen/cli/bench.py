"""`kanegen bench`: the table of a contest."""

from __future__ import annotations

from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from kanegen.bench import Outcome, Terms, table
from kanegen.bench.results import QUANTITIES


def show(outcome: Outcome, terms: Terms, console: Console) -> None:
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
