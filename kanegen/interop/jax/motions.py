"""Motions in JAX: rates of a state, steps, and rollouts by steps."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from kanegen.choices import known_spelling, require_one
from kanegen.errors import ArrayError, OptionError, quoted
from kanegen.extras import JAX, module
from kanegen.interop.jax.calls import Arrays
from kanegen.interop.jax.function import Function
from kanegen.library import Library
from kanegen.library.native.rollouts import PRESCRIBED
from kanegen.library.rollouts import number_of_steps
from kanegen.model.arguments import OPTIONAL
from kanegen.program.ir import PARAMETERS
from kanegen.recursion.outputs import METHODS, RATES

jax = module("jax", "jaxlib", extra=JAX)
jnp = jax.numpy

Pair = tuple[Arrays, Arrays]
"""Coordinates and generalized speeds."""


class Motions:
    """Functions that follow a motion, made of generated functions.

    Attributes:
        library: The same functions with NumPy arrays, and all names, sizes and parameters.
    """

    library: Library

    def _function(self, name: str) -> Function:
        """Return the function of an output.

        Raises:
            OptionError: If it was not built.
        """
        raise NotImplementedError

    def state_rates(self, state: Arrays, tau: Arrays | None = None, **named: Arrays) -> Arrays:
        """Return the rates of a state, {xdot} and then {ydot}, as solvers of ordinary equations take them.

        Args:
            state: (*lead, m + n) coordinates, then generalized speeds.
            tau: (*lead, n) generalized forces beside loads and gravity; None is zero.
            named: Loads, further inputs and `parameters`, as for `forward_dynamics`.

        Returns:
            (*lead, m + n), rad/s, m/s; rad/s^2, m/s^2.

        Raises:
            OptionError: If the functions were built without the output forward_dynamics.
            ArrayError: If an argument has the wrong shape or type.

        Example:
            solution = jax.experimental.ode.odeint(lambda s, t: arm.state_rates(s, tau), state, times)
        """
        x, y = self._parts(state)
        ydot = self._function(RATES[0])(x, y, tau, **named)
        if self.library.source.model.speeds_are_rates:
            xdot = y
        else:
            further = {name: named[name] for name in (PRESCRIBED, PARAMETERS) if name in named}
            xdot = self._function(RATES[1])(x, y, **further)
        xdot = jnp.broadcast_to(xdot, (*ydot.shape[:-1], xdot.shape[-1]))
        return jnp.concatenate([xdot.astype(ydot.dtype), ydot], axis=-1)

    def step(
        self,
        x: Arrays,
        y: Arrays,
        tau: Arrays | None = None,
        force: Arrays | None = None,
        torque: Arrays | None = None,
        *,
        step: Arrays,
        method: str | None = None,
        **named: Arrays,
    ) -> Pair:
        """Return the state after one step, over which all inputs are constant, computed in C.

        Args:
            x: (*lead, m) coordinates, rad, m or 1.
            y: (*lead, n) generalized speeds, rad/s and m/s.
            tau: (*lead, n) generalized forces; None is zero.
            force: (*lead, N, 3) forces on the bodies, N; None is zero.
            torque: (*lead, N, 3) torques on the bodies, N m; None is zero.
            step: Length of the step, s.
            method: Name of the method; by default the only one that there is.
            named: Further inputs and `parameters`; `t` is the time before the step.

        Returns:
            Coordinates and speeds after the step. Their derivatives by x, y, tau and parameters are those of
            the method itself.

        Raises:
            OptionError: If the functions were built without the output `step_<method>`.
            ArrayError: If an argument has the wrong shape or type.

        Example:
            x, y = arm.step(x, y, tau, step=1e-3)
        """
        found = self._function(self._method(method))(x, y, tau, force, torque, step, **named)
        return found[0], found[1]

    def rollout(
        self,
        x: Arrays,
        y: Arrays,
        tau: Arrays | None = None,
        force: Arrays | None = None,
        torque: Arrays | None = None,
        *,
        steps: int,
        step: Arrays,
        method: str | None = None,
        **named: Arrays,
    ) -> Pair:
        """Return the states of a motion, by `jax.lax.scan` over steps in C.

        Args:
            x: (m,) coordinates at the start, rad, m or 1. For many motions use `jax.vmap`.
            y: (n,) generalized speeds at the start, rad/s and m/s.
            tau: (n,) constant generalized forces or (steps, n) constant over each step; None is zero.
            force: (N, 3) or (steps, N, 3) forces on the bodies, N; None is zero.
            torque: (N, 3) or (steps, N, 3) torques on the bodies, N m; None is zero.
            steps: Number of steps, a whole number that is no traced value.
            step: Length of a step, s; one number for all.
            method: Name of the method; by default the only one that there is.
            named: Loads on points, as `force`; `t`, the time at the start; and `parameters`.

        Returns:
            (steps + 1, m) coordinates and (steps + 1, n) speeds, the start first.

        Raises:
            OptionError: If the functions were built without the output `step_<method>`, or `steps` is no
                whole number from 0 on.
            ArrayError: If an argument has the wrong shape or type.

        Example:
            def miss(tau):
                x, y = arm.rollout(x0, y0, tau, steps=100, step=0.01)
                return ((x[-1] - goal) ** 2).sum()

            slope = jax.grad(miss)(tau)
        """
        make = self._function(self._method(method))
        count = number_of_steps("steps", _known(steps), 0)
        if np.shape(step):
            raise ArrayError(f"step: expected one number for all steps, got shape {np.shape(step)}.")
        arrays = {array.name: array.shape for array in make.arguments.arrays}
        given = {"tau": tau, "force": force, "torque": torque, **named}
        given = {name: value for name, value in given.items() if value is not None}
        rows = {name: given.pop(name) for name in (*given,) if _has_rows(name, given[name], arrays, count)}
        start = given.pop("t", None)
        dtype = make.arguments.types[-1]
        first = []
        for name, value in (("x", x), ("y", y)):
            if np.shape(value) != arrays[name]:
                shape = np.shape(value)
                raise ArrayError(
                    f"{name}: expected shape {arrays[name]}, got {shape}. For many use jax.vmap."
                )
            first.append(jnp.asarray(value, dtype))

        def one(state: Pair, at: tuple[Arrays, dict[str, Arrays]]) -> tuple[Pair, Pair]:
            k, held = at
            time = {} if start is None else {"t": start + k * step}
            found = make(*state, step=step, **given, **held, **time)
            return found, found

        _, states = jax.lax.scan(one, tuple(first), (jnp.arange(count), rows))
        xs, ys = (jnp.concatenate([a[None], b]) for a, b in zip(first, states, strict=True))
        return xs, ys

    def _method(self, method: str | None) -> str:
        """Return the name of the function that makes a step, by default the only one.

        Raises:
            OptionError: If there is no such method, or none or several to choose from.
        """
        built = [one.name for one in METHODS.values() if one.functions[0] in self.library.outputs]
        if method is not None:
            name: str = known_spelling(method, METHODS)
            require_one("method", name, METHODS)
            return METHODS[name].functions[0]
        if len(built) > 1:
            system = quoted(self.library.name)
            raise OptionError(f"method: system {system} was built with {', '.join(built)}. Name one.")
        return METHODS[built[0] if built else "rk4"].functions[0]

    def _parts(self, state: Arrays) -> Pair:
        """Return coordinates and speeds of states, each (*lead, m + n).

        Raises:
            ArrayError: If the last axis has another length.
        """
        m, n = len(self.library.coordinate_names), self.library.n
        if np.shape(state)[-1:] != (m + n,):
            raise ArrayError(
                f"state: expected shape (..., {m + n}), {{x}} then {{y}}, got {np.shape(state)}."
            )
        array = jnp.asarray(state)
        return array[..., :m], array[..., m:]


def _known(steps: Any) -> Any:
    """Return a number of steps as NumPy has it where JAX holds a whole number that is no traced value."""
    is_known = isinstance(steps, jax.Array) and not isinstance(steps, jax.core.Tracer)
    return np.asarray(steps)[()] if is_known else steps


def _has_rows(name: str, value: Any, shapes: Mapping[str, tuple[int, ...]], steps: int) -> bool:
    """Return whether an input has a row for each step.

    Raises:
        ArrayError: If it has as many axes, and another number of rows.
    """
    if name not in OPTIONAL or name not in shapes or np.ndim(value) != len(shapes[name]) + 1:
        return False
    if np.shape(value) != (steps, *shapes[name]):
        expected = f"{shapes[name]} or {(steps, *shapes[name])}"
        raise ArrayError(f"{name}: expected shape {expected}, got {np.shape(value)}.")
    return True
