"""A receipt as a page of Markdown, for the documentation of a scene."""

from __future__ import annotations

from collections.abc import Sequence

from kanegen.studies.explain.receipt import Receipt
from kanegen.studies.explain.tables import bodies, heads, outputs, rows


def markdown(receipt: Receipt, words: Sequence[str] = ()) -> str:
    """The page; the same bytes for the same scene, unless times were taken.

    Args:
        receipt: It.
        words: Paragraphs about the scene, in Markdown, below the title.
    """
    system, first, last = receipt.system, receipt.steps[0], receipt.steps[-1]
    freedoms = ", ".join(f"`{name}`" for name in system.freedom_names)
    parts = [
        f"# {system.name}",
        *words,
        f"Bodies: {system.number_of_bodies}. Freedoms: {last.freedoms}, {freedoms}. Outputs: "
        f"{', '.join(receipt.outputs)}.",
        "## What the scene does without",
        f"**{last.total} operations** where the general program of the same tree takes {first.total}: "
        f"1/{receipt.ratio:.1f}. One choice after the other:",
        table(heads(receipt), rows(receipt)),
        "*once*: operations that depend on parameters alone. *inputs*: numbers that an evaluation reads.",
        "## Where the operations go",
        table(["body", "operations"], bodies(receipt)),
    ]
    if alone := outputs(receipt):
        parts += ["## Each output by itself", table(["output", "operations"], alone)]
    return "\n\n".join(parts) + "\n"


def table(head: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """A table whose first column is words and whose others are numbers."""
    rule = ["---", *["---:"] * (len(head) - 1)]
    return "\n".join(f"| {' | '.join(row)} |" for row in (head, rule, *lines))
