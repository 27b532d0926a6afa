"""The rules that a model must satisfy, each with an error message that names the remedy."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from kanegen.errors import ModelError, counted, quoted, warn
from kanegen.model.coordinates import COORDINATE_KINDS, SPEED_KINDS
from kanegen.model.numbers import (
    Matrix,
    Number,
    Parameter,
    Vector,
    described,
    is_fixed,
    listed,
    map_numbers,
    number,
    numbers,
    value_of,
)
from kanegen.model.rotations import nearest_rotation, rotation_123
from kanegen.model.sympy_numbers import is_sympy

_T = TypeVar("_T")

ORTHOGONALITY = 1e-12
"""Largest entry of [C][C]^T - [1] that is accepted: the rounding error of a product of many rotations. A
matrix typed with six digits has a larger error, which would pass into [A] and {f}, and is refused."""

ROUNDED_ROTATION = 1e-15
"""Largest entry of [C][C]^T - [1] for a rotation rounded to doubles. A matrix with a larger error is replaced
by the nearest rotation, because derivations use [C][C]^T = [1], each in other places."""

INERTIA_ROUNDING = 1e-12
"""Relative asymmetry, and relative size of a negative principal moment, that count as rounding errors."""


def integer(value: Any, label: str) -> int:
    """Return `value` as an int; bools and floats are refused."""
    if isinstance(value, bool | np.bool_) or not isinstance(value, int | np.integer):
        raise ModelError(f"{label}: {quoted(value)} is not an integer.")
    return int(value)


def sequence(value: Any, length: int | None, label: str) -> Sequence[Any]:
    """Return `value` as a list of exactly `length` items; None for any number."""
    items = listed(value)
    if items is None:
        entries = "a sequence" if length is None else counted(length, "entry", "entries")
        raise ModelError(f"{label}: expected {entries}, got {quoted(value)}.")
    if length is not None and len(items) != length:
        raise ModelError(f"{label}: expected {counted(length, 'entry', 'entries')}, got {len(items)}.")
    return items


def table(value: Any, label: str, example: str) -> Mapping[str, Any]:
    """Return `value` if it is a table by name; the message calls it `label` and shows an example."""
    if not isinstance(value, Mapping):
        raise ModelError(f"{label}: expected a table such as {example}, got {quoted(value)}.")
    return value


def instances(values: Any, kind: type[_T], label: str) -> tuple[_T, ...]:
    """Return `values` as a tuple of objects of the class `kind`."""
    items = listed(values)
    if items is None:
        raise ModelError(f"{label}: expected a sequence of {kind.__name__} objects, got {quoted(values)}.")
    for item in items:
        if not isinstance(item, kind):
            raise ModelError(f"{label}: {quoted(item)} is no {kind.__name__}.")
    return tuple(items)


def flags(value: Any, length: int, label: str) -> tuple[bool, ...]:
    """Return `value` as a tuple of exactly `length` flags."""
    items = sequence(value, length, label)
    for item in items:
        if not isinstance(item, bool | np.bool_):
            raise ModelError(f"{label}: {quoted(item)} is not true or false.")
    return tuple(bool(item) for item in items)


def connection(lower: Sequence[int]) -> tuple[int, ...]:
    """Return a connection array; it must satisfy L(1) = 0 and 0 <= L(K) < K."""
    if not lower:
        raise ModelError("connection array is empty: a system needs at least one body.")
    if lower[0] != 0:
        raise ModelError(
            f"connection array starts with {quoted(lower[0])}, but body 1 is connected to the ground."
        )
    for k, j in enumerate(lower, start=1):
        if j == k:
            raise ModelError(f"connection array: body {k} is its own lower body.")
        if j < 0 or j > len(lower):
            raise ModelError(
                f"connection array: lower body {quoted(j)} of body {k} is out of range 0..{k - 1}."
            )
        if j > k:
            raise ModelError(
                f"connection array: body {k} has the lower body {j}, a higher number. Number bodies outward, "
                "so that every lower body has a lower number."
            )
    return tuple(lower)


def _assumed(value: Any, label: str) -> None:
    """Make sure that a value, as a caller passes it, is not negative by assumptions on symbols of SymPy."""
    if is_sympy(value) and value.is_extended_negative and value.free_symbols:
        raise ModelError(f"{label} {value} is negative by the assumptions on its symbols.")


def mass(given: Any, label: str) -> Number:
    """Return a mass (kg), which must not be negative; messages about its number call it `label`."""
    _assumed(given, "mass")
    value = number(given, label)
    if value_of(value) < 0:
        raise ModelError(f"mass {described(value)} kg is negative.")
    return value


def armature(given: Any, names: Sequence[str]) -> tuple[Number, ...]:
    """Return reflected inertias (kg m^2, kg) of freedoms with these names; none may be negative."""
    values: tuple[Number, ...] = numbers(given, (len(names),), "armature")
    for name, one, value in zip(names, listed(given) or (), values, strict=True):
        _assumed(one, f"armature: that of {name}")
        if value_of(value) < 0:
            raise ModelError(
                f"armature: that of {name} is {described(value)}. A reflected inertia is not negative."
            )
    return values


def inertia(given: Any, body: str) -> Matrix:
    """Return an inertia (kg m^2), which must be symmetric and positive semidefinite.

    Warns:
        KanegenWarning: If the principal moments violate the triangle inequality.
    """
    value: Matrix = numbers(given, (3, 3), f"body {quoted(body)}: inertia")
    for i, row in enumerate(listed(given) or ()):
        _assumed((listed(row) or ())[i], "inertia: the moment")
    matrix = np.array(map_numbers(value, value_of))
    if np.isnan(matrix).any():
        return value  # without default values of parameters nothing can be checked
    unit = _power_of_two(float(np.abs(matrix).max()))
    matrix = matrix / unit
    size = float(np.abs(matrix).max())
    for i, j in ((0, 1), (0, 2), (1, 2)):
        pair = (value[i][j], value[j][i])
        if abs(matrix[i, j] - matrix[j, i]) > INERTIA_ROUNDING * size or _differ(*pair):
            raise ModelError(f"inertia is not symmetric: entries [{i}][{j}] and [{j}][{i}] are {pair}.")
    moments = np.linalg.eigvalsh((matrix + matrix.T) / 2)
    if moments[0] < -INERTIA_ROUNDING * size:
        raise ModelError(
            f"inertia is not positive semidefinite: principal moments {(moments * unit).tolist()} kg m^2. "
            "Check the signs of the products of inertia."
        )
    if moments[2] > (moments[0] + moments[1]) * (1 + INERTIA_ROUNDING) + INERTIA_ROUNDING * size:
        warn(
            f"body {quoted(body)}: principal moments {(moments * unit).tolist()} kg m^2 violate the triangle "
            "inequality; no real body has them."
        )
    return _symmetric(value)


def _power_of_two(size: float) -> float:
    """Return the power of two next to `size`, by which numbers can be scaled without rounding."""
    return 2.0 ** (math.frexp(size)[1] - 1) if size else 1.0


def _differ(a: Number, b: Number) -> bool:
    """Return whether two numbers, which are not both plain floats, are different."""
    return not (isinstance(a, float) and isinstance(b, float)) and a != b


def _symmetric(value: Matrix) -> Matrix:
    """Return a matrix with the mean of opposite entries on both sides of the diagonal."""

    def entry(i: int, j: int) -> Number:
        a, b = value[i][j], value[j][i]
        return a / 2 + b / 2 if isinstance(a, float) and isinstance(b, float) else a

    xx, xy, xz = value[0][0], entry(0, 1), entry(0, 2)
    yy, yz, zz = value[1][1], entry(1, 2), value[2][2]
    return ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))


def orientation(value: Any, label: str) -> Matrix | Vector:
    """Return a constant orientation: a rotation matrix, or three angles (rad) that are not all plain floats.

    A matrix without parameters is rounded to doubles.
    """
    items = listed(value) or []
    if items and all(np.ndim(item) == 0 for item in items):
        angles: Vector = numbers(items, (3,), label)
        if not all(isinstance(angle, float) for angle in angles):
            return angles
        value = rotation_123(map_numbers(angles, value_of))
    matrix: Matrix = numbers(value, (3, 3), label)
    plain = map_numbers(matrix, value_of)
    if all(is_fixed(entry) for row in matrix for entry in row):
        matrix = plain
    c = np.array(plain)
    if np.isnan(c).any():
        return matrix  # without default values of parameters nothing can be checked
    with np.errstate(over="ignore", invalid="ignore"):
        defect = float(np.abs(c @ c.T - np.eye(3)).max())
    if not defect <= ORTHOGONALITY:
        raise ModelError(
            f"{label} is not a rotation: its rows are off from orthonormal by {defect:.1e}. "
            "Give all digits, or angles."
        )
    if np.linalg.det(c) < 0:
        raise ModelError(f"{label} is not a rotation: it is a reflection (determinant -1).")
    return nearest_rotation(plain) if plain == matrix and defect > ROUNDED_ROTATION else matrix


def unique(label: str, names: Sequence[str]) -> None:
    """Raise a `ModelError` if a name occurs twice."""
    seen: set[str] = set()
    for name in names:
        if name in seen:
            raise ModelError(f"{label} {quoted(name)} is used twice. Give every one its own.")
        seen.add(name)


_OF_BODIES = {
    *(kind.symbol for kind in COORDINATE_KINDS),
    *(f"{kind.symbol}dot" for kind in COORDINATE_KINDS),
    *(symbol for kind in SPEED_KINDS for symbol in (kind.symbol, kind.derivative)),
    *("F", "M", "tau"),
}
"""First parts of the symbols `<part>_K_<number>` of coordinates, speeds and loads of body K."""

_OF_POINTS = {"FP", "MP"}
"""First parts of the symbols of loads on points, which have the number of the point."""

_SYMBOL = re.compile(r"([A-Za-z]+)_([1-9][0-9]*)_[0-6]")


def parameter_names(parameters: Sequence[Parameter], number_of_bodies: int, number_of_points: int) -> None:
    """Raise a `ModelError` if a parameter has the name of the symbol of a coordinate, a speed or a load."""
    for parameter in parameters:
        match = _SYMBOL.fullmatch(parameter.name)
        for kind, parts, highest in (
            ("body", _OF_BODIES, number_of_bodies),
            ("point", _OF_POINTS, number_of_points),
        ):
            if match and match[1] in parts and int(match[2]) <= highest:
                raise ModelError(
                    f"parameter name {quoted(parameter.name)} already names a coordinate, speed or load of "
                    f"{kind} {match[2]}. Choose another name."
                )


def is_symbol_of_notes(name: str) -> bool:
    """Return whether a name has the form of the symbol of a coordinate, a speed or a load, such as `s_2_3`.

    Example:
        is_symbol_of_notes("theta_1_3")  # True
        is_symbol_of_notes("joint_1")  # False
    """
    match = _SYMBOL.fullmatch(name)
    return match is not None and match[1] in _OF_BODIES | _OF_POINTS


def store(instance: object, **values: Any) -> None:
    """Store checked values in a frozen dataclass, from its `__post_init__`."""
    for name, value in values.items():
        object.__setattr__(instance, name, value)


def file(path: object, label: str) -> Path | None:
    """Return the path of a file, absolute, so that it stays valid in another folder; None stays None.

    Raises:
        ModelError: If it is no path.
    """
    if path is None:
        return None
    try:
        return Path(path).absolute()  # type: ignore[arg-type]
    except TypeError:
        raise ModelError(f"{label}: {quoted(path)} is not the path of a file.") from None
