"""`kanegen tradeoff`: speed against accuracy of a model, every variant measured."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape

from kanegen.choices import require_one
from kanegen.cli.loading import load_system
from kanegen.cli.options import (
    AS_WRITTEN,
    FloatingBase,
    JointDynamics,
    JsonFile,
    Lock,
    Model,
    Plot,
    RightAngles,
    require_plot,
)
from kanegen.cli.terminal import FAILED, print_plain, print_table, progress, screen
from kanegen.errors import counted
from kanegen.extras import require
from kanegen.files import make_folder, require_writable, write_all
from kanegen.studies.tradeoff import EXTRA, NEEDS

if TYPE_CHECKING:
    from kanegen.studies.tradeoff.outcome import Study


def tradeoff(
    model: Model,
    quick: Annotated[
        bool,
        typer.Option("--quick", help="Measure only the usual winners, in fewer states: about a minute."),
    ] = False,
    states: Annotated[
        int | None, typer.Option(min=1, help="Number of random states of each sample (256; quick 64).")
    ] = None,
    search: Annotated[
        int | None,
        typer.Option(min=0, help="States tried in the search for the largest error (64; quick 0)."),
    ] = None,
    rounds: Annotated[
        int, typer.Option(min=1, help="Number of rounds; in each, every variant is timed once.")
    ] = 7,
    seconds: Annotated[float, typer.Option(min=0.0, help="Seconds of each timing of a variant.")] = 0.02,
    seed: Annotated[int, typer.Option(min=0, help="Seed of all samples.")] = 0,
    quantile: Annotated[
        str,
        typer.Option(metavar="NAME", help="Statistic of the errors that ranks variants: max, p99, median."),
    ] = "max",
    objective: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Show only this table (repeatable): latency, batch."),
    ] = None,
    output_dir: Annotated[
        Path | None,
        typer.Option("--output-dir", "-o", help="Folder for tradeoff.md, .csv, .json and .svg."),
    ] = None,
    simulation: Annotated[
        bool, typer.Option("--simulation", help="Also integrate a motion with the best variants.")
    ] = False,
    json_: JsonFile = None,
    plot: Plot = None,
    floating_base: FloatingBase = False,
    joint_dynamics: JointDynamics = False,
    right_angles: RightAngles = AS_WRITTEN,
    lock: Lock = None,
) -> None:
    """Measure the speed and the accuracy of every variant of the C for MODEL.

    The first lines say in words which variant to take and what it loses, measured from the default.
    Errors are measured against certified truth, in random states and in hard ones; variants are timed in
    turns. The variants that no other beats in both speed and accuracy form the Pareto front, which is
    measured again in fresh states. The exit status is 1 if a variant computes something wrong. Loads are
    switched off and run-time parameters become constants. Needs `pip install 'kanegen[study]'`.
    """
    require_plot(plot, EXTRA)
    for package in NEEDS:
        require(package, EXTRA)
    from kanegen.measure.timing import OBJECTIVES
    from kanegen.studies.tradeoff.outcome import QUICK_OPTIONS, StudyOptions
    from kanegen.studies.tradeoff.simulation import with_simulations
    from kanegen.studies.tradeoff.study import study
    from kanegen.studies.tradeoff.variants import QUICK, candidates

    system = load_system(model, floating_base, right_angles, lock=lock, joint_dynamics=joint_dynamics)
    files = _Files.chosen(output_dir, json_, plot, simulation)
    with progress(is_long=True) as show_stage:
        usual = QUICK_OPTIONS if quick else StudyOptions()
        options = replace(
            usual,
            states=usual.states if states is None else states,
            search=usual.search if search is None else search,
            rounds=rounds,
            seconds=seconds,
            seed=seed,
            quantile=quantile,
        )
        for name in objective or ():
            require_one("objective", name, OBJECTIVES)
        chosen = candidates(QUICK)[0] if quick else None
        found = study(system, options, show_stage, variants=chosen)
        if simulation:
            found = with_simulations(system, found, show_stage)
    files.write(found)
    _show(found, objective or OBJECTIVES)
    if any(entry.wrong for entry in found.results):
        raise typer.Exit(FAILED)


@dataclass(frozen=True)
class _Files:
    """The files into which a study is written, known to be writable, and the function that fills each."""

    writers: Mapping[Path, Callable[[Study], str]]

    @classmethod
    def chosen(cls, folder: Path | None, json: Path | None, plot: Path | None, simulation: bool) -> _Files:
        """Choose all kinds of files in `folder`, which is made if absent, and the single files.

        Raises:
            WriteError: If a file cannot be written.
        """
        from kanegen.studies.tradeoff import report
        from kanegen.studies.tradeoff.plot import simulation_svg, tradeoff_svg

        kinds: dict[str, Callable[[Study], str]] = {
            ".md": report.markdown,
            ".csv": report.comma_separated,
            ".json": report.json_record,
            ".svg": tradeoff_svg,
        }
        writers: dict[Path, Callable[[Study], str]] = {}
        if folder is not None:
            make_folder(folder)
            writers = {folder / f"tradeoff{ending}": text for ending, text in kinds.items()}
            if simulation:
                writers[folder / "tradeoff-simulation.svg"] = simulation_svg
        writers |= {path: kinds[kind] for path, kind in ((json, ".json"), (plot, ".svg")) if path is not None}
        require_writable(*writers)
        return cls(writers)

    def write(self, found: Study) -> None:
        """Write the study into every file."""
        write_all({path: text(found) for path, text in self.writers.items()})


def _show(found: Study, objectives: Sequence[str]) -> None:
    """Print what to take, then the tables and the other statements of a study."""
    from kanegen.studies.tradeoff import report, tables
    from kanegen.studies.tradeoff.recommendation import recommendations

    for line in recommendations(found, objectives):
        print_plain(line)
    terms = found.options
    screen.print(
        f"\n[bold]{escape(found.model)}[/]: {counted(found.n, 'freedom')}, "
        f"{counted(len(found.results), 'variant')}, "
        f"{terms.states} random states, {terms.rounds} x {terms.seconds:g} s\n",
        soft_wrap=True,
    )
    for objective in objectives:
        title = tables.TITLES[objective]
        _show_table(f"All variants, {title}", tables.SHORT, tables.short_rows(found, objective))
        others = tables.short_rows(found, objective, reformulated=True)
        if others:
            _show_table(f"Variants {tables.REFORMULATED}, {title}", tables.SHORT, others)
        again = f"Pareto front, {title}, measured again in fresh states and processes"
        _show_table(again, tables.FRESH, tables.fresh_rows(found, objective))
    if found.runs:
        screen.print(f"[bold]Simulation[/] of {found.duration:.3g} s: the least work for an error")
        print_table(tables.SIMULATION, tables.simulation_rows(found), tables.SIMULATION_TEXT_COLUMNS)
    lines = [f"Refused: {refusal.label}: {refusal.reason}" for refusal in found.refusals]
    lines += [f"Note: {note}." for note in found.notes]
    for line in (*lines, *report.statements(found)):
        print_plain(line)


def _show_table(title: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a table below its title."""
    screen.print(f"[bold]{escape(title)}[/]", soft_wrap=True)
    print_table(head, rows)
