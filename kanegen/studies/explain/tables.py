"""A cost report as the rows of its tables, and as a page of Markdown."""

from __future__ import annotations

from collections.abc import Sequence

from kanegen.model import quoting
from kanegen.studies.explain.report import ALL_BODIES, CostReport, Step
from kanegen.studies.markdown import markdown_table

HEADS = ("without", "operations", "once", "freedoms", "parameters", "inputs", "C, KiB", "compiling, s")
"""Heads of the columns of the table of steps; the last one only if the C was compiled."""


def heads(report: CostReport) -> list[str]:
    """Return the heads of the table of steps."""
    return list(HEADS if report.steps[0].seconds is not None else HEADS[:-1])


def rows(report: CostReport) -> list[list[str]]:
    """Return one row for each step, the general program first."""
    return [_row(step, len(heads(report))) for step in report.steps]


def bodies(report: CostReport) -> list[tuple[str, str]]:
    """Return number, name and operations of each body, the one with most operations first."""
    names = {ALL_BODIES: "all bodies"}
    names |= {k: f"{k} {body.name}" for k, body in enumerate(report.system.bodies, start=1)}
    costs = sorted(report.bodies.items(), key=lambda item: -item[1])
    return [(names[k], str(operations)) for k, operations in costs if operations]


def outputs(report: CostReport) -> list[tuple[str, str]]:
    """Return the operations of each output by itself; no rows if there is one output only."""
    alone = report.alone if len(report.alone) > 1 else {}
    return [(name, str(operations)) for name, operations in alone.items()]


def markdown(report: CostReport, paragraphs: Sequence[str] = ()) -> str:
    """Return the page; the same model gives the same bytes unless its C was compiled and timed.

    Args:
        report: The cost report.
        paragraphs: Paragraphs about the model, in Markdown, below the title.
    """
    system, first, last = report.system, report.steps[0], report.steps[-1]
    freedoms = ", ".join(map(quoting.markdown_code, system.freedom_names))
    parts = [
        f"# {quoting.markdown(system.name)}",
        *paragraphs,
        f"Bodies: {system.number_of_bodies}. Freedoms: {last.freedoms}, {freedoms}. Outputs: "
        f"{', '.join(report.outputs)}.",
        "## What the scene does without",
        f"**{last.total} operations** where the general program of the same tree takes {first.total}: "
        f"1/{report.ratio:.1f}. One choice after the other:",
        markdown_table(heads(report), rows(report)),
        "*once*: operations that depend on parameters alone. *inputs*: numbers that an evaluation reads.",
        "## Where the operations go",
        markdown_table(["body", "operations"], bodies(report)),
    ]
    if alone := outputs(report):
        parts += ["## Each output by itself", markdown_table(["output", "operations"], alone)]
    return "\n\n".join(parts) + "\n"


def _row(step: Step, width: int) -> list[str]:
    """Return the row of one step, with `width` cells."""
    numbers = (step.total, step.operations["prepare"], step.freedoms, step.parameters, step.inputs)
    size = f"{step.bytes / 1024:.1f}"
    time = "" if step.seconds is None else f"{step.seconds:.2f}"
    return [step.without, *map(str, numbers), size, time][:width]
