"""`kanegen sweep`: a job for all values of some axes, as a file describes it."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn

from kanegen.cli.options import AsJson
from kanegen.cli.terminal import errors, notices, print_plain, print_table
from kanegen.errors import KanegenError, counted

if TYPE_CHECKING:
    from kanegen.sweeps.results import SweepResult
    from kanegen.sweeps.running import Progress as Done

MOST_ROWS = 12
"""Largest number of results, and of reasons, that are printed."""

FIRST_LINE, LAST_LINE = 5.0, 60.0
"""Least and largest time in s between two lines of progress where there is no terminal."""


def sweep(
    file: Annotated[
        Path,
        typer.Argument(metavar="SWEEP.toml", help="The file that describes the sweep.", show_default=False),
    ],
    output_dir: Annotated[
        Path | None,
        typer.Option(
            "--output-dir",
            "-o",
            metavar="DIR",
            help="Folder for the results; by default that of the file, else SWEEP-results.",
            show_default=False,
        ),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            "--workers", min=1, help="Number of threads; by default one a processor.", show_default=False
        ),
    ] = None,
    executor: Annotated[
        str | None,
        typer.Option(
            "--executor",
            metavar="ADDRESS",
            help="Scheduler of a Dask cluster, such as tcp://10.0.0.1:8786, or mpi for the processes of "
            "`mpiexec -n N python -m mpi4py.futures -m kanegen sweep`.",
            show_default=False,
        ),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Compute the job of SWEEP.toml for all combinations of parameters, initial states, inputs and variants.

    Results appear in the folder chunk by chunk. After Ctrl-C, or whatever ended it, the same command goes on
    where it was. docs/sweep.md describes the file. Needs `pip install 'kanegen[sweep]'`, for a cluster
    `'kanegen[dask]'`.
    """
    from kanegen.sweeps import sweep as computed
    from kanegen.sweeps.sweep_file import read_sweep_file

    asked = read_sweep_file(file)
    folder = output_dir or asked.folder
    with _bar() as report:
        try:
            found = computed.sweep(
                asked.system,
                asked.axes,
                asked.job,
                executor,
                samples=asked.samples,
                folder=folder,
                format=asked.format,
                workers=workers,
                chunk_rows=asked.chunk_rows,
                progress=report,
            )
        except KeyboardInterrupt:
            errors.print("The finished rows are kept. The same command goes on from there.")
            raise
        except KanegenError as error:
            raise type(error)(f"{file}: {error}") from None
    typer.echo(json.dumps(_summary(found), indent=2)) if as_json else _show(found)


@contextmanager
def _bar() -> Iterator[Callable[[Done], None]]:
    """Yield a function that shows how far a sweep is: in a bar on a terminal, else in lines for a log."""
    notices.release()
    if not errors.is_terminal:
        yield _lines()
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TextColumn("{task.fields[words]}"),
    )
    with Progress(*columns, console=errors, transient=True) as bar:
        task = bar.add_task("rows", total=None, words="")

        def report(done: Done) -> None:
            """Show rows, throughput, failures and the time left."""
            bar.update(task, total=done.total, completed=done.rows, words=_words(done))

        yield report


def _lines() -> Callable[[Done], None]:
    """Return a function that prints how far a sweep is, first after 5 s, in the end every minute."""
    last = 0.0

    def report(done: Done) -> None:
        """Print a line if the last one is old enough."""
        nonlocal last
        if done.seconds - last >= min(max(FIRST_LINE, done.seconds / 20), LAST_LINE):
            last = done.seconds
            errors.print(_words(done))

    return report


def _words(done: Done) -> str:
    """Return how far a sweep is, in words."""
    parts = [f"{done.rows} of {done.total}"]
    if done.new:
        parts.append(f"{done.rate:.3g} rows/s")
        minutes, seconds = divmod(round(done.seconds_left), 60)
        hours, minutes = divmod(minutes, 60)
        parts.append(f"{hours}:{minutes:02}:{seconds:02} left")
    if done.failed:
        parts.append(f"{done.failed} with a reason")
    return ", ".join(parts)


def _summary(found: SweepResult) -> dict[str, Any]:
    """Return what a sweep has found, as plain data."""
    reasons = found.reasons
    return {
        "name": found.name,
        "folder": str(found.folder),
        "rows": found.rows,
        "finished": found.finished,
        "with_reason": len(reasons),
        "reasons": [{"row": row, "reason": reasons[row]} for row in list(reasons)[:MOST_ROWS]],
        "results": found.summary(),
    }


def _show(found: SweepResult) -> None:
    """Print how many rows there are, the spread of the results, and the first reasons."""
    summary = _summary(found)
    print_plain(f"{found.name}: {counted(found.finished, 'row')} in {found.folder}")
    head = ("result", "unit", "least", "5 %", "median", "95 %", "greatest")
    rows = [
        (one["name"], one["unit"], *(f"{value:.6g}" for value in one["values"]))
        for one in summary["results"][:MOST_ROWS]
    ]
    if rows:
        print_table(head, rows, left=2)
    if more := len(summary["results"]) - len(rows):
        print_plain(f"{more} further results are in the folder.")
    if count := summary["with_reason"]:
        print_plain(f"{counted(count, 'row')} failed or may be inaccurate:")
    for one in summary["reasons"]:
        print_plain(f"  row {one['row']}: {one['reason']}")
