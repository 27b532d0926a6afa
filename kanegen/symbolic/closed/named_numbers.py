"""Numbers of a model as symbols, so that SymPy adds none of them up before it is known what cancels.

SymPy joins floats as soon as they meet, and what is left where they cancel looks like a number of the model.
With a symbol for every number, sums are formed once, in exact fractions, beside the sizes of their terms.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import chain, count

from sympy import Expr

from kanegen.model.body import Body
from kanegen.model.joint import IDENTITY
from kanegen.model.numbers import Matrix, Number, Parameter, is_fixed, map_numbers, value_of
from kanegen.model.system import System
from kanegen.symbolic.closed.coefficients import fraction
from kanegen.symbolic.state_symbols import of_system
from kanegen.symbolic.symbols import expression, parameter

DIGITS = 50
"""Decimals of the entries of the nearest rotation; three times those of a double."""

STEPS = 3
"""Newton steps from a matrix of doubles; each one doubles the number of digits."""


@dataclass(frozen=True)
class NamedNumbers:
    """What the symbols of numbers stand for.

    Attributes:
        values: The numbers; for entries of a rotation matrix those of the nearest rotation, so that a number
            in the equations is the same wherever it occurs.
        sizes: The numbers without signs; 1 for entries of a rotation matrix, because its rows have this
            length and every entry is rounded by as much as the largest.
    """

    values: Mapping[Expr, Fraction] = field(default_factory=dict)
    sizes: Mapping[Expr, Fraction] = field(default_factory=dict)


def with_named_numbers(system: System) -> tuple[System, NamedNumbers]:
    """Return a system with parameters in place of its numbers, and their values.

    Integers stay, so that zeros and ones vanish from products. So do angles, whose sines are numbers, frames,
    and the factors of couplings, which stand in operands of sines. A system in which all numbers stay is
    returned as it is.
    """
    names = _Names(of_system(system).reserved.union(each.name for each in system.parameters))
    bodies = tuple(_named(body, names) for body in system.bodies)
    parts = {
        "gravity": map_numbers(system.gravity, names.of_number),
        "force_elements": tuple(one.map_numbers(names.of_number) for one in system.force_elements),
        "rotors": tuple(one.map_numbers(names.of_number) for one in system.rotors),
    }
    if not names.values:
        return system, NamedNumbers()
    return replace(system, bodies=bodies, **parts), NamedNumbers(names.values, names.sizes)


class _Names:
    """The parameters that stand for numbers, one for each value, apart for entries of rotation matrices."""

    def __init__(self, taken: Container[str]) -> None:
        self.values: dict[Expr, Fraction] = {}
        self.sizes: dict[Expr, Fraction] = {}
        self._known: dict[tuple[Fraction, bool], Parameter] = {}
        self._unused = (name for i in count() if (name := f"number_{i}") not in taken)

    def of_number(self, value: Number) -> Number:
        """Return the parameter of a number; integers, parameters and expressions stay."""
        return value if _stays(value) else self._of(value_of(value), fraction(expression(value)))

    def of_rotation(self, matrix: Matrix) -> Matrix:
        """Return the parameters of a rotation matrix; integers stay, and so does a matrix with parameters."""
        entries = [*chain(*matrix)]
        if not all(map(is_fixed, entries)) or all(map(_stays, entries)):
            return matrix
        exact = chain(*_nearest_rotation(matrix))
        named: Matrix = map_numbers(matrix, lambda value: self._entry(value, next(exact)))
        return named

    def _entry(self, value: Number, exact: Fraction) -> Number:
        return value if _stays(value) else self._of(value_of(value), exact, is_entry=True)

    def _of(self, value: float, exact: Fraction, *, is_entry: bool = False) -> Parameter:
        if (exact, is_entry) not in self._known:
            self._known[exact, is_entry] = named = Parameter(next(self._unused), value)
            self.values[parameter(named)] = exact
            self.sizes[parameter(named)] = Fraction(1) if is_entry else abs(exact)
        return self._known[exact, is_entry]


def _stays(value: Number) -> bool:
    """Return whether a number gets no name: an integer, a parameter, or an expression."""
    return not isinstance(value, float) or bool(expression(value).is_Integer)


def _nearest_rotation(matrix: Matrix) -> list[list[Fraction]]:
    """Return the rotation nearest to a matrix of plain numbers, in `DIGITS` digits, by Newton's iteration."""
    entries = [[fraction(expression(value)) for value in row] for row in matrix]
    for _ in range(STEPS):
        columns = list(zip(*entries, strict=True))
        factor = [[(3 * (a is b) - _dot(a, b)) / 2 for a in columns] for b in columns]
        entries = [[round(_dot(row, column), DIGITS) for column in factor] for row in entries]
    return entries


def _dot(a: Iterable[Fraction], b: Iterable[Fraction]) -> Fraction:
    """Return the scalar product of two vectors."""
    return sum((x * y for x, y in zip(a, b, strict=True)), start=Fraction(0))


def _named(body: Body, names: _Names) -> Body:
    """Return a body with parameters in place of its numbers."""
    joint, orientation = body.joint, body.joint.orientation
    untilted = replace(body, joint=replace(joint, orientation=IDENTITY)).map_numbers(names.of_number)
    if isinstance(orientation[0], tuple):
        orientation = names.of_rotation(orientation)
    locked = (*joint.locked[:3], *untilted.joint.locked[3:])
    return replace(untilted, joint=replace(untilted.joint, orientation=orientation, locked=locked))
