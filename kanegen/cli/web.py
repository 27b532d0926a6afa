"""`kanegen web`: a page that computes motions of a model in the browser, by the generated C itself."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from kanegen.cli.loading import load_system
from kanegen.cli.options import (
    AS_WRITTEN,
    Coordinates,
    FloatingBase,
    JointDynamics,
    Lock,
    Model,
    Page,
    RightAngles,
    Speeds,
)
from kanegen.cli.state_options import X, Y, numbers_by_name
from kanegen.cli.terminal import print_plain, progress


def web(
    model: Model,
    output: Page = None,
    x: X = None,
    y: Y = None,
    step: Annotated[float, typer.Option("--step", metavar="SECONDS", help="Length of a step, s.")] = 1e-3,
    method: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="Method of the steps: euler, semi_implicit_euler, rk4, implicit_midpoint, "
            "variational_midpoint or linearly_implicit.",
        ),
    ] = "rk4",
    open_: Annotated[bool, typer.Option("--open", help="Show the page in the browser.")] = False,
    floating_base: FloatingBase = False,
    joint_dynamics: JointDynamics = False,
    right_angles: RightAngles = AS_WRITTEN,
    speeds: Speeds = None,
    coordinates: Coordinates = None,
    lock: Lock = None,
) -> None:
    """Write a page in which the C of MODEL, compiled to WebAssembly, moves the mechanism.

    Double precision, single precision and coarse sines run side by side, with the error of each beside
    double-double arithmetic and its evaluations a second, and sliders for parameters and for the start. The
    page needs neither a network nor a server. To write it takes clang with lld, or `pip install ziglang`.

    Without --x and --y the joints begin away from their neutral position.
    """
    from kanegen.browser.web import web as page
    from kanegen.files import require_writable
    from kanegen.model.numbers import value_of

    system = load_system(model, floating_base, right_angles, speeds, coordinates, lock, joint_dynamics)
    pairs = (("--x", x), ("--y", y))
    values = [numbers_by_name(option, texts, system) for option, texts in pairs]
    state = [{name: value_of(number) for name, number in part.items()} or None for part in values]
    file = output or Path(f"{system.identifier}.html")
    require_writable(file)
    with progress() as report:
        page(system, *state, step=step, method=method, progress=report).save(file)
    print_plain(f"wrote {file}")
    if open_:
        typer.launch(file.absolute().as_uri())
