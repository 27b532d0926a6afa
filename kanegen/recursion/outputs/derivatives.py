"""Outputs that are derivatives of others: what they are of and by, and how they are laid out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from kanegen.model.system import System
from kanegen.program.ir import Array
from kanegen.program.selection import PARAMETERS

FORWARD = "forward_dynamics_derivatives"


@dataclass(frozen=True)
class Derivative:
    """An output of this kind.

    Attributes:
        of: What it is the derivative of, in words.
        unit: Of what is differentiated.
        needs: The outputs that it is made from.
        by: The arrays by whose elements.
    """

    of: str
    unit: str
    needs: tuple[str, ...]
    by: tuple[str, ...]


DERIVATIVES = {
    "forcing_derivatives": Derivative("{f}, Eq. (44),", "N m, N", ("forcing",), ("x", "y")),
    "inverse_dynamics_derivatives": Derivative(
        "[A]{ydot} - {f} for given {ydot}", "N m, N", ("inverse_dynamics",), ("x", "y")
    ),
    FORWARD: Derivative(
        "{ydot} of [A]{ydot} = {f} + {tau}",
        "rad/s^2, m/s^2",
        ("mass_matrix", "inverse_dynamics", "forward_dynamics"),
        ("x", "y", "tau"),
    ),
}
"""By name of output."""

METHOD = "tangents of the recursions"
"""How they are derived."""


def columns(name: str, coordinates: int, n: int, parameters: int) -> dict[str, slice]:
    """Which columns of an output belong to which array; run-time parameters come last.

    Args:
        name: Of the output.
        coordinates: Elements of {x}.
        n: Freedoms.
        parameters: How many there are.
    """
    sizes = {"x": coordinates, "y": n, "tau": n, PARAMETERS: parameters}
    found: dict[str, slice] = {}
    first = 0
    for by in (*DERIVATIVES[name].by, *((PARAMETERS,) if parameters else ())):
        found[by] = slice(first, first + sizes[by])
        first += sizes[by]
    return found


def columns_of(system: System, name: str) -> dict[str, slice]:
    """The same of a system."""
    return columns(name, len(system.coordinates), len(system.freedoms), len(system.parameters))


def array(system: System, name: str) -> Array:
    """The array of an output: a row for each freedom, a column for what it is differentiated by."""
    kind, by = DERIVATIVES[name], columns_of(system, name)
    places = ", then ".join(f"{one} (columns {part.start} to {part.stop - 1})" for one, part in by.items())
    width = max(part.stop for part in by.values())
    doc = f"derivatives of {kind.of} by {places}"
    return Array(name, (len(system.freedoms), width), f"{kind.unit} over the units of these", doc)


def with_needs(names: Sequence[str]) -> tuple[str, ...]:
    """The outputs from which these are made, themselves left out where they are derivatives."""
    found: list[str] = []
    for name in names:
        found += DERIVATIVES[name].needs if name in DERIVATIVES else (name,)
    return tuple(dict.fromkeys(found))
