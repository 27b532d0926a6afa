"""What `kanegen tradeoff` does with a study; imported only where the extra `study` is installed."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from kanegen.choices import require_one
from kanegen.files import make_folder, require_writable, write_whole
from kanegen.measure.timing import OBJECTIVES
from kanegen.model.system import System
from kanegen.studies.tradeoff import report, tables
from kanegen.studies.tradeoff.outcome import Study, StudyOptions
from kanegen.studies.tradeoff.plot import simulation_svg, tradeoff_svg
from kanegen.studies.tradeoff.report import json_record
from kanegen.studies.tradeoff.simulation import simulated
from kanegen.studies.tradeoff.study import study

__all__ = ["Outputs", "StudyOptions", "run", "show"]

_KINDS: dict[str, Callable[[Study], str]] = {
    ".md": report.markdown,
    ".csv": report.comma_separated,
    ".json": json_record,
    ".svg": tradeoff_svg,
}
"""What is written into a folder, by the ending of the file."""


@dataclass(frozen=True)
class Outputs:
    """Files that a study is written to, known to be writable, and what goes into each."""

    files: Mapping[Path, Callable[[Study], str]]

    @classmethod
    def chosen(cls, folder: Path | None, json: Path | None, plot: Path | None, simulation: bool) -> Outputs:
        """All kinds in a folder, which is made where it is missing, and single files.

        Raises:
            WriteError: If one cannot be written.
        """
        files: dict[Path, Callable[[Study], str]] = {}
        if folder is not None:
            make_folder(folder)
            files = {folder / f"tradeoff{ending}": text for ending, text in _KINDS.items()}
            if simulation:
                files[folder / "tradeoff-simulation.svg"] = simulation_svg
        files |= {file: _KINDS[kind] for file, kind in ((json, ".json"), (plot, ".svg")) if file is not None}
        require_writable(*files)
        return cls(files)

    def write(self, found: Study) -> None:
        """Every file whole."""
        for file, text in self.files.items():
            write_whole(file, text(found))


def run(
    system: System,
    terms: StudyOptions,
    objectives: Sequence[str] | None,
    simulation: bool,
    progress: Callable[[str], None],
) -> Study:
    """The study, with simulations if so wished, once the objectives are known to exist.

    Raises:
        OptionError: If one does not.
    """
    for name in objectives or ():
        require_one("objective", name, OBJECTIVES)
    found = study(system, terms, progress)
    return simulated(system, found, progress) if simulation else found


def show(found: Study, objectives: Sequence[str] | None, console: Console) -> None:
    """Print a study for people."""
    terms = found.terms
    console.print(
        f"[bold]{escape(found.model)}[/]: {found.n} freedoms, {len(found.entries)} variants, "
        f"{terms.states} random states, {terms.rounds} x {terms.seconds:g} s\n",
        soft_wrap=True,
    )
    for objective in objectives or OBJECTIVES:
        title = tables.TITLES[objective]
        console.print(f"[bold]All variants[/], {title}")
        console.print(_table(tables.SHORT, tables.short_rows(found, objective)))
        console.print(f"[bold]Front[/], {title}, measured again in fresh states and processes")
        console.print(_table(tables.FRESH, tables.fresh_rows(found, objective)))
    if found.runs:
        console.print(f"[bold]Simulation[/] of {found.duration:.3g} s: the least work for an error")
        console.print(_table(tables.SIMULATION, tables.simulation_rows(found), tables.SIMULATION_TEXTS))
    lines = [f"Refused: {refusal.label}: {refusal.reason}" for refusal in found.refusals]
    lines += [f"Note: {note}." for note in found.notes]
    for line in (*lines, *report.statements(found)):
        console.print(escape(line), soft_wrap=True)


def _table(head: Sequence[str], rows: Sequence[Sequence[str]], texts: int = 1) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for place, cells in enumerate(zip(head, *rows, strict=True)):
        longest = max(len(word) for cell in cells for word in cell.split(" "))  # lines break between words
        table.add_column(head[place], justify="left" if place < texts else "right", min_width=longest)
    for row in rows:
        table.add_row(*map(escape, row))
    return table
