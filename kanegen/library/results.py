"""Results of a library that are more than one array: several outputs at once, and the diagnosis of {ydot}."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from kanegen.c import ModelDescription
from kanegen.errors import counted
from kanegen.model.arguments import Floats

_FUNCTIONS: dict[str, Callable[[Floats], Floats]] = {"cos": np.cos, "sin": np.sin}
"""The functions of a middle angle that `ModelDescription.planar` names."""


class Evaluation(tuple[Floats, ...]):
    """The arrays of several outputs in order; each is also an attribute of the output's name.

    Example:
        evaluation = library.evaluate(x, y)
        acceleration = evaluation.forward_dynamics
    """

    _names: tuple[str, ...]

    def __new__(cls, names: tuple[str, ...], values: Sequence[Floats]) -> Evaluation:
        """Return the arrays `values` of the outputs `names`."""
        self = tuple.__new__(cls, values)
        self._names = names
        return self

    def __getattr__(self, name: str) -> Floats:
        """Return the array of the output `name`."""
        if name in self._names:
            return self[self._names.index(name)]
        raise AttributeError(f"there is no output {name!r} here, only {', '.join(self._names)}")

    def __getnewargs__(self) -> tuple[tuple[str, ...], tuple[Floats, ...]]:
        """Return the arguments from which `pickle` makes an equal evaluation."""
        return self._names, tuple(self)

    def __repr__(self) -> str:
        fields = ", ".join(f"{name}={value!r}" for name, value in zip(self._names, self, strict=True))
        return f"Evaluation({fields})"


@dataclass(frozen=True)
class Finding:
    """The worst value of a quantity over all freedoms and states, and where it occurs.

    Attributes:
        value: The worst value.
        freedom: Name of the freedom.
        body: Name of the body that the freedom belongs to.
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
    """The accuracy of {ydot} in some states, from `Library.diagnose`.

    Attributes:
        states: Number of states.
        singular: Number of states in which a pivot is not positive or is NaN; `estimate` leaves them out.
        estimate: Largest first correction of {ydot} over the largest acceleration of the same unit, which is
            about the relative error of the solution without refinement. It does not include the loss of
            digits where forces cancel. None if every state is singular.
        pivot: Smallest share of its inertia that a freedom keeps where the freedoms eliminated before it may
            move.
        singularity: Smallest |cos(theta2)|, or |sin(theta2)|, of joints whose three angles have their rates
            as speeds; it is 0 in gimbal lock. None if there is no such joint.
    """

    states: int
    singular: int
    estimate: Finding | None
    pivot: Finding
    singularity: Finding | None

    def __str__(self) -> str:
        lines = [f"{counted(self.states, 'state')}, {self.singular} of them singular"]
        if self.estimate:
            lines.append(f"largest relative error before refinement: {self.estimate}")
        lines.append(f"smallest pivot, relative to its inertia: {self.pivot}")
        if self.singularity:
            lines.append(f"nearest to gimbal lock, |cos| or |sin| of theta2: {self.singularity}")
        return "\n".join(lines)


def diagnosis(
    model: ModelDescription, x: Floats, acceleration: Floats, estimate: Floats, regularity: Floats
) -> Diagnosis:
    """Return the worst values of the results of a library for B states.

    Args:
        model: Description of the model, which names the freedoms.
        x: (B, m) coordinates.
        acceleration: (B, n) output `forward_dynamics`, NaN where [A] is singular.
        estimate: (B, n) output `error_estimate`.
        regularity: (B, n) output `regularity`.
    """
    singular = np.atleast_1d(np.isnan(acceleration).any(axis=1))
    relative = np.where(singular[:, None], 0, _relative(model, acceleration, estimate))
    places = [place for place, _ in model.planar]
    distances = [np.abs(_FUNCTIONS[name](x[:, place])) for place, name in model.planar]
    everywhere = range(len(model.freedom_names))
    return Diagnosis(
        states=len(x),
        singular=int(singular.sum()),
        estimate=None if singular.all() else _least(model, -relative, everywhere),
        pivot=_least(model, regularity, everywhere),
        singularity=_least(model, np.stack(distances, axis=1), places) if places else None,
    )


def _relative(model: ModelDescription, acceleration: Floats, estimate: Floats) -> Floats:
    """Return (B, n) error estimates over the largest acceleration of the same unit in the same state."""
    largest = np.zeros(estimate.shape)
    for unit in set(model.freedom_units):
        alike = [place for place, other in enumerate(model.freedom_units) if other == unit]
        largest[:, alike] = np.abs(acceleration[:, alike]).max(axis=1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        relative: Floats = np.where(estimate == 0, 0.0, estimate / largest)
    return relative


def _least(model: ModelDescription, values: Floats, places: Sequence[int]) -> Finding:
    """Return the absolute value and the place of the least of `values`, or of the first NaN.

    Args:
        model: Description of the model.
        values: (B, k) numbers.
        places: For each of the k columns the freedom, from 0.
    """
    least = np.argmin(np.where(np.isnan(values), -np.inf, values))
    state, column = divmod(int(least), values.shape[1])
    place = places[column]
    value = abs(float(values[state, column]))
    return Finding(value, model.freedom_names[place], model.freedom_bodies[place], state)
