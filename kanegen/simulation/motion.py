"""The right side of the equations of motion: the rates of a whole state, from a library."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from kanegen.errors import OptionError
from kanegen.library import Library
from kanegen.library.native.status import INACCURATE, StatusReport, report
from kanegen.model.arguments import Floats, NamedInputs

Effort = Callable[[float, Floats, Floats], ArrayLike]
"""Function that returns {tau}, of the shape of {y}, from the time (s), {x} and {y}."""

PrescribedMotion = Callable[[float], ArrayLike]
"""Function of the time (s) that returns (3, p) values, rates and accelerations of the prescribed freedoms."""


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


@dataclass
class Motion:
    """The right side of the equations of motion, which counts its evaluations.

    Attributes:
        library: Library with the output `forward_dynamics`, and `coordinate_rates` if speeds are no rates.
        state: Layout of the states.
        effort: Generalized forces beside loads and gravity, or None.
        prescribed: Motion of the prescribed freedoms, or None if there are none.
        evaluations: Calls of `forward_dynamics` so far; a whole batch is one.
        inaccurate: Reports of results that may be inaccurate, with the time in their messages.
    """

    library: Library
    state: StateLayout
    effort: Effort | None
    prescribed: PrescribedMotion | None = None
    evaluations: int = 0
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
            OptionError: If the generalized forces have another shape than {y}.
            StatusError: If a result is missing, as a `SingularError`, or is not finite; or if it may be
                inaccurate and the library raises on that. The message has the time.
        """
        self.evaluations += 1
        tau = None if self.effort is None else self._efforts(self.effort, time, x, y)
        library, inputs = self._library_at(time), self._inputs(time)
        found = library.forward_dynamics(x, y, tau, **inputs)
        power = np.zeros(y.shape[:-1], y.dtype) if tau is None else np.sum(y * tau, axis=-1)
        if self.prescribed is not None and "prescribed_efforts" in library.outputs:
            efforts = library.prescribed_efforts(x, y, found, **inputs)
            power = power + efforts @ np.asarray(inputs["prescribed"], y.dtype)[1]
        return found, power

    def rates(self, time: float, x: Floats, y: Floats) -> Floats:
        """Return {xdot}: the speeds themselves, Eq. (45), or the output `coordinate_rates`, Eq. (9).

        Raises:
            StatusError: If the rates do not exist in this state, as a `SingularError`, or are not finite;
                the message has the time.
        """
        if speeds_are_rates(self.library):
            return y
        return self._library_at(time).coordinate_rates(x, y, **self._inputs(time))

    def report_inaccurate(self) -> None:
        """Report once that results may have been inaccurate, with the first time, as the library reports."""
        if self.inaccurate:
            first, count = self.inaccurate[0], len(self.inaccurate)
            message = f"{first.message} {count} of {self.evaluations} evaluations were not accurate."
            report(replace(first, message=message), self.library.on_status)

    def _library_at(self, time: float) -> Library:
        """Return the library, which passes what it has to report to `_react` with the time (s).

        A library that ignores reports does so from the second evaluation on: no motion begins in a state
        that has no finite rates.
        """
        if self.library.on_status == "ignore" and self.evaluations > 1:
            return self.library
        return self.library.with_on_status(partial(self._react, time))

    def _react(self, time: float, found: StatusReport) -> None:
        """Stop where a result is missing or not finite; keep the report of one that may be inaccurate.

        The first evaluation is in the first state, which does not depend on the step.
        """
        message = f"at t = {time:.9g} s: {found.message}"
        if found.kind != INACCURATE:
            advice = " A smaller step may avoid this." if self.evaluations > 1 else ""
            raise replace(found, message=message + advice).error
        if self.library.on_status != "warn":
            report(replace(found, message=message), self.library.on_status)
        else:
            self.inaccurate.append(replace(found, message=message))

    def _inputs(self, time: float) -> NamedInputs:
        """Return the inputs that are passed by name: the time, and the prescribed motion at that time."""
        inputs: NamedInputs = {"t": time} if "t" in self.library.further_inputs else {}
        return inputs if self.prescribed is None else {**inputs, "prescribed": self.prescribed(time)}

    def _efforts(self, effort: Effort, time: float, x: Floats, y: Floats) -> Floats:
        """Return the generalized forces, of the type of {y}, after a check of their shape."""
        tau = np.asarray(effort(time, x, y))
        if tau.dtype.kind not in "iuf" or tau.shape not in (y.shape, y.shape[-1:]):
            raise OptionError(
                f"effort: at t = {time:.9g} s it returned {tau.dtype} of shape {tau.shape}; expected real "
                f"numbers of shape {y.shape}, one for each speed."
            )
        efforts: Floats = tau.astype(y.dtype, copy=False)
        return efforts


def speeds_are_rates(library: Library) -> bool:
    """Whether the speeds are the rates of the coordinates, {xdot} = {y}, Eq. (45)."""
    return library.speed_names == library.coordinate_names
