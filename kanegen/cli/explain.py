"""`kanegen explain`: a receipt on the terminal."""

from __future__ import annotations

from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from kanegen.receipt.costs import SYSTEM
from kanegen.receipt.receipt import Receipt
from kanegen.receipt.tables import heads, rows


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
    bodies = {SYSTEM: "all bodies"} | {k: b.name for k, b in enumerate(receipt.system.bodies, start=1)}
    costs = [
        [f"{k} {bodies[k]}" if k else bodies[k], str(number)]
        for k, number in sorted(receipt.bodies.items(), key=lambda item: -item[1])
        if number
    ]
    console.print("[bold]Where the operations go[/]")
    console.print(_table(["body", "operations"], costs))
    if len(receipt.alone) > 1:
        console.print("[bold]Each output by itself[/]")
        console.print(_table(["output", "operations"], [[k, str(v)] for k, v in receipt.alone.items()]))


def _table(head: list[str], lines: list[list[str]]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for place, title in enumerate(head):
        table.add_column(title, justify="right" if place else "left")
    for line in lines:
        table.add_row(*map(escape, line))
    return table
