"""`kanegen simulate`: the motion of a model over time, its events, and files and pictures of it."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer
from rich.markup import escape

from kanegen.cli.loading import load_system, with_places, with_selection
from kanegen.cli.options import (
    AS_WRITTEN,
    AsJson,
    Coordinates,
    FloatingBase,
    Frames,
    JointDynamics,
    Lock,
    Model,
    Points,
    Reactions,
    RightAngles,
    Speeds,
    Tier,
)
from kanegen.cli.simulation_options import (
    Compensated,
    Duration,
    Every,
    FurtherOutputs,
    Hold,
    InputExpressions,
    InputTables,
    LargestError,
    LargestStep,
    MethodName,
    PageFile,
    PlotFile,
    RecordedEvents,
    ResultFiles,
    ShownColumns,
    TerminalEvents,
    Tolerance,
)
from kanegen.cli.state_options import X, Y, numbers_by_name
from kanegen.cli.terminal import (
    FAILED,
    INTERRUPTED,
    errors,
    fail,
    notices,
    print_plain,
    print_table,
    progress,
)
from kanegen.errors import KanegenError, OptionError, counted, quoted
from kanegen.extras import require
from kanegen.files import require_writable, write_all

if TYPE_CHECKING:
    from kanegen.library import Library
    from kanegen.model.system import System
    from kanegen.simulation import Trajectory

MOST_SHOWN = 12
"""Largest number of states and events that are printed."""


def simulate(  # noqa: PLR0913  (an argument for every option)
    *,
    model: Model,
    duration: Duration = None,
    every: Every = None,
    x: X = None,
    y: Y = None,
    inputs: InputExpressions = None,
    table: InputTables = None,
    hold: Hold = "zero",
    event: RecordedEvents = None,
    until: TerminalEvents = None,
    method: MethodName = None,
    step: LargestStep = None,
    tolerance: Tolerance = None,
    error: LargestError = None,
    compensated: Compensated = False,
    outputs: FurtherOutputs = None,
    files: ResultFiles = None,
    plot: PlotFile = None,
    view: PageFile = None,
    shown: ShownColumns = None,
    tier: Tier = "strict",
    frames: Frames = None,
    reactions: Reactions = None,
    points: Points = None,
    floating_base: FloatingBase = False,
    joint_dynamics: JointDynamics = False,
    right_angles: RightAngles = AS_WRITTEN,
    speeds: Speeds = None,
    coordinates: Coordinates = None,
    lock: Lock = None,
    as_json: AsJson = False,
) -> None:
    """Simulate the motion of MODEL from the state that --x and --y give, by names; the rest is neutral.

    Ctrl-C ends it: what was computed is written whole and printed, and the exit status is 130.
    """
    from kanegen.simulation import Event, library_for
    from kanegen.simulation import simulate as run
    from kanegen.simulation.elements import require_columns
    from kanegen.simulation.methods import TOLERANCE, Method, chosen_method
    from kanegen.viewer.view import view as picture

    duration = _duration(duration, until)
    _require_files(files or [], plot, view)
    asked = outputs or []
    system = load_system(model, floating_base, right_angles, speeds, coordinates, lock, joint_dynamics)
    system = with_selection(with_places(system, points, None), asked, frames, reactions)
    events = [*map(Event, event or ()), *(Event(text, terminal=True) for text in until or ())]
    x0, y0 = (_values(option, texts, system) for option, texts in (("--x", x), ("--y", y)))
    given = [_expressions(inputs or []), *(table or [])]
    columns = _columns(shown)
    groups = (name.partition(".")[0] for name in columns)
    named = dict.fromkeys([*asked, *(name for name in groups if name not in _STATES)])
    source: System | Library = system
    if error is not None and tier != "strict":
        raise OptionError("--tier: --error chooses the precision itself. Leave one of them out.")
    accuracy = error or tolerance or TOLERANCE
    if error is None or columns:
        chosen = chosen_method(method, step, tolerance, compensated) if error is None else Method("RK4")
        with progress() as report:
            library = library_for(system, events, list(named), chosen.name, tier, report)
        require_columns(library.source, columns, has_efforts=bool(inputs or table))
        source = library if error is None else system
    options: dict[str, Any] = {"every": every, "step": step, "tolerance": tolerance, "hold": hold}
    options |= {
        "error": error,
        "method": method,
        "compensated": compensated,
        "events": events,
        "outputs": list(named),
        "inputs": given,
    }
    try:
        with _bar(duration) as report_time:
            motion = run(source, x0, y0, duration, progress=report_time, **options)
    except (KanegenError, KeyboardInterrupt) as stopped:
        _finish_broken(stopped, files or [], plot, columns, as_json, accuracy)
    _write(motion, files or [], plot, columns)
    if view is not None:
        picture(system, motion).save(view)
    _print(motion, columns, as_json, accuracy)
    if until and not as_json and not any(one.terminal for one in motion.events):
        print_plain(f"no event of --until up to the end of the duration, t = {motion.times[-1]:.9g} s")
    if motion.promise is not None and not motion.promise.is_kept:
        raise typer.Exit(FAILED)


_STATES = ("t", "x", "y", "tau")
"""First parts of names of columns that are no outputs."""


def _duration(duration: float | None, until: list[str] | None) -> float:
    """Return the duration, which must be given also where an event ends the motion: it may not come."""
    if duration is None:
        hint = " The event of --until may not come; the duration is the longest." if until else ""
        raise OptionError(f"--duration: say how long to simulate, in s, such as --duration 10.{hint}")
    return duration


def _values(option: str, texts: list[str] | None, system: System) -> dict[str, float]:
    """Return values of coordinates or speeds by name."""
    from kanegen.model.numbers import value_of

    return {name: value_of(number) for name, number in numbers_by_name(option, texts, system).items()}


def _expressions(texts: Sequence[str]) -> dict[str, str]:
    """Return the expressions of inputs by name, from texts such as "pole=0.5*sin(t)"."""
    found: dict[str, str] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            raise OptionError(f"--input: {quoted(text)} is not NAME=EXPRESSION, such as pole=0.5*sin(t).")
        if name in found:
            raise OptionError(f"--input: {quoted(name)} is given twice. Give it once.")
        found[name] = value
    return found


def _columns(shown: list[str] | None) -> list[str]:
    """Return the names of columns, of which one option may hold several, separated by commas."""
    return [name.strip() for text in shown or () for name in text.split(",") if name.strip()]


def _require_files(files: Sequence[Path], plot: Path | None, view: Path | None) -> None:
    """Make sure, before the work, that all files can be written.

    Raises:
        OptionError: If a file has an end of which there is no format.
        MissingError: If a package of a format is not installed.
        WriteError: If a file cannot be written.
    """
    from kanegen.simulation.picture import EXTRA, FORMATS
    from kanegen.simulation.tables import writer

    for path in files:
        writer(path)
    if plot is not None:
        if plot.suffix not in FORMATS:
            raise OptionError(f"--plot: {plot} does not end in {', '.join(FORMATS)}.")
        require("matplotlib", EXTRA)
    if view is not None and view.suffix.lower() not in (".html", ".htm"):
        raise OptionError(f"--view: {view} does not end in .html.")
    require_writable(*files, plot, view)


@contextmanager
def _bar(duration: float) -> Iterator[Callable[[float], None]]:
    """Yield a function that shows the simulated time in a bar on a terminal, and nothing elsewhere."""
    if not errors.is_terminal:
        yield lambda time: None
        return
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    text = TextColumn("t = {task.completed:.4g} of {task.total:.4g} s")
    with Progress(BarColumn(), text, TimeRemainingColumn(), console=errors, transient=True) as bar:
        task = bar.add_task("", total=duration)
        yield lambda time: bar.update(task, completed=time)


def _finish_broken(
    stopped: KanegenError | KeyboardInterrupt,
    files: Sequence[Path],
    plot: Path | None,
    columns: list[str],
    as_json: bool,
    accuracy: float,
) -> None:
    """Write and print what was computed before a motion broke off, then end the command.

    Raises:
        KanegenError: The error itself, if nothing was computed.
    """
    motion: Trajectory | None = getattr(stopped, "trajectory", None)
    if motion is None:
        raise stopped
    if len(motion.times) > 1:
        _write(motion, files, plot, columns)
        _print(motion, columns, as_json, accuracy)
    written = f" {', '.join(map(str, files))} holds the motion up to then." if files else ""
    reached = f"t = {motion.times[-1]:.9g} s"
    if isinstance(stopped, KeyboardInterrupt):
        notices.release()
        errors.print(escape(f"the motion ends at {reached}.{written}"))
        sys.exit(INTERRUPTED)
    fail(type(stopped)(f"{stopped}{written if len(motion.times) > 1 else ''}"))


def _write(motion: Trajectory, files: Sequence[Path], plot: Path | None, columns: list[str]) -> None:
    """Write all files and the picture, all or none."""
    from kanegen.simulation.picture import picture_file

    contents: dict[Path, str | bytes] = {path: motion.content(path) for path in files}
    if plot is not None:
        contents[plot] = picture_file(motion.plot(columns or None), plot.suffix)
    write_all(contents)


def _print(motion: Trajectory, columns: list[str], as_json: bool, accuracy: float) -> None:
    """Print the motion: the method, its events, and columns at a few times.

    Times of events have as many digits as their accuracy, an error or a tolerance, lets them have.
    """
    names = columns or [name for name in motion.names if name[:2] in ("x.", "y.")]
    if as_json:
        typer.echo(json.dumps(motion.as_dict(names), indent=2))
        return
    print_plain(f"{motion.library.name}: {motion.caption}, {counted(motion.evaluations, 'evaluation')}")
    for line in str(motion.promise or "").splitlines():
        print_plain(line)
    digits = 1 + math.ceil(-math.log10(accuracy))
    for occurrence in motion.events[:MOST_SHOWN]:
        print_plain(f"event at t = {occurrence.time:.{digits}g} s: {occurrence.condition}")
    if len(motion.events) > MOST_SHOWN:
        print_plain(f"and {counted(len(motion.events) - MOST_SHOWN, 'further event')}")
    count = len(motion.times)
    rows = range(count) if count <= MOST_SHOWN else [round(k * (count - 1) / 10) for k in range(11)]
    values = [motion.output(name).reshape(count, -1)[:, 0] for name in names]
    head = ["t (s)", *(f"{name} ({motion.unit(name)})" for name in names)]
    print_table(head, [[f"{one[k] + 0.0:.6g}" for one in (motion.times, *values)] for k in rows], left=0)
