"""Equations as a Python module that needs nothing but NumPy."""

from __future__ import annotations

import keyword
from collections.abc import Callable, Iterable, Sequence

import sympy
from sympy import Expr, ImmutableMatrix, Symbol

from kanegen.model.quoting import python_text
from kanegen.symbolic import functions
from kanegen.symbolic.closed.form import ClosedForm
from kanegen.symbolic.equations import Equations
from kanegen.symbolic.literal.numeric import needed_definitions
from kanegen.symbolic.printers import python
from kanegen.symbolic.printing.document import kinematic_relation
from kanegen.symbolic.symbols import force, parameter, point_force, point_moment, real, torque

TAKEN = frozenset(
    [
        *"A PARAMETERS coordinate_rates atan2 cos exp f force forcing log mass_matrix max min np".split(),
        *"parameters pi point_force point_moment prescribed sin sqrt t tanh torque x y".split(),
        *keyword.kwlist,
    ]
)
"""Names in the module that the symbol of a parameter or of a freedom cannot have."""


def python_module(equations: Equations, form: ClosedForm) -> str:
    """Return a module with the functions `mass_matrix`, `forcing` and, where needed, `coordinate_rates`.

    Args:
        equations: The equations to which [A] and {f} belong.
        form: [A] and {f}, which hold in all states.
    """
    names = _names(equations)
    functions = ", ".join(sorted({"cos", "sin", *_functions(equations, form.f)}))
    head = [
        _docstring(equations, names),
        f"from math import {functions}",
        "import numpy as np",
        _parameters(equations),
    ]
    parts = [
        "\n\n".join(head),
        _mass_matrix(equations, form.A, names),
        _forcing(equations, form.f, names),
    ]
    if not equations.system.speeds_are_rates:
        parts.append(_coordinate_rates(equations, names))
    return "\n\n\n".join(parts) + "\n"


def _functions(equations: Equations, f: ImmutableMatrix) -> Iterable[str]:
    """Yield the names of `math` beside sine and cosine that force elements need."""
    values = [*f, *(definition.value for definition in equations.definitions)]
    if any(value.has(sympy.Pow) and any(p.exp.q == 2 for p in value.atoms(sympy.Pow)) for value in values):
        yield "sqrt"
    for function in (functions.exp, functions.log, functions.tanh, functions.atan2):
        if any(value.has(function) for value in values):
            yield function.__name__
    if any(value.has(sympy.pi) for value in values):
        yield "pi"


def _names(equations: Equations) -> dict[Symbol, Symbol]:
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


def _docstring(equations: Equations, names: dict[Symbol, Symbol]) -> str:
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


def _parameters(equations: Equations) -> str:
    """Return the assignment of `PARAMETERS`."""
    items = [f'    "{p.name}": {p.value!r},' for p in equations.system.parameters]
    return "\n".join(["PARAMETERS = {", *items, "}"]) if items else "PARAMETERS = {}"


def _mass_matrix(equations: Equations, A: ImmutableMatrix, names: dict[Symbol, Symbol]) -> str:
    """Return the function `mass_matrix`."""
    n = len(equations.y)
    prescribed = _prescribed_argument(equations)
    entries = {(i, j): A[i, j] for i in range(n) for j in range(i, n) if A[i, j]}
    lines = [
        f"def mass_matrix(x{prescribed}, parameters=PARAMETERS):",
        f'    """[A] of Eq. (43), ({n}, {n}), at the coordinates x, ({len(equations.x)},)."""',
        *_unpacked(equations.x, "x", names),
        *_prescribed_assignments(equations, names),
        *_body(equations, list(entries.values()), names),
        f"    A = np.zeros(({n}, {n}))",
    ]
    for (i, j), value in entries.items():
        mirror = "" if i == j else f"A[{j}, {i}] = "
        lines.append(f"    A[{i}, {j}] = {mirror}{python(value.xreplace(names))}")
    return "\n".join([*lines, "    return A"])


def _forcing(equations: Equations, f: ImmutableMatrix, names: dict[Symbol, Symbol]) -> str:
    """Return the function `forcing`."""
    m, n, bodies = len(equations.x), len(equations.y), len(equations.bodies)
    system = equations.system
    prescribed = _prescribed_argument(equations)
    further = ", point_force=None, point_moment=None" * any(point.loads for _, point in system.points)
    further += ", t=0.0" * system.depends_on_time
    lines = [
        f"def forcing(x, y{prescribed}, force=None, torque=None, parameters=PARAMETERS{further}):",
        f'    """{{f}} of Eq. (44), ({n},), at x, ({m},), and y, ({n},), under loads, ({bodies}, 3)."""',
        *_unpacked(equations.x, "x", names),
        *_unpacked(equations.y, "y", names),
        *_prescribed_assignments(equations, names),
        *_loads(equations),
        *_body(equations, list(f), names),
        f"    f = np.zeros({n})",
    ]
    lines += [f"    f[{i}] = {python(value.xreplace(names))}" for i, value in enumerate(f) if value]
    return "\n".join([*lines, "    return f"])


def _coordinate_rates(equations: Equations, names: dict[Symbol, Symbol]) -> str:
    """Return the function `coordinate_rates`."""
    lines = [
        "def coordinate_rates(x, y):",
        f'    """{{xdot}} of Eqs. (9), (45), ({len(equations.x)},), at coordinates x and speeds y."""',
        *_unpacked(equations.x, "x", names),
        *_unpacked(equations.y, "y", names),
        *_body(equations, list(equations.xdot), names),
        f"    return np.array([{', '.join(python(value.xreplace(names)) for value in equations.xdot)}])",
    ]
    return "\n".join(lines)


def _prescribed_argument(equations: Equations) -> str:
    """Return the argument `prescribed` with a comma before it; "" if nothing is prescribed."""
    return ", prescribed" if equations.system.prescribed else ""


def _prescribed_assignments(equations: Equations, names: dict[Symbol, Symbol]) -> Iterable[str]:
    """Yield the assignments of prescribed values, rates and second derivatives, a line each."""
    if equations.system.prescribed:
        for i in range(3):
            yield from _unpacked(equations.prescribed[i, :], f"prescribed[{i}]", names)


def _loads(equations: Equations) -> Iterable[str]:
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


def _body(equations: Equations, values: Sequence[Expr], names: dict[Symbol, Symbol]) -> Iterable[str]:
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


def _unpacked(symbols: Iterable[Symbol], argument: str, names: dict[Symbol, Symbol]) -> Iterable[str]:
    """Yield the assignment of the elements of an argument to symbols, which may have other names."""
    left = [str(names.get(symbol, symbol)) for symbol in symbols]
    yield f"    {', '.join(left)} = {argument}" if len(left) > 1 else f"    {left[0]} = {argument}[0]"
