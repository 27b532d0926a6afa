"""The rules that a model must satisfy, each with an error message that names the remedy."""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np

from kanegen.errors import KanegenWarning, ModelError
from kanegen.model.numbers import Matrix, Number, Parameter, Vector, listed, map_numbers, numbers, value_of
from kanegen.model.rotations import nearest_rotation, rotation_123

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
        raise ModelError(f"{label}: {value!r} is not an integer.")
    return int(value)


def sequence(value: Any, length: int, label: str) -> Sequence[Any]:
    """Return `value` as a list of exactly `length` items."""
    items = listed(value)
    if items is None:
        raise ModelError(f"{label}: expected {length} entries, got {value!r}.")
    if len(items) != length:
        raise ModelError(f"{label}: expected {length} entries, got {len(items)}.")
    return items


def instances(values: Any, kind: type[_T], label: str) -> tuple[_T, ...]:
    """Return `values` as a tuple of objects of the class `kind`."""
    items = listed(values)
    if items is None:
        raise ModelError(f"{label}: expected a sequence of {kind.__name__} objects, got {values!r}.")
    for item in items:
        if not isinstance(item, kind):
            raise ModelError(f"{label}: {item!r} is no {kind.__name__}.")
    return tuple(items)


def flags(value: Any, length: int, label: str) -> tuple[bool, ...]:
    """Return `value` as a tuple of exactly `length` flags."""
    items = sequence(value, length, label)
    for item in items:
        if not isinstance(item, bool | np.bool_):
            raise ModelError(f"{label}: {item!r} is not true or false.")
    return tuple(bool(item) for item in items)


def connection(lower: Sequence[int]) -> tuple[int, ...]:
    """Return a connection array; it must satisfy L(1) = 0 and 0 <= L(K) < K."""
    if not lower:
        raise ModelError("connection array is empty: a system needs at least one body.")
    if lower[0] != 0:
        raise ModelError(f"connection array starts with {lower[0]}, but body 1 is connected to the ground.")
    for k, j in enumerate(lower, start=1):
        if j == k:
            raise ModelError(f"connection array: body {k} is its own lower body.")
        if j < 0 or j > len(lower):
            raise ModelError(f"connection array: lower body {j} of body {k} is out of range 0..{k - 1}.")
        if j > k:
            raise ModelError(
                f"connection array: body {k} has the lower body {j}, a higher number. Number bodies outward, "
                "so that every lower body has a lower number."
            )
    return tuple(lower)


def mass(value: Number) -> Number:
    """Return a mass (kg), which must not be negative."""
    if value_of(value) < 0:
        raise ModelError(f"mass {value_of(value)!r} kg is negative.")
    return value


def inertia(value: Matrix, body: str) -> Matrix:
    """Return an inertia (kg m^2), which must be symmetric and positive semidefinite.

    Warns:
        KanegenWarning: If the principal moments violate the triangle inequality.
    """
    matrix = np.array(map_numbers(value, value_of))
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
        warnings.warn(
            f"body {body!r}: principal moments {(moments * unit).tolist()} kg m^2 violate the triangle "
            "inequality; no real body has them.",
            KanegenWarning,
            stacklevel=2,
        )
    return _symmetric(value)


def _power_of_two(size: float) -> float:
    """Return the power of two next to `size`, by which numbers can be scaled without rounding."""
    return 2.0 ** (math.frexp(size)[1] - 1) if size else 1.0


def _differ(a: Number, b: Number) -> bool:
    """Return whether two numbers, one of them a parameter, are different."""
    return (isinstance(a, Parameter) or isinstance(b, Parameter)) and a != b


def _symmetric(value: Matrix) -> Matrix:
    """Return a matrix with the mean of opposite entries on both sides of the diagonal."""

    def entry(i: int, j: int) -> Number:
        a, b = value[i][j], value[j][i]
        return a if isinstance(a, Parameter) or isinstance(b, Parameter) else a / 2 + b / 2

    xx, xy, xz = value[0][0], entry(0, 1), entry(0, 2)
    yy, yz, zz = value[1][1], entry(1, 2), value[2][2]
    return ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))


def orientation(value: Any) -> Matrix | Vector:
    """Return a constant orientation: a rotation matrix, or three angles (rad) where one is a parameter."""
    items = listed(value) or []
    if items and all(isinstance(item, Parameter) or np.ndim(item) == 0 for item in items):
        angles: Vector = numbers(items, (3,), "joint orientation")
        one, two, three = angles
        if isinstance(one, Parameter) or isinstance(two, Parameter) or isinstance(three, Parameter):
            return angles
        value = rotation_123((one, two, three))
    matrix: Matrix = numbers(value, (3, 3), "joint orientation")
    plain = map_numbers(matrix, value_of)
    c = np.array(plain)
    with np.errstate(over="ignore", invalid="ignore"):
        defect = float(np.abs(c @ c.T - np.eye(3)).max())
    if not defect <= ORTHOGONALITY:
        raise ModelError(
            f"joint orientation is not a rotation: its rows are off from orthonormal by {defect:.1e}. "
            "Give all digits, or angles."
        )
    if np.linalg.det(c) < 0:
        raise ModelError("joint orientation is not a rotation: it is a reflection (determinant -1).")
    return nearest_rotation(plain) if plain == matrix and defect > ROUNDED_ROTATION else matrix


def unique(label: str, names: Sequence[str]) -> None:
    """Raise a `ModelError` if a name occurs twice."""
    seen: set[str] = set()
    for name in names:
        if name in seen:
            raise ModelError(f"{label} {name!r} is used twice. Give every one its own.")
        seen.add(name)


_SYMBOL = re.compile(r"(?:theta|thetadot|thetaddot|omegahat|omegahatdot|s|sdot|sddot|F|M|tau)_(\d+)_[1-6]")


def parameter_names(parameters: Sequence[Parameter], number_of_bodies: int) -> None:
    """Raise a `ModelError` if a parameter has the name of the symbol of a coordinate, a speed or a load."""
    for parameter in parameters:
        match = _SYMBOL.fullmatch(parameter.name)
        if match and 1 <= int(match[1]) <= number_of_bodies:
            raise ModelError(
                f"parameter name {parameter.name!r} already names a coordinate, speed or load of body "
                f"{match[1]}. Choose another name."
            )


def store(instance: object, **values: Any) -> None:
    """Store checked values in a frozen dataclass, from its `__post_init__`."""
    for name, value in values.items():
        object.__setattr__(instance, name, value)
