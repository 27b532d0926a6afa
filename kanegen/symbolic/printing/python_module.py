"""Equations as a Python module that needs nothing but NumPy."""

from __future__ import annotations

from sympy import ImmutableMatrix, Symbol

from kanegen.symbolic.closed.form import ClosedForm
from kanegen.symbolic.equations import Equations
from kanegen.symbolic.printers import python
from kanegen.symbolic.printing.python_parts import (
    default_parameters,
    definitions_of,
    docstring,
    functions_of_math,
    loads,
    names_of,
    prescribed_argument,
    prescribed_assignments,
    unpacked,
)


def python_module(equations: Equations, form: ClosedForm) -> str:
    """Return a module with the functions `mass_matrix`, `forcing` and, where needed, `coordinate_rates`.

    Args:
        equations: The equations to which [A] and {f} belong.
        form: [A] and {f}, which hold in all states.
    """
    names = names_of(equations)
    functions = ", ".join(sorted({"cos", "sin", *functions_of_math(equations, form.f)}))
    head = [
        docstring(equations, names),
        f"from math import {functions}",
        "import numpy as np",
        default_parameters(equations),
    ]
    parts = [
        "\n\n".join(head),
        _mass_matrix(equations, form.A, names),
        _forcing(equations, form.f, names),
    ]
    if not equations.system.speeds_are_rates:
        parts.append(_coordinate_rates(equations, names))
    return "\n\n\n".join(parts) + "\n"


def _mass_matrix(equations: Equations, A: ImmutableMatrix, names: dict[Symbol, Symbol]) -> str:
    """Return the function `mass_matrix`."""
    n = len(equations.y)
    prescribed = prescribed_argument(equations)
    entries = {(i, j): A[i, j] for i in range(n) for j in range(i, n) if A[i, j]}
    lines = [
        f"def mass_matrix(x{prescribed}, parameters=PARAMETERS):",
        f'    """[A] of Eq. (43), ({n}, {n}), at the coordinates x, ({len(equations.x)},)."""',
        *unpacked(equations.x, "x", names),
        *prescribed_assignments(equations, names),
        *definitions_of(equations, list(entries.values()), names),
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
    prescribed = prescribed_argument(equations)
    further = ", point_force=None, point_moment=None" * any(point.loads for _, point in system.points)
    further += ", t=0.0" * system.depends_on_time
    lines = [
        f"def forcing(x, y{prescribed}, force=None, torque=None, parameters=PARAMETERS{further}):",
        f'    """{{f}} of Eq. (44), ({n},), at x, ({m},), and y, ({n},), under loads, ({bodies}, 3)."""',
        *unpacked(equations.x, "x", names),
        *unpacked(equations.y, "y", names),
        *prescribed_assignments(equations, names),
        *loads(equations),
        *definitions_of(equations, list(f), names),
        f"    f = np.zeros({n})",
    ]
    lines += [f"    f[{i}] = {python(value.xreplace(names))}" for i, value in enumerate(f) if value]
    return "\n".join([*lines, "    return f"])


def _coordinate_rates(equations: Equations, names: dict[Symbol, Symbol]) -> str:
    """Return the function `coordinate_rates`."""
    lines = [
        "def coordinate_rates(x, y):",
        f'    """{{xdot}} of Eqs. (9), (45), ({len(equations.x)},), at coordinates x and speeds y."""',
        *unpacked(equations.x, "x", names),
        *unpacked(equations.y, "y", names),
        *definitions_of(equations, list(equations.xdot), names),
        f"    return np.array([{', '.join(python(value.xreplace(names)) for value in equations.xdot)}])",
    ]
    return "\n".join(lines)
