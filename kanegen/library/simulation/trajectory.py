"""States over time, and what they say about the method that made them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from kanegen.errors import OptionError
from kanegen.library import Library
from kanegen.library.simulation.accuracy import Drift, drift, mescd
from kanegen.model.arguments import Floats
from kanegen.model.arrays import Floats as Doubles
from kanegen.model.load_arguments import Given


@dataclass(frozen=True, repr=False)
class Trajectory:
    """The motion of a model, or of B states of it at once.

    Attributes:
        library: What computed the accelerations.
        times: (T,) s.
        x: (T, m) or (T, B, m) coordinates, rad, m or 1.
        y: (T, n) or (T, B, n) generalized speeds, rad/s and m/s.
        work: (T,) or (T, B) work of the efforts since the first time, J.
        evaluations: Calls of `forward_dynamics`; one for B states.
        prescribed: (T, 3, p) motion of the prescribed freedoms; None where there are none.
    """

    library: Library
    times: Doubles
    x: Floats
    y: Floats
    work: Floats
    evaluations: int
    prescribed: Floats | None = None

    def __repr__(self) -> str:
        span = f"{len(self.times)} times from {self.times[0]:g} to {self.times[-1]:g} s"
        return f"<Trajectory of {self.library.name}: {span}, {self.evaluations} evaluations>"

    @property
    def kinetic_energy(self) -> Doubles:
        """(T,) or (T, B), in J.

        Raises:
            OptionError: If the library has no such output; so for the other quantities.
        """
        return self._over_time(self.library.kinetic_energy, self.x, self.y)

    @property
    def potential_energy(self) -> Doubles:
        """(T,) or (T, B) of gravity and what force elements store, in J."""
        return self._over_time(self.library.potential_energy, self.x)

    @property
    def momentum(self) -> Doubles:
        """(T, 6) or (T, B, 6): linear (kg m/s), then angular about the mass centre (kg m^2/s)."""
        return self._over_time(self.library.momentum, self.x, self.y)

    @property
    def energy_drift(self) -> Drift:
        """Of the energy less the work of the efforts.

        It is relative to the largest of the range of the kinetic energy, that of the potential energy and the
        kinetic energy at first, none of which depends on where the potential energy is zero.
        """
        kinetic, potential = self.kinetic_energy, self.potential_energy
        scale = max(float(np.ptp(kinetic)), float(np.ptp(potential)), float(np.abs(kinetic[0]).max()))
        if scale == 0.0:
            raise OptionError("energy drift: nothing has moved, so there is no energy to compare it with.")
        return drift(self.times, kinetic + potential - self.work, scale)

    def momentum_drift(
        self, linear: float | None = None, angular: float | None = None
    ) -> tuple[Drift, Drift]:
        """Of the linear and of the angular momentum, which are constant where nothing acts from outside.

        Args:
            linear: What counts as one (kg m/s); by default the largest on the way.
            angular: The same (kg m^2/s).

        Raises:
            OptionError: If nothing has moved and no scale is given.
        """
        momentum = self.momentum
        drifts = []
        for part, scale in ((momentum[..., :3], linear), (momentum[..., 3:], angular)):
            largest = float(np.linalg.norm(part, axis=-1).max())
            drifts.append(drift(self.times, part, largest if scale is None else scale))
        return drifts[0], drifts[1]

    def mescd(self, reference: Trajectory, floor: float = 1.0) -> float:
        """Correct digits of the worst coordinate or speed at any time; see `mescd`.

        Raises:
            ArrayError: If the trajectories have different shapes.
            OptionError: If they are of different times.
        """
        if not np.array_equal(self.times, reference.times):
            raise OptionError("reference: it has other times. Simulate both over the same ones.")
        ours, exact = (np.concatenate([one.x, one.y], axis=-1) for one in (self, reference))
        return mescd(ours, exact, floor)

    def _over_time(self, output: Callable[..., Any], *arrays: Floats) -> Doubles:
        """An output at every time; a batch of batches is one long batch."""
        lead = arrays[0].shape[:-1]
        flat = [np.ascontiguousarray(array.reshape(-1, array.shape[-1])) for array in arrays]
        given: Given = {}
        if self.prescribed is not None:
            given["prescribed"] = np.repeat(self.prescribed, len(flat[0]) // len(self.times), axis=0)
        found: Doubles = np.asarray(output(*flat, **given), np.float64)
        return found.reshape(*lead, *found.shape[1:])
