"""`kanegen view`: a picture of a model as one page that any browser shows, or as a live view."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kanegen.cli.loading import load_system, with_places
from kanegen.cli.options import (
    AS_WRITTEN,
    Coordinates,
    FloatingBase,
    JointDynamics,
    Lock,
    Model,
    Page,
    Points,
    RightAngles,
)
from kanegen.cli.state_options import X, Y, numbers_by_name
from kanegen.cli.terminal import print_plain, progress
from kanegen.errors import OptionError

if TYPE_CHECKING:
    from kanegen.model.system import System
    from kanegen.simulation.trajectory import Trajectory
    from kanegen.viewer.stored import StoredMotion
    from kanegen.viewer.view import View

FRAMES = 60
"""States a second that a page keeps of a motion."""

Values = Mapping[str, float]


def view(  # noqa: PLR0913  (an argument for every option)
    *,
    model: Model,
    output: Page = None,
    x: X = None,
    y: Y = None,
    duration: Annotated[
        float | None,
        typer.Option(
            "--duration",
            metavar="S",
            help="Simulate this many seconds from the state of --x and --y, and show the motion; without it "
            "the page has sliders.",
            show_default=False,
        ),
    ] = None,
    motion: Annotated[
        Path | None,
        typer.Option(
            "--motion",
            metavar="FILE",
            help="Show the motion in this .csv, .parquet or .npz file, as kanegen simulate --write makes it.",
            show_default=False,
        ),
    ] = None,
    step: Annotated[
        float, typer.Option("--step", metavar="S", help="Step of the simulation (s), by RK4.")
    ] = 1e-3,
    paths: Annotated[
        list[str] | None,
        typer.Option(
            "--path",
            metavar="NAME",
            help="Draw the path of this point, frame or body (repeatable); only for a motion.",
            show_default=False,
        ),
    ] = None,
    geometry: Annotated[
        Path | None,
        typer.Option(
            "--geometry",
            metavar="FILE",
            help="Take the shapes from this .urdf or .xml file, whose links are frames of MODEL.",
            show_default=False,
        ),
    ] = None,
    open_: Annotated[bool, typer.Option("--open", help="Show the page in the browser.")] = False,
    live: Annotated[
        bool,
        typer.Option("--live", help="Serve a live view on this machine until Ctrl-C, and write no file."),
    ] = False,
    port: Annotated[int, typer.Option("--port", metavar="PORT", help="Port of the live view.")] = 8080,
    floating_base: FloatingBase = False,
    joint_dynamics: JointDynamics = False,
    right_angles: RightAngles = AS_WRITTEN,
    coordinates: Coordinates = None,
    lock: Lock = None,
    points: Points = None,
) -> None:
    """Write a page that shows MODEL and moves it: by a simulation, or with a slider for every coordinate.

    The page needs neither a network nor a server. Bodies show the shapes of a URDF or MJCF file. Bodies
    without shapes are drawn as the uniform ellipsoids that have their mass and inertia, with their joints and
    the lines between them.
    """
    _check(output, live, duration, motion, y, paths)
    system = load_system(model, floating_base, right_angles, None, coordinates, lock, joint_dynamics)
    system = with_places(system, points, None)
    system = system if geometry is None else system.with_geometry(geometry)
    from kanegen.model.numbers import value_of

    state = [
        {name: value_of(number) for name, number in numbers_by_name(option, given, system).items()}
        for option, given in (("--x", x), ("--y", y))
    ]
    with progress() as report:
        found = _motion(system, state[0], state[1], duration, step, motion, report)
        report("drawing")
        picture = _picture(system, state[0], found, paths or [])
    if live:
        _serve(picture, port, open_)
        return
    file = output or Path(f"{system.identifier}.html")
    picture.save(file)
    print_plain(f"wrote {file}")
    if open_:
        _open(file.resolve().as_uri())


def _check(
    output: Path | None,
    live: bool,
    duration: float | None,
    motion: Path | None,
    y: list[str] | None,
    paths: list[str] | None,
) -> None:
    """Make sure, before any work, that the options fit each other and that the page can be written."""
    from kanegen.files import require_writable

    if live and output is not None:
        raise OptionError("--live writes no file. Leave --output out, or --live.")
    if duration is not None and motion is not None:
        raise OptionError("--duration simulates, --motion has been simulated. Leave one out.")
    if duration is None:
        for option, given in (("--y", y), ("--path", None if motion else paths)):
            if given:
                raise OptionError(f"{option}: only for a motion. Add --duration, or leave {option} out.")
    elif not 0 < duration < float("inf"):
        raise OptionError(f"--duration: {duration!r} is not a positive number of seconds.")
    require_writable(output)


def _motion(
    system: System,
    x: Values,
    y: Values,
    duration: float | None,
    step: float,
    file: Path | None,
    report: Callable[[str], None],
) -> Trajectory | StoredMotion | None:
    """Return the motion that is simulated or read; None for a picture with sliders."""
    if file is not None:
        from kanegen.viewer.stored import stored_motion

        return stored_motion(system, file)
    return None if duration is None else _simulated(system, x, y, duration, step, report)


def _picture(system: System, x: Values, motion: Trajectory | StoredMotion | None, paths: list[str]) -> View:
    """Return the picture of a system, with sliders or with a motion."""
    from kanegen.viewer.view import view as picture

    return picture(system, x=x) if motion is None else picture(system, motion, paths=paths)


def _simulated(
    system: System, x: Values, y: Values, duration: float, step: float, report: Callable[[str], None]
) -> Trajectory:
    """Return the motion of a system; prescribed freedoms rest at 0."""
    import numpy as np

    from kanegen.simulation import simulate

    report("simulating")
    still = np.zeros((3, len(system.prescribed)))
    outputs = ("kinetic_energy", "potential_energy")
    prescribed = (lambda _: still) if still.size else None
    options = {"step": step, "every": 1 / FRAMES, "outputs": outputs, "prescribed": prescribed}
    return simulate(system, x, y, duration, **options)  # type: ignore[arg-type]


def _serve(picture: View, port: int, open_: bool) -> None:
    """Serve a live view until it is interrupted."""
    with picture.live(port) as server:
        print_plain(f"serving {server.url} until Ctrl-C")
        if open_:
            _open(server.url)
        server.wait()


def _open(address: str) -> None:
    """Show an address in the browser of the user, or say that there is none."""
    import webbrowser

    if not webbrowser.open(address):
        print_plain(f"no browser was found here; open {address} in one")
