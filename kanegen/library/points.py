"""Outputs about the points of a model."""

from __future__ import annotations

from typing import Unpack

from numpy.typing import ArrayLike

from kanegen.library.compiled import Compiled
from kanegen.model.arguments import Floats
from kanegen.model.load_arguments import Given


class Points(Compiled):
    """Positions, velocities, accelerations and partial velocities, in the order of `point_names`."""

    def point_positions(self, x: ArrayLike, **given: Unpack[Given]) -> Floats:
        """Positions of the points of the model from the inertial origin, in the order of `point_names`.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            given: As in `forcing`.

        Returns:
            (P, 3) or (B, P, 3), inertial components, in m.

        Raises:
            ArrayError: If `x` has the wrong shape or type.
            OptionError: If this output was not generated.
        """
        return self._run(self._call("point_positions"), (x,), given)[0]

    def point_velocities(self, x: ArrayLike, y: ArrayLike, **given: Unpack[Given]) -> Floats:
        """Velocities of the points of the model.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            given: As in `forcing`.

        Returns:
            (P, 3) or (B, P, 3), inertial components, in m/s.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If this output was not generated.
        """
        return self._run(self._call("point_velocities"), (x, y), given)[0]

    def point_accelerations(
        self, x: ArrayLike, y: ArrayLike, ydot: ArrayLike, **given: Unpack[Given]
    ) -> Floats:
        """Accelerations of the points of the model; gravity is no part of them.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            ydot: Their rates, of the shape of `y`, rad/s^2 and m/s^2.
            given: As in `forcing`.

        Returns:
            (P, 3) or (B, P, 3), inertial components, in m/s^2.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If this output was not generated.
        """
        return self._run(self._call("point_accelerations"), (x, y, ydot), given)[0]

    def point_jacobians(self, x: ArrayLike, **given: Unpack[Given]) -> Floats:
        """Partial velocities of the points of the model by {y}.

        Where nothing is prescribed, `point_velocities` is their product with it.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            given: As in `forcing`.

        Returns:
            (P, 3, n) or (B, P, 3, n), inertial components, in m and 1.

        Raises:
            ArrayError: If `x` has the wrong shape or type.
            OptionError: If this output was not generated.
        """
        return self._run(self._call("point_jacobians"), (x,), given)[0]
