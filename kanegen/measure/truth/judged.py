"""What `measure` needs of a library, and the values that a library has for it."""

from __future__ import annotations

import warnings
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kanegen.errors import ArrayError, KanegenWarning
from kanegen.model.arrays import Floats
from kanegen.program.precision import Precision, precision_named
from kanegen.reference.states import States


class JudgedLibrary(Protocol):
    """The functions of a library; batches have a leading axis B."""

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of what it computes."""

    @property
    def precision(self) -> str:
        """Its arithmetic, a name of `precision.PRECISIONS`."""

    @property
    def storage(self) -> str:
        """The precision of its arrays, likewise."""

    @property
    def parameters(self) -> dict[str, float]:
        """Values of the run-time parameters."""

    def mass_matrix(self, x: Floats) -> NDArray[Any]:
        """(B, n, n) from (B, n)."""

    def forcing(self, x: Floats, y: Floats, force: Any = None, torque: Any = None) -> NDArray[Any]:
        """(B, n) from (B, n), (B, n), (B, N, 3) and (B, N, 3)."""

    def inverse_dynamics(
        self, x: Floats, y: Floats, ydot: Floats, force: Any = None, torque: Any = None
    ) -> NDArray[Any]:
        """(B, n)."""

    def forward_dynamics(
        self, x: Floats, y: Floats, tau: Any = None, force: Any = None, torque: Any = None
    ) -> NDArray[Any]:
        """(B, n), NaN where [A] is singular."""


def companion(value: ArrayLike | None, y: Floats, precision: Precision, what: str) -> Floats:
    """`value` (B, n) as numbers that the library can hold; zeros for None.

    Raises:
        ArrayError: If it does not have the shape of `y`.
    """
    array = np.zeros(y.shape) if value is None else np.asarray(value)
    if array.shape != y.shape:
        raise ArrayError(f"{what}: expected shape {y.shape}, got {array.shape}.")
    return array.astype(precision.dtype).astype(np.float64)


def values(library: JudgedLibrary, name: str, states: States, tau: Floats, ydot: Floats) -> NDArray[Any]:
    """(B, ...) what the library computes as output `name`; NaN where it refuses."""
    held = precision_named(library.storage)
    x, y, tau, ydot = (held.from_doubles(given) for given in (states.x, states.y, tau, ydot))
    given = {"force": states.force, "torque": states.torque}
    loads = {what: None if load is None else held.from_doubles(load) for what, load in given.items()}
    if name == "mass_matrix":
        return library.mass_matrix(x)
    if name == "forcing":
        return library.forcing(x, y, **loads)
    if name == "inverse_dynamics":
        return library.inverse_dynamics(x, y, ydot, **loads)
    with warnings.catch_warnings(action="ignore", category=KanegenWarning):
        return library.forward_dynamics(x, y, tau=tau, **loads)
