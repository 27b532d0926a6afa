"""What a compiled model says about the rates of its state."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from kanegen.errors import OptionError, SingularError
from kanegen.library import Library
from kanegen.model.arguments import Floats
from kanegen.model.load_arguments import Given

Effort = Callable[[float, Floats, Floats], ArrayLike]
"""{tau} from the time (s), {x} and {y}; of the shape of {y}."""


Told = Callable[[float], ArrayLike]
"""(3, p) values, rates and second derivatives of the prescribed freedoms, from the time (s)."""


class State:
    """Coordinates, speeds and the work of the efforts, as one array that steps add to.

    A state alone is (p + n + 1,); B of them are (B, p + n + 1), where p is the number of coordinates.
    """

    def __init__(self, coordinates: int) -> None:
        self.coordinates = coordinates

    def join(self, x: Floats, y: Floats, work: Floats) -> Floats:
        """One array of the three."""
        return np.concatenate([x, y, work[..., None]], axis=-1)

    def x(self, state: Floats) -> Floats:
        """(..., p) coordinates, contiguous."""
        return np.ascontiguousarray(state[..., : self.coordinates])

    def y(self, state: Floats) -> Floats:
        """(..., n) speeds, contiguous."""
        return np.ascontiguousarray(state[..., self.coordinates : -1])


@dataclass
class Motion:
    """The right side of the equations of motion, which counts how often it is asked.

    Attributes:
        library: With the output `forward_dynamics`, and `coordinate_rates` where speeds are not rates.
        state: How states are laid out.
        effort: Of the user, or None.
        prescribed: The motion of the prescribed freedoms; None where there are none.
        evaluations: Calls of `forward_dynamics` so far; one for a whole batch.
    """

    library: Library
    state: State
    effort: Effort | None
    prescribed: Told | None = None
    evaluations: int = 0

    def __call__(self, time: float, state: Floats) -> Floats:
        """Rates of a whole state."""
        x, y = self.state.x(state), self.state.y(state)
        acceleration, power = self.accelerations(time, x, y)
        return self.state.join(self.rates(time, x, y), acceleration, power)

    def accelerations(self, time: float, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """{ydot}, and the power of the efforts; of prescribed ones, too, where the library gives them.

        Raises:
            OptionError: If the effort cannot be asked.
            ArrayError: If it answers with an array of another shape.
            SingularError: If [A] is singular or the state is not finite; says when.
        """
        self.evaluations += 1
        tau = None if self.effort is None else self._efforts(time, x, y)
        with _told_when(time):
            given = self._given(time)
            found = self.library.forward_dynamics(x, y, tau, **given)
            power = np.zeros(y.shape[:-1], y.dtype) if tau is None else np.sum(y * tau, axis=-1)
            if self.prescribed is not None and "prescribed_efforts" in self.library.outputs:
                efforts = self.library.prescribed_efforts(x, y, found, **given)
                power = power + efforts @ np.asarray(given["prescribed"], y.dtype)[1]
        return found, power

    def rates(self, time: float, x: Floats, y: Floats) -> Floats:
        """{xdot}: the speeds themselves, or what Eq. (9) makes of them.

        Raises:
            SingularError: If there are none in this state; says when.
        """
        if speeds_are_rates(self.library):
            return y
        with _told_when(time):
            return self.library.coordinate_rates(x, y, **self._given(time))

    def _given(self, time: float) -> Given:
        given: Given = {"t": time} if "t" in self.library.further_inputs else {}
        return given if self.prescribed is None else {**given, "prescribed": self.prescribed(time)}

    def _efforts(self, time: float, x: Floats, y: Floats) -> Floats:
        assert self.effort is not None
        tau = np.asarray(self.effort(time, x, y))
        if tau.dtype.kind not in "iuf" or tau.shape not in (y.shape, y.shape[-1:]):
            raise OptionError(
                f"effort: at t = {time:.9g} s it returned {tau.dtype} of shape {tau.shape}; expected real "
                f"numbers of shape {y.shape}, one for each speed."
            )
        efforts: Floats = tau.astype(y.dtype, copy=False)
        return efforts


def speeds_are_rates(library: Library) -> bool:
    """Whether {xdot} = {y}, Eq. (45)."""
    return library.speed_names == library.coordinate_names


@contextmanager
def _told_when(time: float) -> Iterator[None]:
    try:
        yield
    except SingularError as error:
        raise SingularError(f"at t = {time:.9g} s: {error} A smaller step may avoid this.") from None
