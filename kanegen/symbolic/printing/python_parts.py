"""What the Python modules with equations have in common: names, arguments, loads and definitions."""

from __future__ import annotations

import keyword
from collections.abc import Callable, Iterable, Sequence

import sympy
from sympy import Expr, ImmutableMatrix, Symbol

from kanegen.model.quoting import python_text
from kanegen.symbolic import functions
from kanegen.symbolic.equations import Equations
from kanegen.symbolic.literal.numeric import needed_definitions
from kanegen.symbolic.printers import python
from kanegen.symbolic.printing.document import kinematic_relation
from kanegen.symbolic.symbols import force, parameter, point_force, point_moment, real, torque

TAKEN = frozenset(
    [
        *"A PARAMETERS coordinate_rates atan2 cos exp f force forcing log mass_matrix max min np".split(),
        *"parameters pi point_force point_moment prescribed sin sqrt t tanh torque x y".split(),
        *"blocks bodies body matrix v w".split(),
        *keyword.kwlist,
    ]
)
"""Names in the module that the symbol of a parameter or of a freedom cannot have."""


def functions_of_math(equations: Equations, f: ImmutableMatrix) -> Iterable[str]:
    """Yield the names of `math` beside sine and cosine that force elements need."""
    values = [*f, *(definition.value for definition in equations.definitions)]
    if any(value.has(sympy.Pow) and any(p.exp.q == 2 for p in value.atoms(sympy.Pow)) for value in values):
        yield "sqrt"
    for function in (functions.exp, functions.log, functions.tanh, functions.atan2):
        if any(value.has(function) for value in values):
            yield function.__name__
    if any(value.has(sympy.pi) for value in values):
        yield "pi"


def names_of(equations: Equations) -> dict[Symbol, Symbol]:
    """Return the symbol in the module of each parameter and freedom, with another name where it is taken."""
    given = [each.name for each in equations.system.parameters]
    given += sorted(equations.symbols.reserved)
    used = TAKEN.union(given)
    names: dict[Symbol, Symbol] = {}
    for name in given:
        free = name
        while name in TAKEN and free in used:
            free += "_"
        used |= {free}
        names[real(name)] = real(free)
    return names


def docstring(equations: Equations, names: dict[Symbol, Symbol]) -> str:
    """Return the docstring of the module."""
    system = equations.system
    relation = kinematic_relation(system)
    name = python_text(system.name)
    lines = [
        f'"""Equations of motion [A]{{ydot}} = {{f}} of {name}, with {relation}. SI units.',
        "",
        "The elements of x; those of y are their time derivatives"
        + (":" if system.speeds_are_rates else ", or components of relative angular velocities:"),
        "",
    ]
    speeds = {
        i: f"    y[{i}] = {equations.y[i]}, {python_text(system.speed_names[i])} ({freedom.unit}/s)"
        for i, freedom in enumerate(system.freedoms)
        if not system.speeds[i].kind.is_rate
    }
    elements = zip(equations.x, system.coordinates, system.coordinate_names, strict=True)
    for i, (x, coordinate, name) in enumerate(elements):
        lines.append(f"    x[{i}] = {names.get(x, x)}, {python_text(name)} ({coordinate.unit})")
        if i in speeds:
            lines.append(speeds[i])
    for i, (name, freedom) in enumerate(zip(system.prescribed_names, system.prescribed, strict=True)):
        value = names.get(equations.prescribed[0, i], equations.prescribed[0, i])
        lines.append(f"    prescribed[0][{i}] = {value}, {python_text(name)} ({freedom.unit})")
    if system.prescribed:
        lines += ["", "prescribed[1] and prescribed[2] are their rates and second derivatives."]
    return "\n".join([*lines, '"""'])


def default_parameters(equations: Equations) -> str:
    """Return the assignment of `PARAMETERS`."""
    items = [f'    "{p.name}": {p.value!r},' for p in equations.system.parameters]
    return "\n".join(["PARAMETERS = {", *items, "}"]) if items else "PARAMETERS = {}"


def prescribed_argument(equations: Equations) -> str:
    """Return the argument `prescribed` with a comma before it; "" if nothing is prescribed."""
    return ", prescribed" if equations.system.prescribed else ""


def prescribed_assignments(equations: Equations, names: dict[Symbol, Symbol]) -> Iterable[str]:
    """Yield the assignments of prescribed values, rates and second derivatives, a line each."""
    if equations.system.prescribed:
        for i in range(3):
            yield from unpacked(equations.prescribed[i, :], f"prescribed[{i}]", names)


def loads(equations: Equations) -> Iterable[str]:
    """Yield the assignments of loads on bodies and on points."""
    bodies = [body.body.loads for body in equations.bodies]
    points = [point.loads for _, point in equations.system.points]
    yield from _rows("force", force, bodies)
    yield from _rows("torque", torque, bodies)
    yield from _rows("point_force", point_force, points)
    yield from _rows("point_moment", point_moment, points)


def _rows(name: str, symbol: Callable[..., Symbol], loaded: Sequence[bool]) -> Iterable[str]:
    """Yield the assignments of the components of a load, for the rows that take loads.

    Args:
        name: Name of the argument.
        symbol: Makes the symbol of a component.
        loaded: Whether each row of the argument takes loads.
    """
    for row, takes in enumerate(loaded):
        if takes:
            components = ", ".join(str(symbol(row + 1, axis)) for axis in range(3))
            yield f"    {components} = (0.0, 0.0, 0.0) if {name} is None else {name}[{row}]"


def definitions_of(
    equations: Equations, values: Sequence[Expr], names: dict[Symbol, Symbol]
) -> Iterable[str]:
    """Yield the assignments of the parameters and definitions that `values` depend on."""
    definitions = needed_definitions(equations.definitions, values)
    used: set[Symbol] = set()
    for expr in (*values, *(definition.value for definition in definitions)):
        used |= expr.free_symbols
    for each in equations.system.parameters:
        if parameter(each) in used:
            yield f'    {names[parameter(each)]} = parameters["{each.name}"]'
    for definition in definitions:
        yield f"    {definition.symbol} = {python(definition.value.xreplace(names))}"


def unpacked(symbols: Iterable[Symbol], argument: str, names: dict[Symbol, Symbol]) -> Iterable[str]:
    """Yield the assignment of the elements of an argument to symbols, which may have other names."""
    left = [str(names.get(symbol, symbol)) for symbol in symbols]
    yield f"    {', '.join(left)} = {argument}" if len(left) > 1 else f"    {left[0]} = {argument}[0]"
