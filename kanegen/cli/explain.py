"""`kanegen explain`: a receipt on the terminal."""

from __future__ import annotations

from collections.abc import Sequence

from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from kanegen.receipt.receipt import Receipt
from kanegen.receipt.tables import bodies, heads, outputs, rows


def show(receipt: Receipt, console: Console) -> None:
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
