"""The matrices of bodies as a Python module that needs nothing but NumPy: what rows of blocks stand for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import sympy
from sympy import Expr, ImmutableMatrix, Symbol

from kanegen.model.quoting import python_text
from kanegen.symbolic.equations import Equations
from kanegen.symbolic.literal.dynamics import BodyEquations
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

MATRICES = {
    "relative_rotation": "[^{J}R_{K}], (2), (4)",
    "relative_rotation_rate": "[^{J}Ṙ_{K}], (7)",
    "rotation": "[R_{K}], (3), (5)",
    "rotation_rate": "[Ṙ_{K}], (6)",
    "angle_rate_matrix": "[P̂_{K}], (17)",
    "angle_rate_matrix_rate": "[Ṗ̂_{K}], below (20)",
    "relative_angular_velocity": "{{ω̂'_{K}}}, (8)",
    "angular_velocity": "{{ω'_{K}}}, (11)",
    "relative_partial_angular_velocity": "[ω̂'_{K},y], (16)",
    "partial_angular_velocity": "[ω'_{K},y], (15), (18)",
    "partial_angular_velocity_rate": "[ω̇'_{K},y], (20)",
    "offset": "{{q'_{K}}} + {{s'_{K}}}, (22)",
    "position_of_origin": "{{p'_O{K}}}, (22)",
    "position_of_center": "{{p'_G{K}}}, (23)",
    "velocity_of_origin": "{{v'_O{K}}}, (25)",
    "velocity_of_center": "{{v'_G{K}}}, (27)",
    "relative_partial_velocity": "[^{J}v'_O{K},y], (29), (30)",
    "partial_velocity_of_origin": "[v'_O{K},y], (28)",
    "partial_velocity_of_center": "[v'_G{K},y], (32)",
    "partial_velocity_of_origin_rate": "[v̇'_O{K},y], (35)",
    "partial_velocity_of_center_rate": "[v̇'_G{K},y], (34)",
    "force": "{{F'_{K}}} + m_{K}[R_{K}]{{g}}, (37)",
    "torque": "{{M'_{K}}}, (37)",
    "inertia": "[I'_G{K}], (40)",
    "net_force": "the factor of [v'_G{K},y]^T in (44)",
    "net_torque": "the factor of [ω'_{K},y]^T in (44)",
}
"""The matrices of body K on J by their names in `BodyEquations`, with notation and number of the notes."""

PRODUCTS = {
    "generalized_forces": ("v.T @ body['force'] + w.T @ body['torque']", "{{F_y,{K}}}, (37)"),
    "mass_matrix": ("body['mass'] * v.T @ v + w.T @ body['inertia'] @ w", "[A_{K}], (43)"),
    "forcing": ("v.T @ body['net_force'] + w.T @ body['net_torque']", "{{f_{K}}}, (44)"),
}
"""What body K adds to the equations of motion, as products of its matrices."""

_MATRIX = '''
def matrix(columns, *rows):
    """Return a matrix from its entries that are not zero, row by row, by the number of their column."""
    found = np.zeros((len(rows), columns))
    for i, row in enumerate(rows):
        for j, value in row.items():
            found[i, j] = value
    return found
'''


@dataclass(frozen=True)
class _Value:
    """A matrix of a body.

    Attributes:
        name: Its name in `MATRICES`.
        matrix: The matrix in symbols.
    """

    name: str
    matrix: ImmutableMatrix


def python_blocks(equations: Equations, number: int = 0) -> str:
    """Return a module with a function `blocks` that returns the matrices of bodies as NumPy arrays.

    Args:
        equations: The equations, with intermediates.
        number: Number of the only body that is wanted, 0 for all of them.
    """
    wanted = [body for body in equations.bodies if number in (0, body.number)]
    values = {body.number: [_Value(name, getattr(body, name)) for name in MATRICES] for body in wanted}
    entries = [entry for found in values.values() for one in found for entry in one.matrix if entry]
    entries += [body.mass for body in wanted]
    names = names_of(equations)
    functions = sorted({"cos", "sin", *functions_of_math(equations, ImmutableMatrix(entries))})
    head = [
        docstring(equations, names),
        f"from math import {', '.join(functions)}",
        "import numpy as np",
        default_parameters(equations),
    ]
    lines = [
        *_signature(equations),
        *_arguments(equations, names),
        *definitions_of(equations, entries, names),
    ]
    lines.append("    bodies = {}")
    for body in wanted:
        lines += _body(body, values[body.number], names)
    return "\n\n".join([*head, _MATRIX, "\n".join([*lines, "    return bodies"])]) + "\n"


def _signature(equations: Equations) -> Iterator[str]:
    """Yield the head of the function `blocks`."""
    prescribed = prescribed_argument(equations)
    further = ", point_force=None, point_moment=None" * any(p.loads for _, p in equations.system.points)
    further += ", t=0.0" * equations.system.depends_on_time
    m, n, count = len(equations.x), len(equations.y), len(equations.bodies)
    yield f"def blocks(x, y{prescribed}, force=None, torque=None, parameters=PARAMETERS{further}):"
    yield '    """Return the matrices of the notes for each body: a table of them by name, by its number.'
    yield ""
    yield f"    x, ({m},), and y, ({n},), are one state, force and torque, ({count}, 3), loads on the bodies."
    yield "    Columns of partial velocities have the order of y. Motors, force elements and loads on points"
    yield "    are no part of a body."
    yield '    """'


def _arguments(equations: Equations, names: dict[Symbol, Symbol]) -> Iterator[str]:
    """Yield the assignments of the elements of the arguments."""
    yield from unpacked(equations.x, "x", names)
    yield from unpacked(equations.y, "y", names)
    yield from prescribed_assignments(equations, names)
    yield from loads(equations)


def _body(body: BodyEquations, values: list[_Value], names: dict[Symbol, Symbol]) -> Iterator[str]:
    """Yield the assignments of the matrices of one body."""
    place = {"K": body.number, "J": body.body.lower or ""}
    yield f"    bodies[{body.number}] = body = {{}}  # {python_text(body.body.name)}"
    yield f'    body["mass"] = {python(sympy.sympify(body.mass).xreplace(names))}'
    for one in values:
        notation = MATRICES[one.name].format(**place)
        rows = ", ".join(_row(row, names) for row in one.matrix.tolist())
        yield f'    body["{one.name}"] = matrix({one.matrix.shape[1]}, {rows})  # {notation}'
    yield '    v, w = body["partial_velocity_of_center"], body["partial_angular_velocity"]'
    for name, (product, notation) in PRODUCTS.items():
        formula = product.replace("'", '"')
        yield f'    body["{name}"] = {formula}  # {notation.format(**place)}'


def _row(entries: list[Expr], names: dict[Symbol, Symbol]) -> str:
    """Return the entries of a row that are not zero, by column."""
    items = (f"{j}: {python(entry.xreplace(names))}" for j, entry in enumerate(entries) if entry != 0)
    return f"{{{', '.join(items)}}}"
