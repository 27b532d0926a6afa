"""Many sets of run-time parameters at once: an array of them, and the sets with which no model is usable.

A set is refused by `System.with_parameters` alone, which takes milliseconds. The conditions here, on all sets
at once, only find the sets that are worth asking it about.
"""

from __future__ import annotations

import math
import operator
import warnings
from collections.abc import Callable, Iterator, Mapping
from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kanegen.choices import did_you_mean
from kanegen.errors import ArrayError, ModelError, quoted
from kanegen.model.arguments import Floats, floats
from kanegen.model.expression import Parameter, node_of
from kanegen.model.force_elements.elements import JointFriction, Spring
from kanegen.model.nodes import PI, Leaf, Operation, Power, folded
from kanegen.model.numbers import Matrix, Number, map_numbers, parameters_of
from kanegen.model.system_fields import SystemFields
from kanegen.model.system_numbers import numbers_of
from kanegen.model.validation import INERTIA_ROUNDING

ParameterSets = ArrayLike | Mapping[str, ArrayLike]
"""(P,) or (B, P) values in the order of a system's parameters, or a number or (B,) values by name."""

Columns = Mapping[str, NDArray[np.float64]]
"""(B,) values of each parameter by name."""

_DOUBLE = np.dtype(float)

_OPERATIONS: dict[str, Callable[..., Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": np.divide,
    "negate": operator.neg,
    PI: lambda: math.pi,
    "atan2": np.arctan2,
    "max": np.maximum,
    "min": np.minimum,
    **{
        name: getattr(np, name) for name in ("abs", "cos", "exp", "log", "sign", "sin", "sqrt", "tan", "tanh")
    },
    "<": np.less,
    "<=": np.less_equal,
    ">": np.greater,
    ">=": np.greater_equal,
    "and": np.logical_and,
    "or": np.logical_or,
    "not": np.logical_not,
    "if": np.where,
}
"""The operations of expressions in NumPy."""


def parameter_sets(
    values: ParameterSets, usual: Mapping[str, float], dtype: np.dtype[Any] = _DOUBLE
) -> ArrayLike:
    """Return values of all parameters, (P,) or (B, P), in the order of `usual`.

    Args:
        values: Values as an array, which is returned as it is, or by name.
        usual: Values by name of the parameters that a table leaves out.
        dtype: Type of the numbers.

    Raises:
        ModelError: If there is no parameter of a name.
        ArrayError: If a value by name is neither a number nor a row of numbers, or two rows differ in length.

    Example:
        parameter_sets({"m1": [1.0, 2.0]}, {"m1": 3.0, "m2": 4.0})  # [[1, 4], [2, 4]]
    """
    if not isinstance(values, Mapping):
        return values
    for name in values:
        if name not in usual:
            raise ModelError(f"unknown parameter {quoted(name)}. {did_you_mean(name, usual)}")
    columns = {name: _column(name, values[name], dtype) for name in values}
    rows = {name: len(column) for name, column in columns.items() if column.ndim}
    if len(set(rows.values())) > 1:
        sizes = ", ".join(f"{quoted(name)} {count}" for name, count in rows.items())
        raise ArrayError(f"parameters: the numbers of values for states of a batch differ: {sizes}.")
    every = [columns.get(name, np.asarray(usual[name], dtype)) for name in usual]
    return np.stack(np.broadcast_arrays(*every), axis=-1)


def _column(name: object, value: ArrayLike, dtype: np.dtype[Any]) -> Floats:
    """Return the values of one parameter, () or (B,)."""
    column = floats(f"parameter {quoted(name)}", value, dtype)
    if column.ndim > 1:
        raise ArrayError(f"parameter {quoted(name)}: expected a number or shape (B,), got {column.shape}.")
    return column


def suspects(system: SystemFields, columns: Columns) -> NDArray[np.intp]:
    """Return the rows of all sets that a model may refuse, and of none that it certainly takes.

    A number must be finite; masses, reflected inertias, damping of contacts, friction and rest lengths are
    not negative, the smoothing of friction is positive, and no moment of inertia is negative.

    Args:
        system: The system, with its parameters at usable defaults.
        columns: (B,) values of each parameter of the system by name.
    """
    count = len(next(iter(columns.values())))
    if any(map(_parameterised, _of_other_conditions(system))):
        return np.arange(count)

    def valued(number: Number) -> NDArray[np.float64]:
        return np.broadcast_to(_value(number, columns), count)

    with np.errstate(all="ignore"):
        bad = [~np.isfinite(columns[name]) for name in columns]
        bad += [~np.isfinite(valued(one)) for one in filter(_parameterised, numbers_of(system))]
        bad += [valued(one) < 0 for one in filter(_parameterised, _not_negative(system))]
        bad += [valued(one) <= 0 for one in filter(_parameterised, _positive(system))]
        for body in system.bodies:
            if any(_parameterised(one) for row in body.inertia for one in row):
                bad.append(_indefinite(body.inertia, valued))
    return np.flatnonzero(reduce(np.logical_or, bad))


def least_values(system: SystemFields) -> dict[str, float]:
    """Return by name the smallest value, 0, of each parameter that is itself a number not below it.

    These are masses, moments of inertia about axes of a body, and the further numbers of `suspects`. What a
    parameter may be that stands in an expression depends on others, so it has none here.

    Example:
        least_values(kg.load("models/double_pendulum.toml"))  # {"m1": 0.0, "m2": 0.0}
    """
    moments = (body.inertia[axis][axis] for body in system.bodies for axis in range(3))
    numbers = (*_not_negative(system), *_positive(system), *moments)
    return {number.name: 0.0 for number in numbers if isinstance(number, Parameter)}


def _parameterised(number: Number) -> bool:
    return bool(parameters_of(number))


def _not_negative(system: SystemFields) -> Iterator[Number]:
    """Yield the numbers that a model requires not to be negative."""
    for body in system.bodies:
        yield body.mass
        yield from body.joint.armature
    yield from (contact.damping for contact in system.contacts)
    for element in system.force_elements:
        if isinstance(element, JointFriction):
            yield element.friction
        elif isinstance(element, Spring):
            yield element.rest_length


def _positive(system: SystemFields) -> Iterator[Number]:
    """Yield the numbers that a model requires to be positive."""
    for element in system.force_elements:
        if isinstance(element, JointFriction):
            yield element.smoothing


def _of_other_conditions(system: SystemFields) -> Iterator[Number]:
    """Yield the numbers on which a model has conditions that only it can test."""
    for rotor in system.rotors:
        yield from (rotor.inertia, rotor.ratio)
    for coupling in system.couplings:
        yield from coupling.numbers()
    orientations = [body.joint.orientation for body in system.bodies]
    for rows in (*orientations, *(frame.orientation for frame in system.frames)):
        yield from (entry for row in rows if isinstance(row, tuple) for entry in row)
    if system.rotors:  # the inertia of a body contains that of its rotors
        yield from (entry for body in system.bodies for row in body.inertia for entry in row)


def _indefinite(inertia: Matrix, valued: Callable[[Number], Floats]) -> NDArray[np.bool_]:
    """Return (B,) where a principal moment may be negative, or is not finite."""
    matrices = np.moveaxis(np.array(map_numbers(inertia, valued)), -1, 0)
    is_finite = np.isfinite(matrices).all(axis=(1, 2))
    moments = np.linalg.eigvalsh(np.where(is_finite[:, None, None], matrices, 0.0))
    size = np.abs(matrices).max(axis=(1, 2))
    is_positive = moments[:, 0] >= -INERTIA_ROUNDING / 2 * size
    is_bad: NDArray[np.bool_] = ~(is_finite & is_positive)
    return is_bad


def _value(number: Number, columns: Columns) -> Any:
    """Return the values of a number for all sets, rounded at every operation."""

    def leaf(node: Leaf) -> Any:
        value = node.value if hasattr(node, "value") else math.nan  # a number has no variables
        return columns[value.name] if isinstance(value, Parameter) else np.float64(value)

    def operation(node: Operation | Power, operands: list[Any]) -> Any:
        if isinstance(node, Power):
            return operands[0] ** np.float64(node.exponent)
        return _OPERATIONS[node.operator](*operands)

    return folded(node_of(number), leaf, operation)


def refusals(
    system: SystemFields,
    columns: Columns,
    with_parameters: Callable[[Mapping[str, float]], object],
) -> dict[int, str]:
    """Return why no model has the parameters of a set, by row of the set; {} where all are usable.

    Args:
        system: The system, with its parameters at usable defaults.
        columns: (B,) values of each parameter of the system by name.
        with_parameters: Function that returns the system with other parameters, or raises a `ModelError`.
    """
    found = {}
    for row in suspects(system, columns):
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                with_parameters({name: float(column[row]) for name, column in columns.items()})
        except ModelError as error:
            found[int(row)] = str(error)
    return found
