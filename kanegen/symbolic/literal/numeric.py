"""The literal equations as NumPy functions, made by SymPy's `lambdify`: slow, for small tasks and checks."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import sympy
from numpy.typing import ArrayLike, NDArray
from sympy import Dummy, Expr, ImmutableMatrix, Symbol

from kanegen.errors import ArrayError, quoted
from kanegen.model.system import System
from kanegen.symbolic.definitions import Definition
from kanegen.symbolic.state_symbols import StateSymbols
from kanegen.symbolic.symbols import (
    force,
    parameter,
    point_force,
    point_moment,
    time,
    torque,
)

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class NumericEquations:
    """[A] and {f} as functions of NumPy arrays.

    Attributes:
        system: The system whose equations they are.
    """

    system: System
    _mass_matrix: Callable[..., Any]
    _forcing: Callable[..., Any]

    def mass_matrix(
        self,
        x: ArrayLike,
        parameters: Mapping[str, float] | None = None,
        prescribed: ArrayLike | None = None,
    ) -> Floats:
        """Return the generalized mass matrix [A], (n, n), of Eq. (43).

        Example:
            numeric = kg.derive(kg.load("models/double_pendulum.toml")).lambdify()
            numeric.mass_matrix([0.1, 0.2])

        Args:
            x: Coordinates (rad, m, 1).
            parameters: Values of parameters that differ from their defaults, by name.
            prescribed: (3, p) values, rates and second derivatives of the prescribed freedoms.

        Raises:
            ArrayError: If `x` has another shape, or holds anything but real numbers.
            ModelError: If a parameter is unknown or its value makes the model unusable.
        """
        m = len(self.system.coordinates)
        arguments = (_array(x, (m,), "x"), self._motion(prescribed), self._values(parameters))
        return np.array(self._mass_matrix(*arguments), dtype=float)

    def forcing(
        self,
        x: ArrayLike,
        y: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        parameters: Mapping[str, float] | None = None,
        prescribed: ArrayLike | None = None,
        point_force: ArrayLike | None = None,
        point_moment: ArrayLike | None = None,
        t: float = 0.0,
    ) -> Floats:
        """Return the right side {f}, (n,), of Eq. (44).

        Example:
            numeric = kg.derive(kg.load("models/double_pendulum.toml")).lambdify()
            numeric.forcing([0.1, 0.2], [0.0, 0.0])

        Args:
            x: Coordinates (rad, m, 1).
            y: (n,) generalized speeds (rad/s, m/s).
            force: (N, 3) loads {F'_K} (N); rows of bodies that take no loads are not read.
            torque: (N, 3) loads {M'_K} (N m); rows of bodies that take no loads are not read.
            parameters: Values of parameters that differ from their defaults, by name.
            prescribed: (3, p) values, rates and second derivatives of the prescribed freedoms.
            point_force: (P, 3) forces at the points (N); rows of points that take no loads are not read.
            point_moment: (P, 3) moments on the bodies of the points (N m), read for the same rows.
            t: Time (s).

        Raises:
            ArrayError: If an array has another shape, or holds anything but real numbers.
            ModelError: If a parameter is unknown or its value makes the model unusable.
        """
        m, n = len(self.system.coordinates), len(self.system.freedoms)
        state = (_array(x, (m,), "x"), _array(y, (n,), "y"), self._motion(prescribed))
        bodies, points = self.system.number_of_bodies, len(self.system.points)
        loads = (
            _load(force, bodies, "force"),
            _load(torque, bodies, "torque"),
            _load(point_force, points, "point_force"),
            _load(point_moment, points, "point_moment"),
        )
        arguments = (*state, *loads, [float(t)], self._values(parameters))
        with np.errstate(invalid="ignore", divide="ignore"):  # also branches are computed that are not taken
            return np.array(self._forcing(*arguments), dtype=float).ravel()

    def _motion(self, prescribed: ArrayLike | None) -> Floats:
        """Return (3 p,) prescribed values, rates and second derivatives; None stands for p = 0."""
        count = len(self.system.prescribed)
        rows = np.zeros((3, 0)) if prescribed is None else prescribed
        return _array(rows, (3, count), "prescribed").ravel()

    def _values(self, changed: Mapping[str, float] | None) -> list[float]:
        """Return the values of all parameters, some of them changed by name."""
        system = self.system.with_parameters(changed or {})
        return [parameter.value for parameter in system.parameters]


def numeric(
    system: System,
    symbols: StateSymbols,
    A: ImmutableMatrix,
    f: ImmutableMatrix,
    definitions: Sequence[Definition],
) -> NumericEquations:
    """Return functions that evaluate [A] and {f}.

    Args:
        system: The system whose equations they are.
        symbols: The symbols of its coordinates and speeds.
        A: (n, n) [A].
        f: (n, 1) {f}.
        definitions: The definitions of the intermediates in [A] and {f}.
    """
    every = [(k, axis) for k in range(1, system.number_of_bodies + 1) for axis in range(3)]
    x, y, motion = ([*of(system)] for of in (symbols.coordinates, symbols.speeds, symbols.prescribed))
    at_points = [(k, axis) for k in range(1, len(system.points) + 1) for axis in range(3)]
    inputs = (force, every), (torque, every), (point_force, at_points), (point_moment, at_points)
    loads = [[symbol(k, axis) for k, axis in places] for symbol, places in inputs]
    # A parameter or a freedom may have the name of a function, such as sin; a Dummy cannot.
    parameters = [parameter(each) for each in system.parameters]
    private = {symbol: Dummy(symbol.name) for symbol in (*parameters, *x, *y, *motion)}
    A, f = A.xreplace(private), f.xreplace(private)
    definitions = [replace(d, value=d.value.xreplace(private)) for d in definitions]
    x, y, motion, parameters = ([private[one] for one in part] for part in (x, y, motion, parameters))
    return NumericEquations(
        system,
        _function([x, motion, parameters], A, definitions),
        _function([x, y, motion, *loads, [time()], parameters], f, definitions),
    )


def _function(
    arguments: list[list[Symbol]], matrix: ImmutableMatrix, definitions: Sequence[Definition]
) -> Callable[..., Any]:
    """Return the NumPy function of a matrix, which evaluates the definitions that it needs first."""
    needed = needed_definitions(definitions, matrix)

    def common(expressions: Any) -> tuple[list[tuple[Symbol, Expr]], Any]:
        """Return (replacements, reduced): the definitions, or the common subexpressions that SymPy finds."""
        if needed:
            return [(definition.symbol, definition.value) for definition in needed], expressions
        replacements, reduced = sympy.cse(expressions, list=False)
        return replacements, reduced

    function: Callable[..., Any] = sympy.lambdify(arguments, matrix, modules="numpy", cse=common)
    return function


def needed_definitions(
    definitions: Sequence[Definition], expressions: Iterable[Expr]
) -> tuple[Definition, ...]:
    """Return the definitions that `expressions` depend on, directly or through others, in their order."""
    wanted: set[Symbol] = set()
    for expression in expressions:
        wanted |= expression.free_symbols
    needed: list[Definition] = []
    for definition in reversed(definitions):
        if definition.symbol in wanted:
            needed.append(definition)
            wanted |= definition.value.free_symbols
    return tuple(reversed(needed))


def _load(load: ArrayLike | None, rows: int, label: str) -> Floats:
    """Return a load, (3 rows,), zeros where there is none; `label` is its name in error messages."""
    return np.zeros(3 * rows) if load is None else _array(load, (rows, 3), label).ravel()


def _array(value: ArrayLike, shape: tuple[int, ...], label: str) -> Floats:
    """Return an argument as an array of that shape; `label` is its name in error messages."""
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise ArrayError(f"{label}: expected real numbers of shape {shape}, got {quoted(value)}.") from None
    if array.shape != shape:
        raise ArrayError(f"{label} has shape {array.shape}; expected {shape}.")
    return array
