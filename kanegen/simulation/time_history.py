"""The time history of a motion: its states, the outputs of a library along it, energies and momentum."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from kanegen.library import Library
from kanegen.model.arguments import Floats, NamedInputs
from kanegen.model.arrays import Floats as Doubles
from kanegen.recursion.outputs import OUTPUTS
from kanegen.simulation.accuracy import Drift
from kanegen.simulation.conservation import energy_drift, momentum_drifts


@dataclass(frozen=True, repr=False)
class TimeHistory:
    """States over the time and what acted on them, and what a library computes from both.

    The attributes are those of `Trajectory`.
    """

    library: Library
    times: Doubles
    x: Floats
    y: Floats
    work: Floats
    evaluations: int
    inputs: Mapping[str, Floats] = field(default_factory=dict)

    @property
    def states(self) -> int | None:
        """Number B of states that moved at once; None for a single one."""
        return self.x.shape[1] if self.x.ndim > 2 else None

    @property
    def kinetic_energy(self) -> Doubles:
        """(T,) or (T, B) kinetic energy, J.

        Raises:
            OptionError: If the library has no output `kinetic_energy`.
        """
        return self._over_time("kinetic_energy")

    @property
    def potential_energy(self) -> Doubles:
        """(T,) or (T, B) potential energy of gravity and of force elements, J.

        Raises:
            OptionError: If the library has no output `potential_energy`.
        """
        return self._over_time("potential_energy")

    @property
    def momentum(self) -> Doubles:
        """(T, 6) or (T, B, 6) linear momentum, kg m/s, and angular momentum about the mass centre, kg m^2/s.

        Raises:
            OptionError: If the library has no output `momentum`.
        """
        return self._over_time("momentum")

    @property
    def energy_drift(self) -> Drift:
        """Drift of the energy less the work of the efforts, which is constant where nothing else does work.

        The scale is the largest of the range of the kinetic energy, the range of the potential energy and the
        first kinetic energy. None of these depends on where the potential energy is zero.

        Raises:
            OptionError: If the library has no energies, or nothing has moved.
        """
        return energy_drift(self.times, self.kinetic_energy, self.potential_energy, self.work)

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
        return momentum_drifts(self.times, self.momentum, linear, angular)

    def _over_time(self, output: str) -> Doubles:
        """Return an output of the library at every time, called once for all states.

        Raises:
            OptionError: If the library was built without it.
        """
        if output == "forward_dynamics":
            return self._accelerations
        arguments: dict[str, Floats] = {"x": self.x, "y": self.y, **self.inputs}
        if "ydot" in OUTPUTS[output].inputs and output in self.library.source.outputs:
            arguments["ydot"] = self._accelerations
        return self._evaluated(output, arguments)

    @cached_property
    def _accelerations(self) -> Doubles:
        """(T, n) or (T, B, n) generalized accelerations {ydot}, rad/s^2 and m/s^2."""
        return self._evaluated("forward_dynamics", {"x": self.x, "y": self.y, **self.inputs})

    def _evaluated(self, output: str, arguments: Mapping[str, Floats]) -> Doubles:
        """Return an output of the library from arguments with an axis for the times."""
        lead = self.x.shape[:-1]
        taken = [name for name in (*OUTPUTS[output].arguments, *self.library.further_inputs)]
        given: NamedInputs = {}
        for name in taken:
            values = self.times if name == "t" else arguments.get(name)
            if values is not None:
                given[name] = _of_all_states(name, values, lead)  # type: ignore[literal-required]
        found: Doubles = np.asarray(getattr(self.library, output)(**given), np.float64)
        return found.reshape(*lead, *found.shape[1:])


def _of_all_states(name: str, values: Floats, lead: tuple[int, ...]) -> Floats:
    """Return the values of an argument with one first axis for all times and states.

    Args:
        name: Name of the argument.
        values: Its values over the times, or over times and states; all states share those over the times.
        lead: Numbers of times and, for several states, of states.
    """
    own = {"x": 1, "y": 1, "ydot": 1, "tau": 1, "t": 0}.get(name, 2)
    if values.ndim < len(lead) + own:
        values = values[:, None]
    whole = np.broadcast_to(values, (*lead, *values.shape[len(lead) :]))
    return np.ascontiguousarray(whole.reshape(-1, *values.shape[len(lead) :]))
