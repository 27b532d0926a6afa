"""Symbols for the numbers of a tree, as the notes have them: m_K, {r'_K}, {q'_K} and [I'_GK]; and gravity.

The symbols are parameters, whose default values are the numbers. Everything else that works on parameters
works on them: closed forms, linear models, and C that takes the numbers at run time.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from kanegen.model.body import Body
from kanegen.model.numbers import Number, Parameter, is_fixed, parameters_of, value_of
from kanegen.model.system_fields import SystemFields
from kanegen.model.system_numbers import numbers_of

GROUND = 0
"""Number of the ground among lower bodies."""


@dataclass(frozen=True, order=True)
class Place:
    """Where a number stands in a tree.

    Attributes:
        quantity: "m", "r", "q" or "I", as the notes call the quantity.
        body: Number K of the body, from 1.
        index: Row, or row and column, from 1; empty for a mass.
    """

    quantity: str
    body: int
    index: tuple[int, ...] = ()

    @property
    def name(self) -> str:
        """The name of the symbol: `m_K`, `r_K_i`, `q_K_i` or `I_K_ij`."""
        return "_".join([self.quantity, str(self.body), *["".join(map(str, self.index))] * bool(self.index)])


def with_symbols(system: SystemFields, keep_zeros: bool) -> dict[str, Any]:
    """Return the fields of a system that change where numbers become parameters.

    Args:
        system: The tree.
        keep_zeros: Whether zeros stay numbers, so that the terms that they multiply vanish.
    """
    free = free_names(system)

    def symbol(place: Place, value: Number) -> Number:
        replaced = is_fixed(value) and not (keep_zeros and value_of(value) == 0)
        return Parameter(free(place.name), value_of(value)) if replaced else value

    bodies = tuple(_body(number, body, symbol) for number, body in enumerate(system.bodies, start=1))
    return {"bodies": bodies, "gravity": _gravity(system.gravity, free)}


def places(system: SystemFields) -> Iterator[tuple[Parameter, Place]]:
    """Yield each parameter that stands for a number by the name of its place, with the place.

    Example:
        dict(places(system.symbolic()))
    """
    for number, body in enumerate(system.bodies, start=1):
        for place, value in _numbers(number, body):
            if isinstance(value, Parameter) and value.name.rstrip("_") == place.name:
                yield value, place


def _numbers(number: int, body: Body) -> Iterator[tuple[Place, Number]]:
    """Yield the numbers of a body that get symbols, with their places."""
    yield Place("m", number), body.mass
    for quantity, vector in (("r", body.mass_center), ("q", body.joint.position)):
        for row, value in enumerate(vector, start=1):
            yield Place(quantity, number, (row,)), value
    for row in range(3):
        for column in range(row, 3):
            yield Place("I", number, (row + 1, column + 1)), body.inertia[row][column]


def _body(number: int, body: Body, symbol: Callable[[Place, Number], Number]) -> Body:
    """Return a body with symbols; the notes define {q'_K} as zero on the ground, so that zeros stay there."""
    made = {place: symbol(place, value) for place, value in _numbers(number, body)}

    def of_vector(quantity: str) -> Any:
        return tuple(made[Place(quantity, number, (row,))] for row in (1, 2, 3))

    inertia: Any = tuple(
        tuple(made[Place("I", number, (min(i, j), max(i, j)))] for j in (1, 2, 3)) for i in (1, 2, 3)
    )
    at_origin = body.lower == GROUND and not any(body.joint.position)
    joint = body.joint if at_origin else replace(body.joint, position=of_vector("q"))
    return replace(
        body,
        mass=made[Place("m", number)],
        mass_center=of_vector("r"),
        inertia=inertia,
        joint=joint,
    )


def _gravity(gravity: Sequence[Number], free: Callable[[str], str]) -> tuple[Number, ...]:
    """Return gravity with the symbol g where it has one component, else with g_1, g_2 and g_3."""
    components = [axis for axis in range(3) if not is_fixed(gravity[axis]) or value_of(gravity[axis])]
    if any(not is_fixed(gravity[axis]) for axis in components):
        return tuple(gravity)
    found = list(gravity)
    for axis in components:
        value = value_of(gravity[axis])
        if len(components) > 1:
            found[axis] = Parameter(free(f"g_{axis + 1}"), value)
        else:
            size = Parameter(free("g"), abs(value))
            found[axis] = size if value > 0 else -size
    return tuple(found)


def free_names(system: SystemFields) -> Callable[[str], str]:
    """Return a function that returns a name with underscores at its end until no parameter has it."""
    taken = {one.name for value in numbers_of(system) for one in parameters_of(value)}

    def free(name: str) -> str:
        while name in taken:
            name += "_"
        return name

    return free
