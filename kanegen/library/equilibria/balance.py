"""The forces that vanish in an equilibrium, with their derivatives, for many states at once."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from kanegen.library.library import Library
from kanegen.model.arguments import NamedInputs

Floats = NDArray[np.float64]


SINGULAR = 1e-12
"""Share of its inertia that a freedom keeps below which [A] counts as singular."""


@dataclass(frozen=True)
class Balance:
    """{f} + {tau} of a library for given speeds.

    Attributes:
        library: The library, which ignores statuses.
        y: (n,) generalized speeds.
        tau: (n,) generalized forces.
        inputs: Inputs that only some systems have.
    """

    library: Library
    y: Floats
    tau: Floats
    inputs: NamedInputs = field(default_factory=NamedInputs)

    def forces(self, x: Floats) -> Floats:
        """Return (B, n) forces in B states; NaN where they are undefined."""
        found = self.library.forcing(x, self._many(x), **self.inputs)
        return np.asarray(found, np.float64) + self.tau

    def slopes(self, x: Floats) -> Floats:
        """Return (B, n, m) derivatives of the forces by the coordinates."""
        by = self.library.derivative_columns("forcing_derivatives")["x"]
        found = np.asarray(self.library.forcing_derivatives(x, self._many(x), **self.inputs), np.float64)
        return found[:, :, by]

    def accelerations(self, x: Floats) -> Floats:
        """Return (B, n) accelerations in B states; NaN where [A] is singular."""
        tau = np.broadcast_to(self.tau, (len(x), len(self.tau))).copy()
        found = self.library.forward_dynamics(x, self._many(x), tau, **self.inputs)
        return np.asarray(found, np.float64)

    def is_regular(self, x: Floats) -> bool:
        """Return whether [A] is regular in a state, beyond rounding errors such as in gimbal lock."""
        return bool(np.min(self.library.regularity(x, **self._of_x)) > SINGULAR)

    def energies(self, x: Floats) -> Floats:
        """Return the (B,) potential energies of B states."""
        return np.asarray(self.library.potential_energy(x, **self._of_x), np.float64)

    def poses(self, x: Floats) -> Floats:
        """Return (B, 12 k) rotations and origins of the bodies."""
        return np.asarray(self.library.body_poses(x, **self._of_x), np.float64).reshape(len(x), -1)

    def potential_forces(self, x: Floats) -> Floats:
        """Return (B, n) minus the derivatives of the potential energy along the speeds."""
        by = self.library.derivative_columns("potential_energy_derivatives")["x"]
        slopes = np.asarray(self.library.potential_energy_derivatives(x, **self._of_x), np.float64)[:, by]
        forces: Floats = -np.einsum("bm,bmn->bn", slopes, self.rate_maps(x))
        return forces

    def rate_maps(self, x: Floats) -> Floats:
        """Return (B, m, n) matrices [H] of {xdot} = [H]{y}."""
        n = self.library.n
        if self.library.source.model.speeds_are_rates:
            return np.broadcast_to(np.eye(n), (len(x), n, n))
        by = self.library.derivative_columns("coordinate_rates_derivatives")["y"]
        found = self.library.coordinate_rates_derivatives(x, self._many(x), **self._of_x)
        return np.asarray(found, np.float64)[:, :, by]

    @property
    def _of_x(self) -> NamedInputs:
        """The inputs of functions of the position alone."""
        return {"prescribed": self.inputs["prescribed"]} if "prescribed" in self.inputs else {}

    def _many(self, x: Floats) -> Floats:
        return np.broadcast_to(self.y, (len(x), len(self.y))).copy()
