"""The matrices of small deviations from a state: derivatives of {xdot} and of the solution {ydot}.

With [A]{ydot} = {f} + {tau}, the derivative of {ydot} by a variable is [A]^-1 times that of {f} less that of
[A], times {ydot}. In an equilibrium {ydot} is zero, and the second part vanishes.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import Protocol

from sympy import Expr, ImmutableMatrix, Rational, S, Symbol, eye, zeros

from kanegen.errors import OptionError
from kanegen.linear.names import inputs_of, state_names
from kanegen.symbolic.closed.form import Simplifier
from kanegen.symbolic.closed.named_numbers import NamedNumbers
from kanegen.symbolic.definitions import Definition
from kanegen.symbolic.linear.outputs import Quantity, outputs_of
from kanegen.symbolic.linear.solving import Simplify, readable, solve
from kanegen.symbolic.linear.state import State
from kanegen.symbolic.linear.symbolic_model import SymbolicLinearModel, stacked
from kanegen.symbolic.linear.tangents import Tangents
from kanegen.symbolic.literal.dynamics import BodyEquations
from kanegen.symbolic.symbols import parameter


class Derivation(Protocol):
    """Equations of motion with named intermediates, such as `Equations`."""

    @property
    def latex_names(self) -> Mapping[Symbol, str]:
        """LaTeX by symbol, for all symbols of the equations."""

    @property
    def bodies(self) -> tuple[BodyEquations, ...]:
        """The equations of each body."""

    @property
    def definitions(self) -> tuple[Definition, ...]:
        """Definitions of the intermediates, in order of evaluation."""

    @property
    def x(self) -> ImmutableMatrix:
        """(m, 1) symbols of the coordinates."""

    @property
    def y(self) -> ImmutableMatrix:
        """(n, 1) symbols of the speeds."""

    @property
    def xdot(self) -> ImmutableMatrix:
        """(m, 1) rates of the coordinates, Eqs. (9), (45)."""

    @property
    def A(self) -> ImmutableMatrix:
        """(n, n) generalized mass matrix [A]."""

    @property
    def f(self) -> ImmutableMatrix:
        """(n, 1) right side {f} of the equations."""

    @property
    def quantities(self) -> Mapping[str, Quantity]:
        """Outputs of the table that have an expression, by name."""


def linear_model(
    equations: Derivation,
    state: State,
    numbers: Mapping[Expr, Fraction],
    inputs: Iterable[str] | str | None,
    outputs: Iterable[str] | str,
) -> SymbolicLinearModel:
    """Return the linear model of equations with named intermediates.

    Args:
        equations: The equations.
        state: The state, with the system as its author gave it.
        numbers: Values of symbols that stand for numbers of the model.
        inputs: Names of the freedoms on which a control acts, None for all.
        outputs: Names of outputs and of single states.

    Raises:
        OptionError: If a name does not exist, or a quantity is undefined in the state.
        SingularError: If [A] is singular in the state.
    """
    system, m, n = state.system, len(equations.x), len(equations.y)
    places = inputs_of(system.freedom_names, inputs)
    states = state_names(system.coordinate_names, system.speed_names)
    variables = [*equations.x, *equations.y]
    named = outputs_of(outputs, equations.quantities, dict(zip(states, variables, strict=True)))
    at = state.values | {symbol: Rational(*value.as_integer_ratio()) for symbol, value in numbers.items()}
    tangents = Tangents(at, variables, equations.definitions)
    A, A_by = tangents.of_matrix(equations.A)
    f, f_by = tangents.of_matrix(equations.f)
    short = partial(_entries, simplify=_simplifier(equations))
    numerators, determinant = solve(A, ImmutableMatrix(f + ImmutableMatrix(n, 1, state.tau)))
    ydot = short(numerators, determinant)
    if ydot.is_zero_matrix:
        numerators, determinant = ydot, S.One
    changes = [f_by[k] * determinant - A_by[k] * numerators for k in range(m + n)]
    controls = [ImmutableMatrix(n, 1, lambda i, _, at=place: S(int(i == at))) for place in places]
    solved, denominator = solve(A, ImmutableMatrix.hstack(*changes, *controls))
    xdot, xdot_by = tangents.of_matrix(equations.xdot)
    rates = _RateMap.of(tangents, xdot_by[m:], xdot, equations)
    rows = [tangents.of(value)[1] for _, value in named]
    return SymbolicLinearModel(
        name=system.name,
        state_names=states,
        input_names=tuple(f"tau.{system.freedom_names[place]}" for place in places),
        output_names=tuple(name for name, _ in named),
        A=stacked(
            short(ImmutableMatrix.hstack(*xdot_by)), short(solved[:, : m + n], denominator * determinant)
        ),
        B=stacked(zeros(m, len(places)), short(solved[:, m + n :], denominator)),
        C=short(ImmutableMatrix(len(rows), m + n, lambda i, j: rows[i].get(j, S.Zero))),
        D=ImmutableMatrix(zeros(len(rows), len(places))),
        x=short(ImmutableMatrix(m, 1, state.x)),
        y=short(ImmutableMatrix(n, 1, state.y)),
        tau=short(ImmutableMatrix(n, 1, state.tau)),
        xdot=short(xdot),
        ydot=ydot,
        rate_map=short(rates.value),
        rate_map_rate=short(rates.rate),
        parameters={parameter(one): one.value for one in system.parameters},
        names=equations.latex_names,
    )


def _simplifier(equations: Derivation) -> Simplify:
    """Return the function that shortens polynomials of sines and cosines, as closed forms are shortened."""
    simplifier = Simplifier(equations.bodies, (), NamedNumbers())

    def simplify(value: Expr) -> Expr:
        try:
            return simplifier.simplify(value)
        except OptionError:  # it is too long to be shortened
            return value

    return simplify


@dataclass(frozen=True)
class _RateMap:
    """[H] of {xdot} = [H]{y} in a state.

    Attributes:
        value: (m, n) [H].
        rate: (m, n) its time derivative.
    """

    value: ImmutableMatrix
    rate: ImmutableMatrix

    @classmethod
    def of(
        cls,
        tangents: Tangents,
        by_speeds: Iterable[ImmutableMatrix],
        xdot: ImmutableMatrix,
        equations: Derivation,
    ) -> _RateMap:
        """Return [H] and its time derivative from the columns of [H], the derivatives of {xdot} by {y}."""
        m, n = len(equations.x), len(equations.y)
        value = ImmutableMatrix.hstack(*by_speeds)
        if list(equations.xdot) == list(equations.y):
            return cls(ImmutableMatrix(eye(n)), ImmutableMatrix(zeros(m, n)))
        columns = []
        for speed in equations.y:
            _, slopes = tangents.of_matrix(ImmutableMatrix([one.diff(speed) for one in equations.xdot]))
            columns.append(sum((xdot[k] * slopes[k] for k in range(m)), ImmutableMatrix.zeros(m, 1)))
        return cls(value, ImmutableMatrix.hstack(*columns))


def _entries(matrix: ImmutableMatrix, denominator: Expr = S.One, *, simplify: Simplify) -> ImmutableMatrix:
    """Return a matrix over a denominator, with every entry in its short form."""
    return ImmutableMatrix(*matrix.shape, [readable(one, denominator, simplify) for one in matrix.flat()])
