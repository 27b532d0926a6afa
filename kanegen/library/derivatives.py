"""Outputs that are derivatives of others."""

from __future__ import annotations

from typing import Unpack

from numpy.typing import ArrayLike

from kanegen.choices import require_one
from kanegen.library.compiled import Compiled
from kanegen.model.arguments import Floats
from kanegen.model.load_arguments import Given
from kanegen.recursion.outputs import DERIVATIVES


class Derivatives(Compiled):
    """Of {f}, of generalized forces and of {ydot}."""

    def forcing_derivatives(
        self,
        x: ArrayLike,
        y: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **given: Unpack[Given],
    ) -> Floats:
        """Derivatives of {f} by {x}, {y} and the run-time parameters; `derivative_columns` says where.

        Args:
            x: As in `forcing`, like everything else.
            y: Generalized speeds.
            force: Forces on the bodies.
            torque: Torques on the bodies.
            given: Further inputs.

        Returns:
            (n, K) or (B, n, K): a row for each freedom, in N m and N over the units of what it is by.

        Raises:
            ArrayError, OptionError: As `forcing`.
        """
        return self._run(self._call("forcing_derivatives"), (x, y, None, None, force, torque), given)[0]

    def inverse_dynamics_derivatives(
        self,
        x: ArrayLike,
        y: ArrayLike,
        ydot: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **given: Unpack[Given],
    ) -> Floats:
        """Derivatives of [A]{ydot} - {f} by {x}, {y} and the run-time parameters; by {ydot} it is [A].

        Args:
            x: As in `inverse_dynamics`, like everything else.
            y: Generalized speeds.
            ydot: Their rates.
            force: Forces on the bodies.
            torque: Torques on the bodies.
            given: Further inputs.

        Returns:
            (n, K) or (B, n, K), as `forcing_derivatives`.

        Raises:
            ArrayError, OptionError: As `inverse_dynamics`.
        """
        values = (x, y, ydot, None, force, torque)
        return self._run(self._call("inverse_dynamics_derivatives"), values, given)[0]

    def forward_dynamics_derivatives(
        self,
        x: ArrayLike,
        y: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **given: Unpack[Given],
    ) -> Floats:
        """Derivatives of {ydot} by {x}, {y}, {tau}, which are [A]^-1, and the run-time parameters.

        Args:
            x: As in `forward_dynamics`, like everything else.
            y: Generalized speeds.
            tau: Generalized forces.
            force: Forces on the bodies.
            torque: Torques on the bodies.
            given: Further inputs.

        Returns:
            (n, K) or (B, n, K), in rad/s^2 and m/s^2 over the units of what they are by; NaN where [A] is
            singular in a state of a batch.

        Raises:
            ArrayError, OptionError, SingularError: As `forward_dynamics`.
        """
        values = (x, y, None, tau, force, torque)
        return self._run(self._call("forward_dynamics_derivatives"), values, given)[0]

    def derivative_columns(self, output: str) -> dict[str, slice]:
        """Which of the last axis of an output of derivatives is by "x", "y", "tau" and "parameters".

        Raises:
            OptionError: If there is no such output.
        """
        require_one("output of derivatives", output, DERIVATIVES)
        m, n = len(self.coordinate_names), self.n
        return DERIVATIVES[output].columns(m, n, len(self._parameters))
