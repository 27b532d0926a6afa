"""`kanegen linearize`: the matrices of small deviations from a state, modes, stability, controllability."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated

import typer

from kanegen.choices import require_one
from kanegen.cli.loading import load_system, with_places
from kanegen.cli.options import (
    AS_WRITTEN,
    Coordinates,
    FloatingBase,
    JointDynamics,
    Lock,
    Model,
    Points,
    RightAngles,
    Speeds,
)
from kanegen.cli.state_options import Inputs, LinearOutputs, Tau, X, Y, numbers_by_name
from kanegen.cli.terminal import progress

if TYPE_CHECKING:
    from kanegen.model.numbers import Number
    from kanegen.model.system import System


def linearize(
    model: Model,
    x: X = None,
    y: Y = None,
    tau: Tau = None,
    inputs: Inputs = None,
    outputs: LinearOutputs = None,
    format_: Annotated[
        str,
        typer.Option(
            "--format",
            metavar="FORMAT",
            help="Form of the result: text, markdown, latex, json, python. Symbols: no json.",
        ),
    ] = "text",
    symbolic: Annotated[
        bool, typer.Option("--symbolic", help="Print the entries in symbols instead of numbers.")
    ] = False,
    floating_base: FloatingBase = False,
    joint_dynamics: JointDynamics = False,
    right_angles: RightAngles = AS_WRITTEN,
    speeds: Speeds = None,
    coordinates: Coordinates = None,
    lock: Lock = None,
    points: Points = None,
) -> None:
    """Linearize the equations of motion of MODEL about a state: d/dt xi = A xi + B u, eta = C xi + D u.

    The states xi are deviations of the coordinates and speeds, the inputs u those of generalized forces.
    Prescribed motions rest at zero. Numbers come with modes, stability and controllability.
    """
    system = load_system(model, floating_base, right_angles, speeds, coordinates, lock, joint_dynamics)
    system = with_places(system, points, None)
    pairs = (("--x", x), ("--y", y), ("--tau", tau))
    state = [numbers_by_name(option, given, system) for option, given in pairs]
    with progress() as report:
        write = _in_symbols if symbolic else _in_numbers
        text = write(system, state, inputs, outputs or [], format_, report)
    typer.echo(text, nl=False)


def _in_symbols(
    system: System,
    state: list[dict[str, Number]],
    inputs: list[str] | None,
    outputs: list[str],
    format_: str,
    report: Callable[[str], None],
) -> str:
    """Return the linear model with symbols in its entries."""
    from kanegen import compiler
    from kanegen.symbolic.printing import LINEAR_FORMATS, render_linear_model

    require_one("format", format_, LINEAR_FORMATS)
    equations = compiler.derive(system, progress=report)
    return render_linear_model(equations.linearize(*state, inputs=inputs, outputs=outputs), format_)


def _in_numbers(
    system: System,
    state: list[dict[str, Number]],
    inputs: list[str] | None,
    outputs: list[str],
    format_: str,
    report: Callable[[str], None],
) -> str:
    """Return the linear model in numbers, with modes, stability and controllability."""
    from kanegen import compiler
    from kanegen.linear.printing import FORMATS
    from kanegen.model.numbers import value_of

    require_one("format", format_, FORMATS)
    report("compiling")
    values = [{name: value_of(number) for name, number in part.items()} for part in state]
    return compiler.linearize(system, *values, inputs=inputs, outputs=outputs).render(format_)
