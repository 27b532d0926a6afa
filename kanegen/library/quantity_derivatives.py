"""Derivatives of outputs about positions, velocities, momentum and energies."""

from __future__ import annotations

from typing import Unpack

from numpy.typing import ArrayLike

from kanegen.library.compiled import CompiledModel
from kanegen.model.arguments import Floats, NamedInputs


class QuantityDerivatives(CompiledModel):
    """Methods for the derivatives of the outputs of `Quantities`.

    The last axis of a result has K columns, one for each differentiation variable: {x}, then {y} where the
    output depends on it, then the run-time parameters; `derivative_columns` gives their order.
    """

    def coordinate_rates_derivatives(
        self, x: ArrayLike, y: ArrayLike, **inputs: Unpack[NamedInputs]
    ) -> Floats:
        """Return the derivatives of the rates {xdot} of the coordinates by {x}, {y} and the parameters.

        The derivative with respect to {y} is the matrix of Eq. (9) where speeds are angular
        velocities, else the identity.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (m, K) or (B, m, K): a row for each coordinate, the unit of its rate over the units of
            the variables.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.
            StatusError: See `with_on_status`; by default a `SingularError` if three angles are in gimbal lock
                in a single state.

        Example:
            by = library.derivative_columns("coordinate_rates_derivatives")
            rate_map = library.coordinate_rates_derivatives(x, y)[:, by["y"]]
        """
        return self._run("coordinate_rates_derivatives", (x, y), inputs)[0]

    def point_positions_derivatives(self, x: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the derivatives of the positions {p_P} of the points by {x} and the parameters.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (P, 3, K) or (B, P, 3, K): a row for each point and component, m over the units of the
            variables.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            by = library.derivative_columns("point_positions_derivatives")
            slopes = library.point_positions_derivatives(x)[..., by["parameters"]]
        """
        return self._run("point_positions_derivatives", (x,), inputs)[0]

    def point_velocities_derivatives(
        self, x: ArrayLike, y: ArrayLike, **inputs: Unpack[NamedInputs]
    ) -> Floats:
        """Return the derivatives of the velocities {v_P} of the points by {x}, {y} and the parameters.

        The derivative with respect to {y} holds the partial velocities, Eq. (32).

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (P, 3, K) or (B, P, 3, K): a row for each point and component, m/s over the units of
            the variables.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            slopes = library.point_velocities_derivatives(x, y)
        """
        return self._run("point_velocities_derivatives", (x, y), inputs)[0]

    def point_accelerations_derivatives(
        self, x: ArrayLike, y: ArrayLike, ydot: ArrayLike, **inputs: Unpack[NamedInputs]
    ) -> Floats:
        """Return the derivatives of the accelerations {a_P} of the points by {x}, {y} and the parameters.

        Accelerations {ydot} are held fixed; the derivative by them holds the partial velocities, Eq. (32).

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            ydot: (n,) or (B, n) generalized accelerations, rad/s^2 and m/s^2.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (P, 3, K) or (B, P, 3, K): a row for each point and component, m/s^2 over the units of
            the variables.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            slopes = library.point_accelerations_derivatives(x, y, ydot)
        """
        return self._run("point_accelerations_derivatives", (x, y, ydot), inputs)[0]

    def kinetic_energy_derivatives(self, x: ArrayLike, y: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the derivatives of the kinetic energy by {x}, {y} and the parameters.

        The derivatives with respect to {y} are the generalized momenta.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (K,) or (B, K), J over the units of the variables.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            by = library.derivative_columns("kinetic_energy_derivatives")
            momenta = library.kinetic_energy_derivatives(x, y)[by["y"]]
        """
        return self._run("kinetic_energy_derivatives", (x, y), inputs)[0]

    def potential_energy_derivatives(self, x: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the derivatives of the potential energy by {x} and the parameters.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (K,) or (B, K), J over the units of the variables.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            slopes = library.potential_energy_derivatives(x)
        """
        return self._run("potential_energy_derivatives", (x,), inputs)[0]

    def momentum_derivatives(self, x: ArrayLike, y: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the derivatives of linear and angular momentum by {x}, {y} and the parameters.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (6, K) or (B, 6, K): a row for each component, kg m/s and kg m^2/s over the units of
            the variables.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            slopes = library.momentum_derivatives(x, y)
        """
        return self._run("momentum_derivatives", (x, y), inputs)[0]

    def centroidal_momentum_bias_derivatives(
        self, x: ArrayLike, y: ArrayLike, **inputs: Unpack[NamedInputs]
    ) -> Floats:
        """Return the derivatives of the bias of the centroidal momentum by {x}, {y} and the parameters.

        Those of [A_G]{y} by {x}, with {ydot} in place of {y}, are the first columns of
        `momentum_derivatives`; the two together are the derivatives of the rate of the momentum.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (6, K) or (B, 6, K): a row for each component, N and N m over the units of the variables.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            slopes = library.centroidal_momentum_bias_derivatives(x, y)
        """
        return self._run("centroidal_momentum_bias_derivatives", (x, y), inputs)[0]

    def mass_center_derivatives(self, x: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the derivatives of the position {p_C} of the mass centre by {x} and the parameters.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (3, K) or (B, 3, K): a row for each component, m over the units of the variables.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            slopes = library.mass_center_derivatives(x)
        """
        return self._run("mass_center_derivatives", (x,), inputs)[0]
