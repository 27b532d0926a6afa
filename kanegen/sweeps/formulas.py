"""Expressions of axes: their names, the order in which they follow from each other, and their values."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from kanegen.choices import did_you_mean
from kanegen.errors import OptionError, quoted
from kanegen.model.arrays import Floats
from kanegen.model.expression import Expression
from kanegen.model.grammar import parse
from kanegen.model.nodes import TIME, Variable
from kanegen.model.system import System
from kanegen.reference.arithmetics import Dual, Value
from kanegen.reference.expressions import evaluate
from kanegen.sweeps.axes import Formula


def defaults(system: System) -> dict[str, float]:
    """Return what a name in an expression stands for where it is no axis of the sweep.

    That is the default of a parameter, the neutral value of a coordinate, and 0 for a speed.
    """
    found = {parameter.name: parameter.value for parameter in system.parameters}
    neutral = zip(system.coordinate_names, system.neutral_coordinates, strict=True)
    found |= {f"x.{name}": value for name, value in neutral}
    return found | {f"y.{name}": 0.0 for name in system.speed_names}


def formula(where: str, text: str, system: System) -> Formula:
    """Return the formula of a text, whose names are those of `defaults` and `t`.

    Raises:
        OptionError: If the text is no expression, or a name in it is not known.
    """
    known = {parameter.name: Expression(Variable(parameter.name)) for parameter in system.parameters}
    try:
        expression = parse(text, known)
    except ValueError as error:
        raise OptionError(f"{where}: {error}") from None
    names = defaults(system)
    for name in expression.variables:
        if name not in names and name != TIME:
            raise OptionError(f"{where}: there is no {quoted(name)}. {did_you_mean(name, names)}")
    return Formula(text, expression)


def ordered(formulas: Mapping[str, Formula]) -> tuple[str, ...]:
    """Return the names of formulas, each after those from which it follows.

    Raises:
        OptionError: If formulas follow from each other in a circle.
    """
    found: list[str] = []
    waiting = list(formulas)
    while waiting:
        ready = [name for name in waiting if not set(formulas[name].expression.variables) & set(waiting)]
        if not ready:
            raise OptionError(f"axes: {', '.join(waiting)} follow from each other in a circle.")
        found += ready
        waiting = [name for name in waiting if name not in ready]
    return tuple(found)


def depending_on_time(formulas: Mapping[str, Formula]) -> frozenset[str]:
    """Return the names of the formulas that depend on the time, also by way of others."""
    found = {TIME}
    for name in ordered(formulas):
        if found.intersection(formulas[name].expression.variables):
            found.add(name)
    return frozenset(found - {TIME})


def with_rates(one: Formula, columns: Mapping[str, Floats], shape: Iterable[int]) -> tuple[Floats, ...]:
    """Return the values of a formula, and their first and second derivatives by the time.

    The derivatives are exact: dual numbers of dual numbers carry them along.

    Args:
        one: The formula.
        columns: Values of every name in it; they broadcast with each other. Only the time changes with time.
        shape: Shape of each result.
    """
    unit, zero = np.float64(1.0), np.float64(0.0)
    known = {
        name: Dual(Dual(values, unit), Dual(unit, zero)) if name == TIME else constant(values)
        for name, values in columns.items()
        if name in one.expression.variables
    }
    with np.errstate(all="ignore"):
        found = evaluate(one.expression, known, constant)
    parts = found.value.value, found.value.slope, found.slope.slope
    size = tuple(shape)
    return tuple(np.ascontiguousarray(np.broadcast_to(np.asarray(part, np.float64), size)) for part in parts)


def constant(value: Value) -> Dual:
    """Return a number that does not change with the time, with its first two derivatives."""
    zero = np.float64(0.0)
    return Dual(Dual(np.asarray(value, np.float64), zero), Dual(zero, zero))


def values(one: Formula, columns: Mapping[str, Floats], shape: Iterable[int]) -> Floats:
    """Return the values of a formula.

    Args:
        one: The formula.
        columns: Values of every name in it; they broadcast with each other.
        shape: Shape of the result.
    """
    with np.errstate(all="ignore"):
        found = evaluate(one.expression, columns, np.float64)
    return np.ascontiguousarray(np.broadcast_to(np.asarray(found, np.float64), tuple(shape)))
