"""The right side of the equations of motion for solvers of differential equations, with its Jacobian."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, NoReturn, TypedDict, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kanegen.errors import ArrayError, OptionError, call_named, quoted
from kanegen.library.bound import BoundCall
from kanegen.library.derivatives import Derivatives
from kanegen.library.embedding import Embedding
from kanegen.library.linearization import OF_RATES, outputs_needed
from kanegen.library.native.status import MISSING, OnStatus, StatusReport, report
from kanegen.model.arguments import LOADS, Floats, floats
from kanegen.model.parameter_sets import ParameterSets
from kanegen.program.ir import PARAMETERS

Doubles = NDArray[np.float64]

Feedback = ArrayLike | Callable[[float, Floats, Floats], ArrayLike] | None
"""Constant {tau}, or a function that returns it from the time (s), {x} and {y}; None is zero."""

OverTime = ArrayLike | Callable[[float], ArrayLike] | None
"""A constant load or motion, or a function that returns it from the time (s); None is zero."""


class FurtherInputs(TypedDict, total=False):
    """Inputs of a right side that only some systems have; each is constant or a function of the time.

    Attributes:
        point_force: (P, 3) force on each point that takes loads, N.
        point_moment: (P, 3) moment on the body of each such point, N m.
        prescribed: (3, p) values, rates and second derivatives of the prescribed freedoms.
        parameters: (P,) run-time parameters, or some by name; constant.
    """

    point_force: OverTime
    point_moment: OverTime
    prescribed: OverTime
    parameters: ParameterSets


class RightSide:
    """The rates of a state {x} then {y}, as a function of the time and the state.

    It has the order of arguments of `scipy.integrate.solve_ivp`: `rhs(t, state)`. Only one thread at a time
    may use it, since it keeps the arrays of its calls. Constant inputs are copied when it is made, and
    functions get {x} and {y} as arrays of their own, which they may change.

    Attributes:
        evaluations: Number of states whose rates were computed so far.
        jacobians: Number of states whose Jacobian was computed so far.

    Example:
        rhs = library.rhs(tau=lambda t, x, y: -0.1 * y)
        rates = rhs(0.0, rhs.state([0.1, 0.2], [0.0, 0.0]))
    """

    def __init__(
        self,
        library: RightSides,
        inputs: Mapping[str, Any],
        tau_jac: Callable[[float, Floats, Floats], ArrayLike] | ArrayLike | None,
    ) -> None:
        """Bind the functions of a library.

        Args:
            library: The library.
            inputs: What acts, by name: constants, and functions of the time, `tau` also of the state.
            tau_jac: (n, m + n) derivatives of a function `tau`, or a function that returns them.
        """
        self.evaluations = self.jacobians = 0
        self._library, self._inputs = library, dict(inputs)
        is_constant = tau_jac is not None and not callable(tau_jac)
        self._tau_jac = _doubles("tau_jac", tau_jac).copy() if is_constant else tau_jac
        self._m, self._n = len(library.coordinate_names), library.n
        self._are_rates = library.source.model.speeds_are_rates
        self._varying = [name for name, value in inputs.items() if callable(value)]
        self._time, self._has_warned = 0.0, False
        self._calls: dict[str, BoundCall] = {}
        for name in ("forward_dynamics", *([] if self._are_rates else ["coordinate_rates"])):
            self._call(name)

    def __repr__(self) -> str:
        return f"<RightSide {self._library.name}: state ({self._m + self._n},), x then y>"

    def __reduce__(self) -> tuple[Any, ...]:
        """Return how `pickle` makes the right side anew, with nothing counted."""
        return type(self), (self._library, self._inputs, self._tau_jac)

    def __call__(self, t: float, state: ArrayLike) -> Doubles:
        """Return the rates of a state.

        Args:
            t: Time, s.
            state: (m + n,) coordinates {x}, rad, m or 1, then speeds {y}, rad/s and m/s; or (m + n, B)
                states in columns, as `solve_ivp` passes them with `vectorized=True`.

        Returns:
            The rates, of the shape of `state`.

        Raises:
            ArrayError: If the state, or what a function of an input returns, has the wrong shape or type.
            OptionError: If a function of an input fails, with its exception as the cause.
            StatusError: As `Library.forward_dynamics`, with the time in the message.
        """
        given = _doubles("state", state)
        if given.ndim == 2 and given.shape[0] == self._m + self._n:
            columns = [self(t, column) for column in given.T]
            return np.stack(columns, axis=1) if columns else np.zeros_like(given)
        self.evaluations += 1
        rates = np.empty_like(given)
        (rates[self._m :],) = self._computed("forward_dynamics", t, given)
        if self._are_rates:
            rates[: self._m] = given[self._m :]
        else:
            (rates[: self._m],) = self._computed("coordinate_rates", t, given)
        return rates

    @property
    def jac(self) -> Callable[[float, ArrayLike], Doubles]:
        """The Jacobian as a function of the time and the state, which returns (m + n, m + n) derivatives.

        It consists of derivatives in C, without differences. Where {tau} is a function, its own derivatives
        `tau_jac` are part of it.

        Raises:
            OptionError: If the library was built without derivatives of the rates, or {tau} is a function
                and `tau_jac` is missing.

        Example:
            library = kg.build(system, ("forward_dynamics", "forward_dynamics_derivatives"))
            rhs = library.rhs()
            slopes = rhs.jac(0.0, rhs.state([0.1, 0.2], [0.0, 0.0]))
        """
        for name in outputs_needed(self._are_rates, ()):
            if name not in self._library.outputs:
                raise OptionError(
                    f"jac: system {quoted(self._library.name)} was built without the output {quoted(name)}. "
                    "Ask for it with outputs=(...), or leave jac out."
                )
        if "tau" in self._varying and self._tau_jac is None:
            raise OptionError(
                "tau: it is a function, whose derivatives jac needs. Give tau_jac, (n, m + n) derivatives by "
                "{x} and {y} or a function of t, x and y that returns them; 0 where it depends on t alone."
            )
        return self._jacobian

    def state(self, x: ArrayLike | None = None, y: ArrayLike | None = None) -> Doubles:
        """Return a state of {x}, by default neutral coordinates, then {y}, by default zeros.

        Raises:
            ArrayError: If `x` or `y` has the wrong shape or type.

        Example:
            state = library.rhs().state([0.1, 0.2])
        """
        neutral = self._library.source.model.neutral_coordinates
        coordinates = _shaped("x", neutral if x is None else x, (self._m,))
        speeds = _shaped("y", np.zeros(self._n) if y is None else y, (self._n,))
        return np.concatenate([coordinates, speeds])

    def parts(self, states: ArrayLike) -> tuple[Doubles, Doubles]:
        """Return {x} and {y} of a state, or of states in columns, as `solve_ivp` returns them.

        Args:
            states: (m + n,) or (m + n, T).

        Returns:
            (m,) or (T, m) coordinates, and (n,) or (T, n) speeds, which are copies.

        Raises:
            ArrayError: If there are more or fewer rows.

        Example:
            x, y = rhs.parts(solution.y)
        """
        rows = _doubles("states", states).T
        if rows.ndim not in (1, 2) or rows.shape[-1] != self._m + self._n:
            self._refuse(rows.T.shape)
        return rows[..., : self._m].copy(), rows[..., self._m :].copy()

    def _jacobian(self, t: float, state: ArrayLike) -> Doubles:
        """Return the (m + n, m + n) derivatives of the rates of one state by the state."""
        given = _doubles("state", state)
        self.jacobians += 1
        m = self._m
        slopes = np.zeros((m + self._n,) * 2)
        (found,) = self._computed("forward_dynamics_derivatives", t, given)
        found = found.copy()  # tau_jac may use this Jacobian, too
        by = self._library.derivative_columns("forward_dynamics_derivatives")
        slopes[m:, :m], slopes[m:, m:] = found[:, by["x"]], found[:, by["y"]]
        if "tau" in self._varying:
            own = self._tau_jac
            if callable(own):
                own = call_named("tau_jac", own, t, *self.parts(given))
            slopes[m:] += found[:, by["tau"]] @ self._slopes_of_tau(own)
        if self._are_rates:
            slopes[:m, m:] = np.eye(m)
        else:
            (found,) = self._computed(OF_RATES[1], t, given)
            by = self._library.derivative_columns(OF_RATES[1])
            slopes[:m, :m], slopes[:m, m:] = found[:, by["x"]], found[:, by["y"]]
        return slopes

    def _slopes_of_tau(self, given: Any) -> Doubles:
        """Return (n, m + n) derivatives of {tau}; 0 stands for all of them."""
        found = _doubles("tau_jac", given)
        shape = (self._n, self._m + self._n)
        if found.ndim == 0 and found == 0.0:
            return np.zeros(shape)
        return _shaped("tau_jac", found, shape)

    def _computed(self, name: str, t: float, state: Doubles) -> list[Floats]:
        """Return the results of a bound function in a state; they are valid up to its next call."""
        if state.shape != (self._m + self._n,):
            self._refuse(state.shape)
        call = self._call(name)
        arrays, acting = call.inputs, self._acting(call, t, state)
        arrays["x"][...], arrays["y"][...] = state[: self._m], state[self._m :]
        if "t" in arrays:
            arrays["t"][...] = t
        for varying, value in acting.items():
            setattr(call, varying, value)
        self._time = t
        call()
        return list(call.outputs.values())

    def _acting(self, call: BoundCall, t: float, state: Doubles) -> dict[str, Doubles]:
        """Return the values of the functions that a bound function reads.

        They are complete before the arrays of the call are filled, since a function may use this right side.
        """
        found = {}
        for name in self._varying:
            if name in call.inputs:
                function = self._inputs[name]
                read = self.parts(state) if name == "tau" else ()
                value = call_named(name, function, t, *read)
                found[name] = _doubles(name, value).copy()
        return found

    def _call(self, name: str) -> BoundCall:
        """Return a bound function, bound when it is first used.

        A constant is kept as the first function has it, so that all have the same though the caller changes
        the array, or the table of parameters, that was given.
        """
        if name not in self._calls:
            rule: OnStatus = "ignore" if self._library.on_status == "ignore" else self._react
            call = self._library.with_on_status(rule).bind(name)
            for one, value in self._inputs.items():
                if one in (*call.inputs, PARAMETERS) and not callable(value) and value is not None:
                    setattr(call, one, value)
                    self._inputs[one] = getattr(call, one).copy()
            self._calls[name] = call
        return self._calls[name]

    def _react(self, found: StatusReport) -> None:
        """Report what a bound function has to report, with the time, by the rule of the library.

        A warning is given once, since a solver evaluates thousands of states; what raises always raises.
        """
        message = f"at t = {self._time:.9g} s: {found.message}"
        if self._library.on_status == "warn":
            if self._has_warned and found.kind != MISSING:
                return
            self._has_warned, message = True, f"{message} Later states are not reported."
        report(replace(found, message=message), self._library.on_status)

    def _refuse(self, shape: tuple[int, ...]) -> NoReturn:
        raise ArrayError(
            f"state: expected shape ({self._m + self._n},), {self._m} coordinates then {self._n} speeds, or "
            f"such states in columns; got {shape}."
        )


def _doubles(name: str, value: object) -> Doubles:
    """Return an argument as an array of doubles.

    Raises:
        ArrayError: If it holds anything but real numbers in rows of one length.
    """
    return np.asarray(floats(name, value, np.dtype(np.float64)), np.float64)


def _shaped(name: str, value: object, shape: tuple[int, ...]) -> Doubles:
    """Return an argument of a shape as an array of doubles.

    Raises:
        ArrayError: If it has another shape, or holds anything but real numbers.
    """
    found = _doubles(name, value)
    if found.shape != shape:
        raise ArrayError(f"{name}: expected shape {shape}, got {found.shape}.")
    return found


class RightSides(Derivatives, Embedding):
    """The method that returns the right side of the equations of motion."""

    def rhs(
        self,
        tau: Feedback = None,
        force: OverTime = None,
        torque: OverTime = None,
        *,
        tau_jac: Callable[[float, Floats, Floats], ArrayLike] | ArrayLike | None = None,
        **inputs: Unpack[FurtherInputs],
    ) -> RightSide:
        """Return the right side of the equations of motion for a solver such as `scipy.integrate.solve_ivp`.

        A state is {x} then {y}, in one array. {xdot} is {y}, or the output `coordinate_rates` where speeds
        are no rates of coordinates, as with quaternions. A force element that depends on the time gets that
        of the solver.

        Args:
            tau: (n,) generalized forces beside loads and gravity, N m and N, or a function of the time (s),
                (m,) coordinates and (n,) speeds that returns them; None is zero.
            force: (N, 3) forces on the bodies, N, as in `forcing`, or a function of the time; None is zero.
            torque: (N, 3) torques on the bodies, N m, as in `forcing`, or a function of the time.
            tau_jac: (n, m + n) derivatives of the function `tau` by {x} and {y}, or a function of the same
                arguments that returns them; 0 where `tau` depends on the time alone. Only `jac` needs it.
            inputs: What only some systems have: `point_force`, `point_moment`, `prescribed`, each constant or
                a function of the time, and `parameters`.

        Raises:
            OptionError: If the library was built without "forward_dynamics", or "coordinate_rates" where
                speeds are no rates; or the system has contacts, or arrays of other numbers than doubles.
            ArrayError: If an argument has the wrong shape or type, the system has no use for it, or the
                motion of prescribed freedoms is missing.

        Example:
            library = kg.build(system, ("forward_dynamics", "forward_dynamics_derivatives"))
            rhs = library.rhs()
            slopes = rhs.jac(0.0, rhs.state(x, y))
        """
        if self.storage != "double":
            raise OptionError(
                f"rhs: solvers compute with doubles, but the arrays of system {quoted(self.name)} are "
                f'{self.storage!r}. Build it with storage="double".'
            )
        if self.contact_names:
            raise OptionError(
                f"rhs: system {quoted(self.name)} has contacts, which the accelerations do not hold. Leave "
                "them out by System.with_contacts([])."
            )
        given = {"tau": tau, "force": force, "torque": torque, **inputs}
        self._require_used({name for name, value in given.items() if value is not None})
        if "prescribed" in self.further_inputs and given.get("prescribed") is None:
            names = self.prescribed_names
            raise ArrayError(
                f"prescribed: missing, but the motion depends on it. Give (3, {len(names)}) values, rates "
                f"and second derivatives of {', '.join(names)}, or a function of the time that returns them."
            )
        return RightSide(self, given, tau_jac)

    def _require_used(self, names: set[str]) -> None:
        """Refuse inputs on which nothing in the system depends.

        Raises:
            ArrayError: If there is one.
        """
        model = self.source.model
        for name in sorted(names - {"tau", PARAMETERS}):
            is_read = model.takes_loads if name in ("force", "torque") else name in self.further_inputs
            if is_read:
                continue
            if name in LOADS:
                raise ArrayError(
                    f"{name}: no {LOADS[name]} of system {quoted(self.name)} takes loads. Enter one among "
                    "the loads of the model."
                )
            raise ArrayError(f"{name}: no output of system {quoted(self.name)} depends on it. Leave it out.")
