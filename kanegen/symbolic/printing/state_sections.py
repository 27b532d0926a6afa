"""Sections on the state of a system: its coordinates, its speeds, and what moves as it is told."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from sympy import Symbol

from kanegen.model.system import System
from kanegen.symbolic.equations import Equations
from kanegen.symbolic.printing.latex_names import escaped
from kanegen.symbolic.printing.statements import Names, Section, Written, equation
from kanegen.symbolic.symbols import coordinate_rates


def kinematics(system: System) -> str:
    """What the coordinates have to do with the speeds."""
    return "{xdot} = {y}" if system.speeds_are_rates else "{xdot} from {y} by Eqs. (9), (45)"


def state(equations: Equations, names: Names) -> Section:
    """{x} and {y}: side by side where each speed has its coordinate, one after the other elsewhere."""
    side_by_side = len(equations.x) == len(equations.y)
    statements = _pairs(equations, names) if side_by_side else _apart(equations, names)
    return Section("Coordinates and speeds", "Eq. (1).", tuple(statements), is_list=True)


def _pairs(equations: Equations, names: Names) -> Iterator[Written]:
    for i, (x, y) in enumerate(zip(equations.x, equations.y, strict=True)):
        name, unit = _meaning(equations.system, i)
        yield Written(
            f"x[{i + 1}] = {x}, y[{i + 1}] = {y}: {name} ({unit})",
            f"x_{{{i + 1}}}",
            (rf"{names[x]}, \quad y_{{{i + 1}}} = {names[y]} \quad {_label(name, unit)}",),
        )


def _meaning(system: System, place: int) -> tuple[str, str]:
    """Name and unit at a place of {x}, and those in {y} where it is not the rate."""
    name, unit = system.freedom_names[place], system.freedoms[place].unit
    speed_name = system.speed_names[place]
    return (name, unit) if name == speed_name else (f"{name}, {speed_name}", f"{unit}, {unit}/s")


def _apart(equations: Equations, names: Names) -> Iterator[Written]:
    system = equations.system
    units = [coordinate.unit for coordinate in system.coordinates]
    rates = [f"{freedom.unit}/s" for freedom in system.freedoms]
    yield from _elements("x", equations.x, zip(system.coordinate_names, units, strict=True), names)
    yield from _elements("y", equations.y, zip(system.speed_names, rates, strict=True), names)


def _elements(
    array: str, symbols: Iterable[Symbol], meanings: Iterable[tuple[str, str]], names: Names
) -> Iterator[Written]:
    """What stands in {x}, or in {y}."""
    for i, (symbol, (name, unit)) in enumerate(zip(symbols, meanings, strict=True), start=1):
        plain = f"{array}[{i}] = {symbol}: {name} ({unit})"
        yield Written(plain, f"{array}_{{{i}}}", (rf"{names[symbol]} \quad {_label(name, unit)}",))


def prescribed(equations: Equations, names: Names) -> Iterator[Section]:
    """The prescribed freedoms, where there are some."""
    system, statements = equations.system, []
    for i, (name, freedom) in enumerate(zip(system.prescribed_names, system.prescribed, strict=True)):
        symbols = list(equations.prescribed[:, i])
        plain = f"prescribed[{i + 1}] = {', '.join(map(str, symbols))}: {name} ({freedom.unit})"
        formula = r", \quad ".join(names[symbol] for symbol in symbols)
        right = rf"{formula} \quad {_label(name, freedom.unit)}"
        statements.append(Written(plain, rf"\text{{prescribed}}_{{{i + 1}}}", (right,)))
    if statements:
        note = "Their values, rates and second derivatives are given; they are no coordinates."
        yield Section("Prescribed freedoms", note, tuple(statements), is_list=True)


def rates(equations: Equations, names: Names) -> Iterator[Section]:
    """Eq. (9), where coordinates have other rates than the speeds."""
    every = zip(coordinate_rates(equations.system), equations.xdot, strict=True)
    statements = tuple(equation(symbol, rate, names) for symbol, rate in every if rate != symbol)
    if statements:
        note = (
            "Eq. (9), where the speeds are components of a relative angular velocity; {xdot} = {y} elsewhere."
        )
        yield Section("Rates of the coordinates", note, statements)


def _label(name: str, unit: str) -> str:
    return rf"\text{{{escaped(name)} ({unit})}}"
