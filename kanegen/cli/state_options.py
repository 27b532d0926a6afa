"""Options for a state of a system: values of coordinates, speeds and generalized forces by name."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from kanegen.errors import ModelError, OptionError, quoted

if TYPE_CHECKING:
    from kanegen.model.numbers import Number
    from kanegen.model.system import System


def _values(flag: str, what: str, rest: str) -> object:
    """Return the option for values by name."""
    return typer.Option(
        flag,
        metavar="NAME=VALUE",
        help=f"{what} (repeatable), a number or an expression of parameters such as pi/2; {rest}.",
        show_default=False,
    )


X = Annotated[list[str] | None, _values("--x", "Value of a coordinate, rad or m", "others are neutral")]
Y = Annotated[list[str] | None, _values("--y", "Value of a speed, rad/s or m/s", "others are 0")]
Tau = Annotated[list[str] | None, _values("--tau", "Value of a generalized force, N m or N", "others are 0")]
Inputs = Annotated[
    list[str] | None,
    typer.Option(
        "--input",
        metavar="NAME",
        help="Freedom on which a control acts (repeatable); by default all of them.",
        show_default=False,
    ),
]
LinearOutputs = Annotated[
    list[str] | None,
    typer.Option(
        "--output",
        metavar="NAME",
        help="Output of the linear model (repeatable): point_positions, point_velocities, "
        "point_accelerations, kinetic_energy, potential_energy, momentum, mass_center, or a state such as "
        "x.pole or y.pole.",
        show_default=False,
    ),
]


def numbers_by_name(option: str, texts: Sequence[str] | None, system: System) -> dict[str, Number]:
    """Return numbers by name, from texts such as "pole=pi/6".

    Raises:
        OptionError: If a text has another form, or a name occurs twice.
        ModelError: If a value is neither a number nor an expression of parameters.
    """
    from kanegen.model.grammar import parse_number
    from kanegen.model.numbers import number

    known = {parameter.name: parameter for parameter in system.parameters}
    found: dict[str, Number] = {}
    for text in texts or ():
        name, equals, value = (part.strip() for part in text.rpartition("="))
        if not (name and equals and value):
            raise OptionError(f"{option}: {quoted(text)} is not NAME=VALUE, such as pole=0.3.")
        if name in found:
            raise OptionError(f"{option}: {quoted(name)} has two values. Give one.")
        try:
            expression = parse_number(value, known)
        except ModelError as error:
            raise ModelError(f"{option} {name}: {error}") from None
        found[name] = number(expression, f"{option} {name}")
    return found
