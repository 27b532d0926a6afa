"""`kanegen bench`: the C for a model timed beside other libraries, and the table of times."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape

from kanegen.cli.loading import load_system
from kanegen.cli.options import (
    AS_WRITTEN,
    FloatingBase,
    JointDynamics,
    Lock,
    Model,
    Plot,
    RightAngles,
    require_plot,
)
from kanegen.cli.terminal import FAILED, print_plain, print_table, progress, screen
from kanegen.errors import KanegenWarning, OptionError, counted
from kanegen.files import require_writable, write_all

if TYPE_CHECKING:
    from kanegen.studies.bench import BenchOptions, Comparison
    from kanegen.studies.bench.against import Verdict

DEFAULT_PEERS = ["pinocchio", "pinocchio-code", "casadi", "mujoco", "dynibo", "frax", "pydy"]
"""The peers that take part where the command line names none: all of them."""


def bench(
    model: Model,
    rounds: Annotated[
        int, typer.Option(min=1, help="Number of rounds; in each, every program is timed once.")
    ] = 9,
    seconds: Annotated[float, typer.Option(min=0.0, help="Seconds of each timing of a task.")] = 0.05,
    states: Annotated[int, typer.Option(min=1, help="Number of random states.")] = 256,
    peer: Annotated[
        list[str],
        typer.Option(
            metavar="NAME",
            help="Time this peer (repeatable): pinocchio, pinocchio-code, casadi, mujoco, dynibo, frax, "
            "pydy.",
        ),
    ] = DEFAULT_PEERS,
    output: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Time this output beside Pinocchio's function of the same quantity instead (repeatable): "
            "gravity_forces, velocity_forces, coriolis_matrix, mass_matrix_inverse, frame_jacobians, "
            "frame_bias_accelerations, centroidal_momentum_matrix, operational_inertia_inverse, regressor, "
            "contact_dynamics.",
        ),
    ] = None,
    save: Annotated[
        Path | None,
        typer.Option("--save", "--json", metavar="FILE", help="Save all numbers and the machine as JSON."),
    ] = None,
    against: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Compare with times that --save wrote, of at least 5 rounds; the exit status is 1 if a task "
            "of kanegen became slower.",
        ),
    ] = None,
    plot: Plot = None,
    floating_base: FloatingBase = False,
    joint_dynamics: JointDynamics = False,
    right_angles: RightAngles = AS_WRITTEN,
    lock: Lock = None,
) -> None:
    """Time the C for MODEL beside Pinocchio, CasADi, MuJoCo, dynibo, frax and SymPy with PyDy.

    All programs compute the same states; their results must agree before they are timed in turns, and the
    exit status is 1 if some do not. `pip install 'kanegen[bench]'` installs the peers; a missing one is named
    and left out. Loads are switched off and run-time parameters become constants. Compiling Pinocchio takes
    minutes the first time. With --output, frames are that of the body with the most bodies below it, and
    contact_dynamics holds its origin.

    With --against, each task of kanegen is compared by its ratio to a peer that both runs timed, and by its
    time if there is none; it is slower if the 99 % confidence interval of the change is above 1.02, and
    undecided if the interval reaches above 1.1 otherwise. Times of another machine or compiler are never
    compared. Among many tasks one that did not change may well come out as slower, since 99 % is not all:
    before you look for a cause, compare again, with more --rounds.

    The exit status is 0 if all results agree and no task is known to be slower, which undecided tasks leave
    open; 1 if results differ or a task became slower; and 2 after an error.
    """
    from kanegen.studies.bench import BenchOptions, compare
    from kanegen.studies.bench.against import LEAST_ROUNDS, compare_records, require_comparable
    from kanegen.studies.bench.outputs import compare_outputs
    from kanegen.studies.bench.plot import svg
    from kanegen.studies.bench.record import Record, read_record

    require_plot(plot)
    if output and plot is not None:
        raise OptionError("--plot shows [A] and {f}, {ydot} and its derivatives, not outputs. Leave it out.")
    require_writable(save, plot)
    options = BenchOptions(states, rounds, seconds)
    saved = None if against is None else read_record(against)
    system = load_system(model, floating_base, right_angles, lock=lock, joint_dynamics=joint_dynamics)
    if saved is not None and against is not None:
        require_comparable(saved, against, system.name, rounds)
    if save is not None and rounds < LEAST_ROUNDS:
        warnings.warn(
            f"--save: {counted(rounds, 'round')} will not do for --against, which needs {LEAST_ROUNDS}.",
            KanegenWarning,
            stacklevel=1,
        )
    with progress(is_long=True) as report:
        if output:
            comparison = compare_outputs(system, output, options, report)
        else:
            comparison = compare(system, options, report, peer)
    _show(comparison, options)
    record = Record.here([comparison], options)
    texts = {}
    if save is not None:
        texts[save] = record.text()
    if plot is not None:
        texts[plot] = svg([comparison])
    write_all(texts)
    failed = not comparison.agrees
    if saved is not None and against is not None:
        failed |= _show_changes(compare_records(record, saved, against))
    if failed:
        raise typer.Exit(FAILED)


def _show_changes(verdict: Verdict) -> bool:
    """Print the changes since a saved run, and return whether a task became slower."""
    from kanegen.studies.bench import table

    print_table(table.heads_of_changes(), [table.row_of_change(row) for row in verdict.rows], 5)
    for line in (*table.words_of_changes(verdict), *(f"{note}." for note in verdict.notes)):
        print_plain(line)
    return bool(verdict.slower)


def _show(comparison: Comparison, options: BenchOptions) -> None:
    """Print the tables and notes of a comparison."""
    from kanegen.studies.bench import table

    screen.print(
        f"[bold]{escape(comparison.model)}[/]: {counted(comparison.n, 'freedom')}, "
        f"{counted(options.states, 'random state')}, "
        f"{options.rounds} x {options.seconds:g} s a task\n",
        soft_wrap=True,
    )
    for quantity in comparison.quantities:
        print_table(table.head(comparison, quantity), table.rows(comparison, quantity), table.TEXT_COLUMNS)
    overheads = [f"{title} {table.ns(value)} ns" for title, value in table.overheads(comparison).items()]
    if overheads:
        screen.print(f"A call from Python takes beyond the C: {', '.join(overheads)}.", soft_wrap=True)
    lines = table.legend(comparison, options.rounds)
    for line in (*lines, *table.notes(comparison), *table.left_out(comparison)):
        print_plain(line)
