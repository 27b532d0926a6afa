"""The result of a simulation: states over time, and the accuracy of the integration."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from kanegen.errors import OptionError
from kanegen.library import Library
from kanegen.model.arguments import Floats, NamedInputs
from kanegen.model.arrays import Floats as Doubles
from kanegen.simulation.accuracy import Drift, drift, mescd


@dataclass(frozen=True, repr=False)
class Trajectory:
    """The motion of a model from one state, or from B states at once.

    Attributes:
        library: Library that computed the accelerations.
        times: (T,) times, s.
        x: (T, m) or (T, B, m) coordinates, rad, m or 1.
        y: (T, n) or (T, B, n) generalized speeds, rad/s and m/s.
        work: (T,) or (T, B) work of the efforts since the first time, J.
        evaluations: Calls of `forward_dynamics`; one for all B states.
        prescribed: (T, 3, p) motion of the prescribed freedoms; None if there are none.

    Example:
        trajectory = kg.simulate(library, [0.1, 0.2], [0.0, 0.0], np.linspace(0, 10, 101), step=1e-3)
        last = trajectory.x[-1]
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
        """(T,) or (T, B) kinetic energy, J.

        Raises:
            OptionError: If the library has no output `kinetic_energy`.
        """
        return self._over_time(self.library.kinetic_energy, self.x, self.y)

    @property
    def potential_energy(self) -> Doubles:
        """(T,) or (T, B) potential energy of gravity and of force elements, J.

        Raises:
            OptionError: If the library has no output `potential_energy`.
        """
        return self._over_time(self.library.potential_energy, self.x)

    @property
    def momentum(self) -> Doubles:
        """(T, 6) or (T, B, 6) linear momentum, kg m/s, and angular momentum about the mass centre, kg m^2/s.

        Raises:
            OptionError: If the library has no output `momentum`.
        """
        return self._over_time(self.library.momentum, self.x, self.y)

    @property
    def energy_drift(self) -> Drift:
        """Drift of the energy less the work of the efforts, which is constant where nothing else does work.

        The scale is the largest of the range of the kinetic energy, the range of the potential energy and the
        first kinetic energy. None of these depends on where the potential energy is zero.

        Raises:
            OptionError: If the library has no energies, or nothing has moved.
        """
        kinetic, potential = self.kinetic_energy, self.potential_energy
        scale = max(float(np.ptp(kinetic)), float(np.ptp(potential)), float(np.abs(kinetic[0]).max()))
        if scale == 0.0:
            raise OptionError("energy drift: nothing has moved, so there is no energy to compare it with.")
        return drift(self.times, kinetic + potential - self.work, scale)

    def momentum_drift(
        self, linear: float | None = None, angular: float | None = None
    ) -> tuple[Drift, Drift]:
        """Return the drifts of linear and angular momentum, which are constant without loads from outside.

        Args:
            linear: Linear momentum that counts as one, kg m/s; by default the largest on the way.
            angular: Angular momentum that counts as one, kg m^2/s; by default the largest on the way.

        Raises:
            OptionError: If the library has no output `momentum`, or nothing has moved and no scale is given.

        Example:
            linear, angular = trajectory.momentum_drift()
        """
        momentum = self.momentum
        drifts = []
        for part, scale in ((momentum[..., :3], linear), (momentum[..., 3:], angular)):
            largest = float(np.linalg.norm(part, axis=-1).max())
            drifts.append(drift(self.times, part, largest if scale is None else scale))
        return drifts[0], drifts[1]

    def mescd(self, reference: Trajectory, floor: float = 1.0) -> float:
        """Return the correct digits of the least correct coordinate or speed at any time, as `mescd` does.

        Args:
            reference: A more accurate trajectory over the same times.
            floor: Size below which errors count as absolute.

        Raises:
            ArrayError: If the trajectories have different shapes.
            OptionError: If the trajectories have different times.

        Example:
            digits = coarse.mescd(fine)
        """
        if not np.array_equal(self.times, reference.times):
            raise OptionError("reference: it has other times. Simulate both over the same ones.")
        ours, exact = (np.concatenate([one.x, one.y], axis=-1) for one in (self, reference))
        return mescd(ours, exact, floor)

    def _over_time(self, output: Callable[..., Any], *arrays: Floats) -> Doubles:
        """Return the result of a method of the library at every time, called once for all states.

        Args:
            output: The method.
            arrays: Arguments of the method, (T, k) or (T, B, k).
        """
        lead = arrays[0].shape[:-1]
        flat = [np.ascontiguousarray(array.reshape(-1, array.shape[-1])) for array in arrays]
        inputs: NamedInputs = {}
        if self.prescribed is not None:
            inputs["prescribed"] = np.repeat(self.prescribed, len(flat[0]) // len(self.times), axis=0)
        found: Doubles = np.asarray(output(*flat, **inputs), np.float64)
        return found.reshape(*lead, *found.shape[1:])
