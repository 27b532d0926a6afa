"""The work of what acts along steps whose states are known."""

from __future__ import annotations

from typing import Any

import numpy as np

from kanegen.library import Library
from kanegen.model.arguments import Floats
from kanegen.model.arrays import Floats as Doubles
from kanegen.simulation.motion import speeds_are_rates
from kanegen.simulation.sampled_inputs import Rows, StepInputs

PRESCRIBED_EFFORTS = "prescribed_efforts"
"""Output that gives the efforts at prescribed freedoms."""


def do_work(library: Library, arguments: set[str]) -> bool:
    """Return whether inputs of these arguments do work that is counted: efforts, and prescribed motion.

    The work of loads on bodies and points is not counted.
    """
    moves = "prescribed" in arguments and PRESCRIBED_EFFORTS in library.source.outputs
    return moves or "tau" in arguments


def work_of_steps(
    library: Library, x: Floats, y: Floats, times: Doubles, inputs: StepInputs, length: float
) -> Floats:
    """Return the work (J) of efforts, and of prescribed motion, in each step, by Simpson's rule.

    States in the middle of steps are those of the cubic through the ends with their rates, so that the error
    of the sum of all steps has order 4.

    Args:
        library: The library.
        x: (S + 1, ..., m) coordinates at the ends of S steps.
        y: (S + 1, ..., n) generalized speeds there.
        times: (S + 1,) the times, s.
        inputs: What acts.
        length: Length of a step, s.

    Returns:
        (S, ...) works.
    """
    quiet = library.with_on_status("ignore")
    first, middle, last = (inputs.at(place) for place in range(3))
    start = _Evaluated(quiet, x[:-1], y[:-1], times[:-1], first)
    end = _Evaluated(quiet, x[1:], y[1:], times[1:], last)
    between = 0.5 * (y[:-1] + y[1:]) + (length / 8) * (start.accelerations - end.accelerations)
    if PRESCRIBED_EFFORTS in library.source.outputs and "prescribed" in first:
        places = 0.5 * (x[:-1] + x[1:]) + (length / 8) * (start.rates() - end.rates())
        inner = _Evaluated(quiet, places, between, 0.5 * (times[:-1] + times[1:]), middle)
        power = inner.power()
    else:
        power = _of_efforts(between, middle)
    found: Floats = (length / 6) * (start.power() + 4 * power + end.power())
    return found


def _of_efforts(y: Floats, inputs: Rows) -> Floats:
    """Return the (S, ...) power of generalized forces on (S, ..., n) speeds, W."""
    if "tau" not in inputs:
        return np.zeros(y.shape[:-1], y.dtype)
    tau = inputs["tau"].reshape(len(y), *(1,) * (y.ndim - 2), -1)
    power: Floats = np.sum(y * tau.astype(y.dtype), axis=-1)
    return power


class _Evaluated:
    """Accelerations, rates and power in many states, from calls for all of them at once."""

    def __init__(self, library: Library, x: Floats, y: Floats, times: Doubles, inputs: Rows) -> None:
        """Keep (S, ..., m) coordinates, (S, ..., n) speeds, (S,) times and what acts, and get {ydot}."""
        self._library, self._inputs, self._y = library, inputs, y
        each = int(np.prod(y.shape[1:-1]))
        self._states = [np.ascontiguousarray(one.reshape(-1, one.shape[-1])) for one in (x, y)]
        rows = {"t": times} | inputs if "t" in library.further_inputs else inputs
        self._arguments: dict[str, Any] = {
            name: np.repeat(values, each, axis=0).astype(y.dtype) for name, values in rows.items()
        }
        self._flat = library.forward_dynamics(self._states[0], self._states[1], **self._arguments)

    @property
    def accelerations(self) -> Floats:
        """(S, ..., n) generalized accelerations."""
        return self._flat.reshape(self._y.shape)

    def rates(self) -> Floats:
        """Return the (S, ..., m) rates of the coordinates."""
        if speeds_are_rates(self._library):
            return self._y
        own = self._arguments
        named = {name: own[name] for name in self._library.further_inputs if name in own}
        found = self._library.coordinate_rates(self._states[0], self._states[1], **named)
        return found.reshape(*self._y.shape[:-1], -1)

    def power(self) -> Floats:
        """Return the (S, ...) power of efforts and of prescribed motion, W."""
        power = _of_efforts(self._y, self._inputs)
        if "prescribed" not in self._inputs or PRESCRIBED_EFFORTS not in self._library.source.outputs:
            return power
        given = {name: values for name, values in self._arguments.items() if name != "tau"}
        x, y = self._states
        efforts = self._library.prescribed_efforts(x, y, self._flat, **given)
        rates = self._arguments["prescribed"][:, 1]
        whole: Floats = power + np.sum(efforts * rates, axis=-1).reshape(power.shape)
        return whole
