"""How far {ydot} can be trusted: its error, how near [A] is to singular, and which freedoms are to blame."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from kanegen.c import ModelDescription
from kanegen.model.arguments import Floats

FUNCTIONS: dict[str, Callable[[Floats], Floats]] = {"cos": np.cos, "sin": np.sin}


@dataclass(frozen=True)
class Finding:
    """The worst of all freedoms and states.

    Attributes:
        value: How bad it is.
        freedom: Name of the freedom.
        body: Name of its body.
        state: Row of the batch, 0 for a single state.
    """

    value: float
    freedom: str
    body: str
    state: int

    def __str__(self) -> str:
        return f"{self.value:.1e} at freedom {self.freedom!r} of body {self.body!r}, state {self.state}"


@dataclass(frozen=True)
class Diagnosis:
    """What `Library.diagnose` finds.

    Attributes:
        states: How many states were looked at.
        singular: In how many of them a pivot is not positive or is NaN; `estimate` leaves them out.
        estimate: Largest first correction of {ydot} over the largest acceleration of the same unit: about
            the error of the solution without refinement. It does not see what is lost where forces cancel.
            None if every state is singular.
        pivot: Smallest share of its inertia that a freedom keeps where those eliminated before it may move.
        singularity: Smallest |cos(theta2)|, or |sin(theta2)|, of joints whose three angles have their rates
            as speeds: 0 where the axes lie in a plane. None if there is no such joint.
    """

    states: int
    singular: int
    estimate: Finding | None
    pivot: Finding
    singularity: Finding | None

    def __str__(self) -> str:
        lines = [f"{self.states} states, {self.singular} of them singular"]
        if self.estimate:
            lines.append(f"largest error before refinement, relative: {self.estimate}")
        lines.append(f"smallest pivot, of 1: {self.pivot}")
        if self.singularity:
            lines.append(f"nearest to where three angles fail, of 1: {self.singularity}")
        return "\n".join(lines)


def diagnosis(
    model: ModelDescription, x: Floats, acceleration: Floats, estimate: Floats, regularity: Floats
) -> Diagnosis:
    """The worst of what a library has computed.

    Args:
        model: Names the freedoms.
        x: (B, m) coordinates.
        acceleration: (B, n) {ydot}, NaN where [A] is singular.
        estimate: (B, n) output `error_estimate`.
        regularity: (B, n) output of this name.
    """
    singular = np.atleast_1d(np.isnan(acceleration).any(axis=1))
    shares = _shares(model, acceleration, estimate)
    places = [place for place, _ in model.planar]
    distances = [np.abs(FUNCTIONS[name](x[:, place])) for place, name in model.planar]
    everywhere = range(len(model.freedom_names))
    return Diagnosis(
        states=len(x),
        singular=int(singular.sum()),
        estimate=None
        if singular.all()
        else _worst(model, np.where(singular[:, None], 0, -shares), everywhere),
        pivot=_worst(model, regularity, everywhere),
        singularity=_worst(model, np.stack(distances, axis=1), places) if places else None,
    )


def _shares(model: ModelDescription, acceleration: Floats, estimate: Floats) -> Floats:
    largest = np.zeros(estimate.shape)
    for unit in set(model.freedom_units):
        alike = [place for place, other in enumerate(model.freedom_units) if other == unit]
        largest[:, alike] = np.abs(acceleration[:, alike]).max(axis=1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        shares: Floats = np.where(estimate == 0, 0.0, estimate / largest)
    return shares


def _worst(model: ModelDescription, values: Floats, places: Sequence[int]) -> Finding:
    """The least value, or the first NaN; of negative ones the size is told."""
    least = np.argmin(np.where(np.isnan(values), -np.inf, values))
    state, column = divmod(int(least), values.shape[1])
    place = places[column]
    value = abs(float(values[state, column]))
    return Finding(value, model.freedom_names[place], model.freedom_bodies[place], state)
