"""`SymbolicLinearModel`: the matrices of small deviations from a state in symbols."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields

import numpy as np
import sympy
from numpy.typing import NDArray
from sympy import ImmutableMatrix, Symbol, zeros

from kanegen.choices import did_you_mean
from kanegen.errors import OptionError, quoted
from kanegen.linear import LinearModel
from kanegen.symbolic import notebook

MATRICES = ("A", "B", "C", "D")
"""The matrices of a linear model."""


@dataclass(frozen=True, eq=False, repr=False)
class SymbolicLinearModel:
    """Small deviations from a state: d/dt {xi} = [A]{xi} + [B]{u}, {eta} = [C]{xi} + [D]{u}, in SymPy.

    The names, and what the model means next to a motion, are those of `kanegen.linear.LinearModel`, which
    `numeric` makes of this one. Entries are rational functions in factors. They contain the run-time
    parameters and the symbols of the state.

    Attributes:
        name: Name of the system.
        state_names: N names: "x.<coordinate>", then "y.<speed>".
        input_names: r names: "tau.<freedom>".
        output_names: q names of the outputs.
        A: (N, N) derivatives of {xdot} and {ydot} with respect to {x} and {y}.
        B: (N, r) derivatives of {xdot} and {ydot} with respect to the inputs.
        C: (q, N) derivatives of the outputs with respect to {x} and {y}.
        D: (q, r) derivatives of the outputs with respect to the inputs.
        x: (m, 1) coordinates of the state (rad, m, 1).
        y: (n, 1) generalized speeds of the state (rad/s, m/s).
        tau: (n, 1) generalized forces in the state (N m, N).
        xdot: (m, 1) rates of the coordinates in the state.
        ydot: (n, 1) rates of the speeds in the state (rad/s^2, m/s^2); zero in an equilibrium.
        rate_map: (m, n) matrix [H] of {xdot} = [H]{y}, Eq. (9).
        rate_map_rate: (m, n) time derivative of [H] in the state.
        parameters: Default values of the run-time parameters.
        names: LaTeX of the symbols, with which a notebook shows the matrices.

    Example:
        model = kg.derive(kg.load("models/cart_pole.toml")).linearize(inputs=["cart_position"])
        model.A, model.B
        model.numeric().modes
    """

    name: str
    state_names: tuple[str, ...]
    input_names: tuple[str, ...]
    output_names: tuple[str, ...]
    A: ImmutableMatrix
    B: ImmutableMatrix
    C: ImmutableMatrix
    D: ImmutableMatrix
    x: ImmutableMatrix
    y: ImmutableMatrix
    tau: ImmutableMatrix
    xdot: ImmutableMatrix
    ydot: ImmutableMatrix
    rate_map: ImmutableMatrix
    rate_map_rate: ImmutableMatrix
    parameters: Mapping[Symbol, float]
    names: Mapping[Symbol, str] = field(default_factory=dict)

    def __repr__(self) -> str:
        """The name of the system and the numbers of states, inputs and outputs."""
        states, inputs, outputs = map(len, (self.state_names, self.input_names, self.output_names))
        return f"<SymbolicLinearModel of {self.name}: {states} states, {inputs} inputs, {outputs} outputs>"

    def _repr_latex_(self) -> str:
        """The matrices that are not empty, for a notebook; what does not fit is cut, with a hint."""
        shown = {name: getattr(self, name) for name in MATRICES if len(getattr(self, name))}
        parts = [
            notebook.matrix(f"[{name}]", name, value, self.names, f"model.{name}")
            for name, value in shown.items()
        ]
        return notebook.display(line for part in parts for line in part)

    @property
    def is_equilibrium(self) -> bool:
        """Whether the state is at rest: {xdot} and {ydot} are zero."""
        return self.xdot.is_zero_matrix is True and self.ydot.is_zero_matrix is True

    @property
    def symbols(self) -> tuple[Symbol, ...]:
        """The symbols that occur, by name."""
        every = set().union(*(getattr(self, name).free_symbols for name in _MATRIX_FIELDS))
        return tuple(sorted(every, key=str))

    def numeric(self, values: Mapping[str, float] | None = None) -> LinearModel:
        """Return the model in numbers.

        Args:
            values: Values of symbols by name; parameters that it leaves out have their defaults.

        Raises:
            OptionError: If there is no such symbol, or a symbol of the state has no value.

        Example:
            model.numeric({"half_length": 0.4}).stability
        """
        numbers: dict[Symbol, float] = dict(self.parameters)
        known = {symbol.name: symbol for symbol in (*self.symbols, *self.parameters)}
        for name, value in (values or {}).items():
            if name not in known:
                raise OptionError(f"values: there is no {quoted(name)}. {did_you_mean(name, known)}")
            numbers[known[name]] = value
        missing = [symbol.name for symbol in self.symbols if symbol not in numbers]
        if missing:
            raise OptionError(f"values: {', '.join(missing)} needs a value, such as {{'{missing[0]}': 0.1}}.")
        exact = {symbol: sympy.Float(value, 40) for symbol, value in numbers.items()}

        def array(matrix: ImmutableMatrix) -> NDArray[np.float64]:
            entries = [float(entry.xreplace(exact).evalf(30)) for entry in matrix.flat()]
            return np.array(entries, np.float64).reshape(matrix.shape) + 0.0

        square = {name: array(getattr(self, name)) for name in (*MATRICES, "rate_map", "rate_map_rate")}
        rows = {name: array(getattr(self, name)).ravel() for name in ("x", "y", "tau", "xdot", "ydot")}
        return LinearModel(
            name=self.name,
            state_names=self.state_names,
            input_names=self.input_names,
            output_names=self.output_names,
            **square,
            **rows,
        )


_MATRIX_FIELDS = tuple(one.name for one in fields(SymbolicLinearModel) if one.type == "ImmutableMatrix")
"""The attributes that are matrices."""


def stacked(upper: ImmutableMatrix, lower: ImmutableMatrix) -> ImmutableMatrix:
    """Return one matrix above another."""
    if upper.shape[1] == 0:
        return ImmutableMatrix(zeros(upper.shape[0] + lower.shape[0], 0))
    return ImmutableMatrix(upper.col_join(lower))
