"""Linear models of small deviations from a state, by the derivatives in C."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kanegen.choices import did_you_mean
from kanegen.errors import ArrayError, OptionError, quoted
from kanegen.library.derivatives import Derivatives
from kanegen.library.dynamics import Dynamics
from kanegen.library.quantities import Quantities
from kanegen.library.quantity_derivatives import QuantityDerivatives
from kanegen.linear import LinearModel
from kanegen.linear.names import inputs_of, names_of, state_names
from kanegen.model.arguments import NamedInputs, floats
from kanegen.model.components import vector_components
from kanegen.model.values_by_name import finite_in_order
from kanegen.recursion.outputs import OUTPUTS

Doubles = NDArray[np.float64]


LINEAR_OUTPUTS = (
    "point_positions",
    "point_velocities",
    "point_accelerations",
    "kinetic_energy",
    "potential_energy",
    "momentum",
    "mass_center",
)
"""Outputs of the table that a linear model may have as its own."""

OF_MOTION = ("forward_dynamics", "forward_dynamics_derivatives")
"""Outputs of C that every linear model needs."""

OF_RATES = ("coordinate_rates", "coordinate_rates_derivatives")
"""Outputs of C that a linear model needs where speeds are no rates of coordinates."""

NEARBY = 2.0**-20
"""Share of a coordinate or speed by which it is moved to see what rounding of it does."""


def outputs_needed(speeds_are_rates: bool, outputs: Iterable[str]) -> tuple[str, ...]:
    """Return the outputs that C must have for a linear model.

    Args:
        speeds_are_rates: Whether {xdot} = {y}.
        outputs: Outputs of the linear model; names of states need nothing.
    """
    needed = [*OF_MOTION, *(() if speeds_are_rates else OF_RATES)]
    for name in outputs:
        if name in LINEAR_OUTPUTS:
            needed += [
                f"{name}_derivatives",
                *(["point_jacobians"] if "ydot" in OUTPUTS[name].inputs else []),
            ]
    return tuple(dict.fromkeys(needed))


class Linearization(Dynamics, Quantities, Derivatives, QuantityDerivatives):
    """The method `linearize`."""

    def linearize(
        self,
        x: ArrayLike | Mapping[str, float] | None = None,
        y: ArrayLike | Mapping[str, float] | None = None,
        tau: ArrayLike | Mapping[str, float] | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        *,
        inputs: Iterable[str] | str | None = None,
        outputs: Iterable[str] | str = (),
        **further: Unpack[NamedInputs],
    ) -> LinearModel:
        """Return the linear model of small deviations from one state.

        Its matrices are the derivatives in C, without differences. Loads, prescribed motions and the time
        are held at the values that are passed here, by default 0.

        Args:
            x: (m,) coordinates, rad, m or 1, or some by name; the others are neutral, see
                `System.neutral_coordinates`.
            y: (n,) generalized speeds, rad/s and m/s, or some by name; the others are 0.
            tau: (n,) generalized forces, N m and N, or some by name; the others are 0.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Names of the freedoms on which a control acts; by default all of them.
            outputs: Names of outputs such as "point_positions", or of single states such as "x.pole".
            further: Inputs that only some systems have, as in `forcing`.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a value of the state is not finite.
            OptionError: If a name does not exist, a value by name is no finite number, or the library was
                built without an output that is needed; `kg.linearize` builds what it needs.
            StatusError: See `with_on_status`; by default a `SingularError` if [A] is singular in the state.

        Example:
            library = kg.build(system, ("forward_dynamics", "forward_dynamics_derivatives"))
            model = library.linearize({"q1": 0.3}, inputs=["q1"])
        """
        if self.storage == "double-double":
            raise OptionError(
                f"the arrays of system {quoted(self.name)} hold double-double numbers. Build it with "
                'storage="double".'
            )
        names = outputs_of(self, outputs)
        for needed in outputs_needed(self.source.model.speeds_are_rates, names):
            if needed not in self.outputs:
                raise self._absent(needed)
        columns = inputs_of(self.freedom_names, inputs)
        if self.prescribed_names and "prescribed" in self.further_inputs:
            further.setdefault("prescribed", np.zeros((3, len(self.prescribed_names))))
        if "t" in self.further_inputs:
            further.setdefault("t", 0.0)
        state = _State(self, x, y, tau)
        point = state.x, state.y
        ydot = np.array(self.forward_dynamics(*point, state.tau, force, torque, **further), np.float64)
        slopes = np.array(
            self.forward_dynamics_derivatives(*point, state.tau, force, torque, **further), np.float64
        )
        by = self.derivative_columns("forward_dynamics_derivatives")
        rates = _Rates(self, state, further)
        A = np.block([[rates.by_x, rates.map], [slopes[:, by["x"]], slopes[:, by["y"]]]])
        B = np.concatenate([np.zeros((len(state.x), len(columns))), slopes[:, by["tau"]][:, columns]])
        moved = _moved(slopes, self._slopes_nearby(state, force, torque, further))
        uncertainty = np.zeros_like(A)
        uncertainty[len(state.x) :] = np.concatenate([moved[:, by["x"]], moved[:, by["y"]]], axis=1)
        rows = _Outputs(self, state, ydot, A, B, further)
        output_names, C, D = rows.matrices(names)
        return LinearModel(
            name=self.name,
            state_names=state_names(self.coordinate_names, self.speed_names),
            input_names=tuple(f"tau.{self.freedom_names[place]}" for place in columns),
            output_names=output_names,
            **{"A": A + 0.0, "B": B + 0.0, "C": C + 0.0, "D": D + 0.0},  # no zero has a sign
            **{"x": state.x, "y": state.y, "tau": state.tau, "xdot": rates.xdot, "ydot": ydot},
            rate_map=rates.map,
            rate_map_rate=rates.map_rate,
            uncertainty=uncertainty,
        )

    def _slopes_nearby(
        self, state: _State, force: ArrayLike | None, torque: ArrayLike | None, further: NamedInputs
    ) -> Doubles:
        """Return (m + n, n, K) derivatives of {ydot}, each coordinate and speed in turn moved by `NEARBY`."""
        point = np.concatenate([state.x, state.y])
        many = point + np.diag(NEARBY * point)
        m = len(state.x)
        tau = np.broadcast_to(state.tau, (len(many), len(state.tau))).copy()
        loads = (
            None if one is None else np.repeat(np.asarray(one)[None], len(many), 0) for one in (force, torque)
        )
        found = self.with_on_status("ignore").forward_dynamics_derivatives(
            many[:, :m].copy(), many[:, m:].copy(), tau, *loads, **further
        )
        return np.asarray(found, np.float64)


def outputs_of(library: Quantities, asked: Iterable[str] | str) -> tuple[str, ...]:
    """Return the names of the outputs of a linear model, checked.

    Raises:
        OptionError: If there is neither an output nor a state of a name.
    """
    known = (*LINEAR_OUTPUTS, *state_names(library.coordinate_names, library.speed_names))
    names = names_of("outputs", asked)
    for name in names:
        if name not in known:
            raise OptionError(
                f"outputs: a linear model has no output {quoted(name)}. {did_you_mean(name, known)}"
            )
    return names


def _moved(slopes: Doubles, nearby: Doubles) -> Doubles:
    """Return by how much rounding of a state moves derivatives in it; zero where they do not exist nearby."""
    changes = np.abs(np.nan_to_num(nearby - slopes, posinf=0.0, neginf=0.0)).sum(axis=0)
    found: Doubles = changes * (np.finfo(np.float64).eps / NEARBY)
    return found


class _State:
    """A state in which a library is linearized, as arrays."""

    def __init__(self, library: Quantities, x: Any, y: Any, tau: Any) -> None:
        neutral = np.array(library.source.model.neutral_coordinates)
        self.x = _doubles("x", x, library.coordinate_names, neutral)
        self.y = _doubles("y", y, library.speed_names, np.zeros(library.n))
        self.tau = _doubles("tau", tau, library.freedom_names, np.zeros(library.n))


def _doubles(label: str, given: Any, names: Sequence[str], defaults: Doubles) -> Doubles:
    """Return values in order as doubles, from a row or a table of them."""
    if isinstance(given, Mapping) or given is None:
        given = finite_in_order(label, given, names, defaults.tolist())
    found: Doubles = np.asarray(floats(label, given, np.dtype(np.float64)), np.float64)
    if found.shape != (len(names),):
        raise ArrayError(f"{label}: expected shape ({len(names)},), got {found.shape}.")
    if not np.isfinite(found).all():
        place = int(np.flatnonzero(~np.isfinite(found))[0])
        raise ArrayError(f"{label}: the value of {quoted(names[place])} is no finite number.")
    return found


class _Rates:
    """{xdot} = [H]{y} in a state: [H], its time derivative, and the derivatives of {xdot}.

    Attributes:
        map: (m, n) [H], by Eq. (9), or the identity.
        map_rate: (m, n) time derivative of [H].
        by_x: (m, m) derivatives of {xdot} by {x}.
        xdot: (m,) rates of the coordinates.
    """

    def __init__(self, library: Linearization, state: _State, further: NamedInputs) -> None:
        m, n = len(state.x), len(state.y)
        self.map, self.map_rate, self.by_x = np.eye(m, n), np.zeros((m, n)), np.zeros((m, m))
        self.xdot = state.y
        if library.source.model.speeds_are_rates:
            return
        by = library.derivative_columns("coordinate_rates_derivatives")
        unit = np.concatenate([state.y[None], np.eye(n)])
        many = np.repeat(state.x[None], n + 1, axis=0)
        slopes = np.array(library.coordinate_rates_derivatives(many, unit, **further), np.float64)
        self.map, self.by_x = slopes[0][:, by["y"]], slopes[0][:, by["x"]]
        self.xdot = np.array(library.coordinate_rates(state.x, state.y, **further), np.float64)
        self.map_rate = (slopes[1:][:, :, by["x"]] @ self.xdot).T


class _Outputs:
    """Rows of [C] and [D] of the outputs of a linear model in a state."""

    def __init__(
        self,
        library: Linearization,
        state: _State,
        ydot: Doubles,
        A: Doubles,
        B: Doubles,
        further: NamedInputs,
    ) -> None:
        self._library, self._state, self._ydot, self._further = library, state, ydot, further
        self._A, self._B = A, B
        self._states = state_names(library.coordinate_names, library.speed_names)

    def matrices(self, names: Iterable[str]) -> tuple[tuple[str, ...], Doubles, Doubles]:
        """Return the names of all rows, [C] and [D]."""
        rows = [row for name in names for row in self._rows(name)]
        N, r = self._B.shape
        C = np.array([c for _, c, _ in rows], np.float64).reshape(len(rows), N)
        D = np.array([d for _, _, d in rows], np.float64).reshape(len(rows), r)
        return tuple(name for name, _, _ in rows), C, D

    def _rows(self, name: str) -> Iterator[tuple[str, Doubles, Doubles]]:
        """Yield name and rows of [C] and [D] for each element of an output."""
        N, r = self._B.shape
        if name in self._states:
            yield name, np.eye(N)[self._states.index(name)], np.zeros(r)
            return
        given = {"x": self._state.x, "y": self._state.y, "ydot": self._ydot}
        arguments = [given[one] for one in OUTPUTS[name].arguments]
        slopes = np.array(getattr(self._library, f"{name}_derivatives")(*arguments, **self._further))
        by = self._library.derivative_columns(f"{name}_derivatives")
        m = len(self._state.x)
        C, D = np.zeros((*slopes.shape[:-1], N)), np.zeros((*slopes.shape[:-1], r))
        C[..., :m] = slopes[..., by["x"]]
        if "y" in by:
            C[..., m:] = slopes[..., by["y"]]
        if "ydot" in given and "ydot" in OUTPUTS[name].inputs:
            partial = np.array(self._library.point_jacobians(self._state.x, **self._further))
            C, D = C + partial @ self._A[m:], D + partial @ self._B[m:]
        for labels, c, d in zip(
            self._elements(name, slopes.shape[:-1]), C.reshape(-1, N), D.reshape(-1, r), strict=True
        ):
            yield ".".join([name, *labels]), c, d

    def _elements(self, name: str, shape: tuple[int, ...]) -> Iterator[tuple[str, ...]]:
        """Yield the names of the point and of the component of each element of an output."""
        points = self._library.point_names if name.startswith("point_") else ()
        for index in np.ndindex(shape):
            first = (points[index[0]],) if points else ()
            yield (*first, *(vector_components(shape[-1])[one] for one in index[len(first) :]))
