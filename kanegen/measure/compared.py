"""What is compared: the outputs that have a reference, what a library must have, and the sizes of terms."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from numpy.typing import NDArray

from kanegen.model.arrays import Floats, SystemArrays
from kanegen.reference.kinematics import kinematics
from kanegen.reference.magnitudes import (
    element_magnitude,
    forcing_magnitude,
    mass_matrix_magnitude,
    path_maxima,
    rotor_forcing_magnitude,
)
from kanegen.reference.states import States

OUTPUTS = ("mass_matrix", "forcing")
"""Outputs that the reference computes."""


class ComparedLibrary(Protocol):
    """The functions of a library that `compare` calls; batches have a leading axis B."""

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs that the library computes."""

    @property
    def mass_matrix(self) -> Callable[..., NDArray[Any]]:
        """Function that returns (B, n, n) [A] from (B, m) x and the named `States.inputs`."""

    @property
    def forcing(self) -> Callable[..., NDArray[Any]]:
        """Function that returns (B, n) {f} from x, y, the loads by name and the named `States.inputs`."""


def term_magnitudes(arrays: SystemArrays, states: States) -> dict[str, Floats]:
    """Return S, the magnitudes of the terms of (B, n, n) [A] and (B, n) {f}, by output."""
    x, y, prescribed = states.x, states.y, states.prescribed
    bodies = kinematics(arrays, x, y, prescribed)
    maxima = path_maxima(arrays, bodies, y, prescribed)
    forcing = forcing_magnitude(arrays, maxima, states.force, states.torque)
    forcing = forcing + element_magnitude(arrays, bodies, x, y, **states.inputs)
    forcing = forcing + rotor_forcing_magnitude(arrays, maxima, y, prescribed)
    return {"mass_matrix": mass_matrix_magnitude(arrays, maxima), "forcing": forcing}
