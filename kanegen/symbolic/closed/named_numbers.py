"""Numbers of a model as symbols, so that SymPy adds none of them up before it is known what cancels.

SymPy joins floats as soon as they meet, and what is left where they cancel looks like a number of the model.
With a symbol for every number, sums are formed once, in exact fractions, beside the sizes of their terms.
"""

from __future__ import annotations

from collections.abc import Container, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import count

from sympy import Expr

from kanegen.model.body import Body
from kanegen.model.joint import IDENTITY
from kanegen.model.numbers import Number, Parameter, map_numbers
from kanegen.model.system import System
from kanegen.symbolic.closed.polynomials import fraction
from kanegen.symbolic.symbols import expression, parameter


@dataclass(frozen=True)
class NamedNumbers:
    """What the symbols of numbers stand for.

    Attributes:
        values: The numbers.
        sizes: The numbers without signs; 1 for entries of a rotation matrix, because its rows have this
            length and every entry is rounded by as much as the largest.
    """

    values: Mapping[Expr, Fraction] = field(default_factory=dict)
    sizes: Mapping[Expr, Fraction] = field(default_factory=dict)


def with_named_numbers(system: System) -> tuple[System, NamedNumbers]:
    """Return a system with parameters in place of the numbers of bodies and gravity, and their values.

    Integers stay, so that zeros and ones vanish from products, and so do angles, whose sines are numbers.
    """
    names = _Names({each.name for each in system.parameters})
    bodies = tuple(_named(body, names) for body in system.bodies)
    gravity = map_numbers(system.gravity, names.of_number)
    return replace(system, bodies=bodies, gravity=gravity), NamedNumbers(names.values, names.sizes)


class _Names:
    """The parameters that stand for numbers, one for each value, apart for entries of rotation matrices."""

    def __init__(self, taken: Container[str]) -> None:
        self.values: dict[Expr, Fraction] = {}
        self.sizes: dict[Expr, Fraction] = {}
        self._known: dict[tuple[float, bool], Parameter] = {}
        self._unused = (name for i in count() if (name := f"number_{i}") not in taken)

    def of_number(self, value: Number) -> Number:
        """Return the parameter of a number; integers and parameters stay."""
        return self._of(value, is_entry=False)

    def of_entry(self, value: Number) -> Number:
        """Return the parameter of an entry of a rotation matrix; integers and parameters stay."""
        return self._of(value, is_entry=True)

    def _of(self, value: Number, *, is_entry: bool) -> Number:
        exact = expression(value)
        if isinstance(value, Parameter) or exact.is_Integer:
            return value
        if (value, is_entry) not in self._known:
            self._known[value, is_entry] = named = Parameter(next(self._unused), value)
            self.values[parameter(named)] = fraction(exact)
            self.sizes[parameter(named)] = Fraction(1) if is_entry else abs(fraction(exact))
        return self._known[value, is_entry]


def _named(body: Body, names: _Names) -> Body:
    """Return a body with parameters in place of its numbers."""
    joint, orientation = body.joint, body.joint.orientation
    untilted = replace(body, joint=replace(joint, orientation=IDENTITY)).map_numbers(names.of_number)
    if isinstance(orientation[0], tuple):
        orientation = map_numbers(orientation, names.of_entry)
    locked = (*joint.locked[:3], *untilted.joint.locked[3:])
    return replace(untilted, joint=replace(untilted.joint, orientation=orientation, locked=locked))
