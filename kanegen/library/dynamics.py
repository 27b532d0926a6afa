"""The equations of motion and their solution."""

from __future__ import annotations

import warnings
from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike

from kanegen.errors import ArrayError, KanegenWarning
from kanegen.library.compiled import Compiled
from kanegen.library.diagnosis import Diagnosis, diagnosis
from kanegen.model.arguments import Floats
from kanegen.model.load_arguments import Given


class Dynamics(Compiled):
    """[A], {f} and {ydot}, and how far this can be trusted."""

    def mass_matrix(self, x: ArrayLike, **given: Unpack[Given]) -> Floats:
        """[A] of Eq. (43).

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            given: As in `forcing`.

        Returns:
            (n, n) or (B, n, n), in kg m^2, kg m and kg.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If this output was not generated.
        """
        return self._run(self._call("mass_matrix"), (x,), given)[0]

    def forcing(
        self,
        x: ArrayLike,
        y: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **given: Unpack[Given],
    ) -> Floats:
        """{f} of Eq. (44).

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            force: (N, 3) or (B, N, 3) force on each body at its mass centre, in body components, N; one
                (N, 3) acts in every state of a batch, None is zero.
            torque: The same for the torque on each body, N m.
            given: Further inputs, by name, where the system has any.

        Returns:
            (n,) or (B, n), in N m and N.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If this output was not generated.
        """
        return self._run(self._call("forcing"), (x, y, None, None, force, torque), given)[0]

    def inverse_dynamics(
        self,
        x: ArrayLike,
        y: ArrayLike,
        ydot: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **given: Unpack[Given],
    ) -> Floats:
        """[A]{ydot} - {f}: the generalized forces that produce {ydot}, beside loads and gravity.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            ydot: Their rates, of the shape of `y`, rad/s^2 and m/s^2.
            force: As in `forcing`.
            torque: As in `forcing`.
            given: As in `forcing`.

        Returns:
            (n,) or (B, n), in N m and N.

        Raises:
            ArrayError: As in `forcing`.
            OptionError: If this output was not generated.
        """
        values = (x, y, ydot, None, force, torque)
        return self._run(self._call("inverse_dynamics"), values, given)[0]

    def prescribed_efforts(
        self,
        x: ArrayLike,
        y: ArrayLike,
        ydot: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **given: Unpack[Given],
    ) -> Floats:
        """Generalized forces that act at the prescribed freedoms, beside loads and gravity.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            ydot: Their rates, of the shape of `y`, rad/s^2 and m/s^2.
            force: As in `forcing`.
            torque: As in `forcing`.
            given: As in `forcing`; `prescribed` is among them.

        Returns:
            (p,) or (B, p), in the order of `prescribed_names`, in N m and N.

        Raises:
            ArrayError: As in `forcing`.
            OptionError: If this output was not generated.
        """
        values = (x, y, ydot, None, force, torque)
        return self._run(self._call("prescribed_efforts"), values, given)[0]

    def forward_dynamics(
        self,
        x: ArrayLike,
        y: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **given: Unpack[Given],
    ) -> Floats:
        """{ydot} of [A]{ydot} = {f} + {tau}.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            tau: (n,) or (B, n) generalized forces beside loads and gravity, N m and N; one (n,) acts in every
                state of a batch, None is zero.
            force: As in `forcing`.
            torque: As in `forcing`.
            given: As in `forcing`.

        Returns:
            (n,) or (B, n), in rad/s^2 and m/s^2. States of a batch in which [A] is singular have NaN, and a
            `KanegenWarning` counts them. Where the result is refined and still not accurate to 1e-12 (5e-4
            in single precision), a `KanegenWarning` says so.

        Raises:
            ArrayError: As in `forcing`.
            OptionError: If this output was not generated.
            SingularError: If [A] is singular in the one state, or the state is not finite; names the freedom.
        """
        values = (x, y, None, tau, force, torque)
        return self._run(self._call("forward_dynamics"), values, given)[0]

    def error_estimate(
        self,
        x: ArrayLike,
        y: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **given: Unpack[Given],
    ) -> Floats:
        """How much a first step of refinement changes each entry of {ydot}: about its error without any.

        It does not see what is lost where loads, gravity, speeds and {tau} cancel.

        Args:
            x: As in `forward_dynamics`, like everything else.
            y: Generalized speeds.
            tau: Generalized forces.
            force: Forces on the bodies.
            torque: Torques on the bodies.
            given: Further inputs.

        Returns:
            (n,) or (B, n), in rad/s^2 and m/s^2, not negative.

        Raises:
            ArrayError, OptionError, SingularError: As `forward_dynamics`.
        """
        values = (x, y, None, tau, force, torque)
        return self._run(self._call("error_estimate"), values, given)[0]

    def regularity(self, x: ArrayLike, **given: Unpack[Given]) -> Floats:
        """For each freedom its pivot in the elimination over its inertia, the entry on the diagonal of [A].

        That is the share that is left where the freedoms eliminated before it may move: 1 where they do not
        matter, 0 where [A] is singular. A joint whose three angles have their rates as speeds is eliminated
        in the body's frame; there the share of theta1 holds the square of the distance to the state where
        the angles fail, cos^2(theta2).

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            given: As in `forcing`.

        Returns:
            (n,) or (B, n).

        Raises:
            ArrayError: If `x` has the wrong shape or type.
            OptionError: If this output was not generated.
        """
        return self._run(self._call("regularity"), (x,), given)[0]

    def diagnose(
        self,
        x: ArrayLike,
        y: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **given: Unpack[Given],
    ) -> Diagnosis:
        """How far `forward_dynamics` can be trusted in these states, and which freedom is the worst.

        Singular states are counted, not refused.

        Args:
            x: As in `forward_dynamics`, like everything else.
            y: Generalized speeds.
            tau: Generalized forces.
            force: Forces on the bodies.
            torque: Torques on the bodies.
            given: Further inputs.

        Raises:
            ArrayError: As `forward_dynamics`, and if there is no state.
            OptionError: If "forward_dynamics", "error_estimate" and "regularity" were not all generated.
        """
        for name in ("forward_dynamics", "error_estimate", "regularity"):
            self._call(name)
        x, y = np.atleast_2d(np.asarray(x)), np.atleast_2d(np.asarray(y))
        if not len(x):
            raise ArrayError("diagnose: there is no state, the batch is empty.")
        with warnings.catch_warnings(action="ignore", category=KanegenWarning):
            acceleration = self.forward_dynamics(x, y, tau, force, torque, **given)
            estimate = self.error_estimate(x, y, tau, force, torque, **given)
        return diagnosis(self.source.model, x, acceleration, estimate, self.regularity(x, **given))
