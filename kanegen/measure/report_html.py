"""The comparison with the reference in a notebook: the verdict, the errors, and the worst states, folded."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from markupsafe import Markup

from kanegen.measure.evaluation import Evaluation
from kanegen.pictures.html import code, coloured, folded, python, sentence, shown, table


def report_html(
    title: str,
    passed: bool,
    rows: Iterable[Sequence[str]],
    notes: Iterable[str],
    worst: Iterable[tuple[str, Evaluation]],
) -> str:
    """Return the HTML of a report for a notebook.

    Args:
        title: Name of the system.
        passed: Whether every error is within its bound.
        rows: Cells of the table of errors; the last one of each is "ok" or "FAILED".
        notes: Sentences on the states and the bounds.
        worst: The worst entry of each output, by its name.
    """
    head = ("output", "error", "largest", "median", "bound", "")
    verdict = coloured("passed" if passed else "FAILED", passed)
    cells = [(*row[:-1], coloured(row[-1], row[-1] == "ok")) for row in rows]
    return shown(
        sentence("{}", verdict, strong=title),
        table(head, cells),
        *(sentence("{}", note) for note in notes),
        folded("Worst entries", *(_worst(output, one) for output, one in worst)),
        sentence("{} shows the errors of every entry.", python("report.plot()")),
    )


def _worst(output: str, one: Evaluation) -> Markup:
    """Return the worst entry of an output with its state as Python."""
    arrays = {"x": one.x, "y": one.y, "force": one.force, "torque": one.torque, **one.inputs}
    lines = [f"{name} = {value!r}" for name, value in arrays.items() if value is not None]
    said = sentence(
        "{}, entry {}, state {}: {} instead of {}",
        output,
        one.entry,
        one.state,
        repr(one.value),
        repr(one.reference),
    )
    return said + code("\n".join(lines))
