"""Quantities of a motion by name: coordinates, speeds, energies, and elements of every output of a library.

`x.q1` is a coordinate, `y.q1` a speed, `kinetic_energy` an output, `point_positions.tip.z` an element of one,
and `energy` the sum of kinetic and potential energy. `x`, `y` and the name of an output with several elements
stand for all of them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kanegen.c import Source
from kanegen.choices import did_you_mean
from kanegen.errors import OptionError, quoted
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.recursion.outputs import DIFFERENTIATED, OUTPUTS
from kanegen.simulation.elements import elements, rate_unit

STATE = ("x", "y")
"""The arrays of a state."""

SUMS = {"energy": ("kinetic_energy", "potential_energy")}
"""Quantities that are sums of outputs, each with the unit of its parts."""


@dataclass(frozen=True)
class Quantity:
    """One number of a state.

    Attributes:
        name: Its name, such as `point_positions.tip.z`.
        unit: Its SI unit; of an output whose elements have several all of them.
        arrays: The arrays to whose sum it belongs: "x", "y", or names of outputs.
        place: Its place in the arrays, whose elements are counted from 0, row-major.
    """

    name: str
    unit: str
    arrays: tuple[str, ...]
    place: int


def outputs_of(where: str, names: Iterable[str], system: System) -> tuple[str, ...]:
    """Return the outputs that quantities need, in the order of the table of outputs.

    Args:
        where: Beginning of error messages.
        names: Names of quantities.
        system: The tree.

    Raises:
        OptionError: If there is no output of a name in the system.
    """
    known = [name for name, one in OUTPUTS.items() if name not in DIFFERENTIATED and one.is_available(system)]
    needed: set[str] = set()
    for name in names:
        first = name.partition(".")[0]
        if first in STATE:
            continue
        if first not in known and first not in SUMS:
            others = (*STATE, *SUMS, *known)
            raise OptionError(f"{where}: there is no quantity {quoted(name)}. {did_you_mean(first, others)}")
        needed.update(SUMS.get(first, (first,)))
    needed |= {"forward_dynamics" for name in needed if "ydot" in OUTPUTS[name].inputs}
    return tuple(name for name in OUTPUTS if name in needed)


def quantities(where: str, name: str, source: Source) -> tuple[Quantity, ...]:
    """Return the quantities that a name stands for.

    Args:
        where: Beginning of error messages.
        name: The name.
        source: Generated C with the outputs of `outputs_of`.

    Raises:
        OptionError: If there is no such quantity; the message names the nearest one.
    """
    first = name.partition(".")[0]
    found = _of_array(first, source)
    if name != first:
        known = [one.name for one in found]
        found = [one for one in found if one.name == name]
        if not found:
            raise OptionError(f"{where}: there is no quantity {quoted(name)}. {did_you_mean(name, known)}")
    return tuple(found)


def values(found: Iterable[Quantity], array: Callable[[str], NDArray[np.floating[Any]]]) -> Floats:
    """Return the (B, K, E) numbers of E quantities of B rows at K times.

    Args:
        found: The quantities.
        array: Function that returns the (B, K, ...) values of "x", of "y", or of an output, row-major.
    """
    columns = [sum(array(name)[..., one.place] for name in one.arrays) for one in found]
    return np.stack([np.asarray(column, np.float64) for column in columns], axis=-1)


def _of_array(name: str, source: Source) -> list[Quantity]:
    """Return the elements of the state, of an output, or of a sum of outputs."""
    model = source.model
    if name == "x":
        units = zip(model.coordinate_names, model.coordinate_units, strict=True)
        return [Quantity(f"x.{one}", unit, ("x",), place) for place, (one, unit) in enumerate(units)]
    if name == "y":
        names = model.speed_names or model.freedom_names
        rates = map(rate_unit, model.freedom_units)
        return [
            Quantity(f"y.{one}", unit, ("y",), place)
            for place, (one, unit) in enumerate(zip(names, rates, strict=True))
        ]
    parts = SUMS.get(name, (name,))
    found = enumerate(elements(source, parts[0]))
    return [Quantity(name if name in SUMS else one.name, one.unit, parts, k) for k, one in found]
