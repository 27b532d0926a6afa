"""The right side of the equations of motion: the rates of a whole state, from a library."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from kanegen.library import Library
from kanegen.library.native.status import INACCURATE, MISSING, StatusReport, report
from kanegen.model.arguments import Floats
from kanegen.simulation.inputs import Inputs, Interval


@dataclass(frozen=True)
class StateLayout:
    """Coordinates, speeds and the work of the generalized forces as one array, to which steps add.

    One state is (m + n + 1,), B states are (B, m + n + 1).

    Attributes:
        coordinates: Number m of coordinates.
        homogeneous: For each orientation by homogeneous coordinates, such as a quaternion, their places in
            {x}. Their length has no meaning.
    """

    coordinates: int
    homogeneous: tuple[tuple[int, ...], ...] = ()

    @classmethod
    def of(cls, library: Library) -> StateLayout:
        """Return the layout of the states of a library."""
        model = library.source.model
        return cls(len(model.coordinate_units), model.homogeneous)

    def join(self, x: Floats, y: Floats, work: Floats) -> Floats:
        """Return one array of (..., m) coordinates, (..., n) speeds and (...) work."""
        return np.concatenate([x, y, work[..., None]], axis=-1)

    def x(self, state: Floats) -> Floats:
        """Return the (..., m) coordinates of a state, contiguous."""
        return np.ascontiguousarray(state[..., : self.coordinates])

    def y(self, state: Floats) -> Floats:
        """Return the (..., n) speeds of a state, contiguous."""
        return np.ascontiguousarray(state[..., self.coordinates : -1])

    def lengths(self, state: Floats) -> Floats:
        """Return the (..., H) lengths of the homogeneous coordinates of a state, or of its coordinates."""
        parts = [state[..., list(places)] for places in self.homogeneous]
        return np.stack([np.sqrt(np.sum(part * part, axis=-1)) for part in parts], axis=-1)

    def scaled(self, state: Floats, factors: Floats) -> Floats:
        """Return a state, or its coordinates, with homogeneous coordinates multiplied by (..., H) factors.

        That changes no orientation: neither rates nor accelerations depend on their lengths.
        """
        found = state.copy()
        for k, places in enumerate(self.homogeneous):
            found[..., list(places)] *= factors[..., k, None]
        return found

    def with_first_lengths(self, states: Floats) -> Floats:
        """Return states over the time, or their {x}, with homogeneous coordinates of the first lengths.

        A length whose square is 0 or infinite, of which there is no orientation, stays as it is.
        """
        if not self.homogeneous:
            return states
        with np.errstate(over="ignore"):
            lengths = self.lengths(states)
        known = (lengths > 0) & np.isfinite(lengths)
        factors = np.divide(lengths[0], lengths, where=known, out=np.ones_like(lengths))
        return self.scaled(states, factors)


@dataclass
class Motion:
    """The right side of the equations of motion, which counts its evaluations.

    Attributes:
        library: Library with the output `forward_dynamics`, and `coordinate_rates` if speeds are no rates.
        state: Layout of the states.
        inputs: What acts from outside.
        interval: Times (s) between which the present step lies, for inputs that jump at its ends.
        evaluations: Calls of `forward_dynamics` so far; a whole batch is one.
        counts_work: Whether the work of what acts is wanted; steps in NumPy count it in any case.
        inaccurate: Reports of results that may be inaccurate, with the time in their messages.
    """

    library: Library
    state: StateLayout
    inputs: Inputs
    interval: Interval = (-math.inf, math.inf)
    evaluations: int = 0
    counts_work: bool = True
    inaccurate: list[StatusReport] = field(default_factory=list)

    def __call__(self, time: float, state: Floats) -> Floats:
        """Return the rates of a whole state at a time (s)."""
        x, y = self.state.x(state), self.state.y(state)
        acceleration, power = self.accelerations(time, x, y)
        return self.state.join(self.rates(time, x, y), acceleration, power)

    def accelerations(self, time: float, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Return {ydot} and the power (W) of the generalized forces.

        The power includes that at the prescribed freedoms, if the library has `prescribed_efforts`.

        Raises:
            OptionError: If a function of the caller returns generalized forces of another shape than {y}.
            StatusError: If a result is missing, as a `SingularError`, or is not finite; or if it may be
                inaccurate and the library raises on that. The message has the time.
        """
        self.evaluations += 1
        library, arguments = self.library_at(time, x, y), self._arguments(time, x, y)
        found = library.forward_dynamics(x, y, **arguments)
        power = np.zeros(y.shape[:-1], y.dtype)
        tau = arguments.pop("tau", None)
        if tau is not None:
            power = np.sum(y * tau, axis=-1)
        if "prescribed" in arguments and "prescribed_efforts" in library.source.outputs:
            efforts = library.prescribed_efforts(x, y, found, **arguments)
            power = power + efforts @ np.asarray(arguments["prescribed"], y.dtype)[1]
        return found, power

    def rates(self, time: float, x: Floats, y: Floats) -> Floats:
        """Return {xdot}: the speeds themselves, Eq. (45), or the output `coordinate_rates`, Eq. (9).

        Raises:
            StatusError: If the rates do not exist in this state, as a `SingularError`, or are not finite;
                the message has the time.
        """
        if speeds_are_rates(self.library):
            return y
        arguments = self._arguments(time, x, y)
        named = {name: arguments[name] for name in self.library.further_inputs if name in arguments}
        return self.library_at(time, x, y).coordinate_rates(x, y, **named)

    def _arguments(self, time: float, x: Floats, y: Floats) -> dict[str, Any]:
        """Return what acts at a time as arguments of `Library.forward_dynamics`, with the time itself."""
        found: dict[str, Any] = self.inputs.arguments(time, x, y, self.interval)
        return found | {"t": time} if "t" in self.library.further_inputs else found

    def report_inaccurate(self) -> None:
        """Report once that results may have been inaccurate, with the first time, as the library reports."""
        if self.inaccurate:
            first, count = self.inaccurate[0], len(self.inaccurate)
            message = f"{first.message} {count} of {self.evaluations} evaluations were not accurate."
            report(replace(first, message=message), self.library.on_status)

    def library_at(self, time: float, x: Floats, y: Floats, step: float = 0.0) -> Library:
        """Return the library, which passes what it has to report to `_react` with the time (s).

        A library that ignores reports does so from the second evaluation on: no motion begins in a state
        that has no finite rates.

        Args:
            time: The time, s.
            x: (..., m) coordinates at this time.
            y: (..., n) generalized speeds.
            step: Length of the step of a function that makes one, s.
        """
        if self.library.on_status == "ignore" and self.evaluations > 1:
            return self.library
        return self.library.with_on_status(partial(self._react, time, x, y, step))

    def _react(self, time: float, x: Floats, y: Floats, step: float, found: StatusReport) -> None:
        """Stop where a result is missing or not finite; keep the report of one that may be inaccurate.

        An input that is not finite is the cause, which is named. The first evaluation is in the first state,
        which does not depend on the step. A report of a step says itself what helps, unless a result is
        missing.
        """
        message = f"at t = {time:.9g} s: {found.of_step or found.message}"
        if found.kind != INACCURATE:
            for moment in (time, time + step / 2, time + step) if step else (time,):
                if cause := self.inputs.not_finite_at(moment, x, y):
                    raise replace(found, message=f"at t = {moment:.9g} s: {cause}.").error
            may_help = self.evaluations > 1 and (found.kind == MISSING or not found.of_step)
            raise replace(found, message=message + " A smaller step may avoid this." * may_help).error
        if self.library.on_status != "warn":
            report(replace(found, message=message), self.library.on_status)
        else:
            self.inaccurate.append(replace(found, message=message))


def speeds_are_rates(library: Library) -> bool:
    """Whether the speeds are the rates of the coordinates, {xdot} = {y}, Eq. (45)."""
    return library.speed_names == library.coordinate_names
