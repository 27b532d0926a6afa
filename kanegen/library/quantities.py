"""Outputs about positions, velocities, momentum and energies in a state."""

from __future__ import annotations

from typing import Unpack

from numpy.typing import ArrayLike

from kanegen.library.compiled import CompiledModel
from kanegen.model.arguments import Floats, NamedInputs


class Quantities(CompiledModel):
    """Methods for coordinate rates, points, mass centre, momentum and energies."""

    def coordinate_rates(self, x: ArrayLike, y: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the rates {xdot} of the coordinates: Eq. (9) for angular velocities as speeds, else {y}.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (m,) or (B, m), rad/s, m/s and 1/s. Where three angles are in gimbal lock they are missing: NaN in
            a batch.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.
            StatusError: See `with_on_status`; by default a `SingularError` if three angles are in gimbal lock
                in a single state. The message names the middle one.

        Example:
            xdot = library.coordinate_rates(x, y)
        """
        return self._run("coordinate_rates", (x, y), inputs)[0]

    def point_positions(self, x: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the positions {p_P} of the points from the inertial origin, Eq. (22).

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (P, 3) or (B, P, 3) in the order of `point_names`, inertial components, m.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            tip = library.point_positions(x)[library.point_names.index("tip")]
        """
        return self._run("point_positions", (x,), inputs)[0]

    def point_velocities(self, x: ArrayLike, y: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the velocities {v_P} of the points in inertial space, Eq. (27).

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (P, 3) or (B, P, 3) in the order of `point_names`, inertial components, m/s.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            velocities = library.point_velocities(x, y)
        """
        return self._run("point_velocities", (x, y), inputs)[0]

    def point_accelerations(
        self, x: ArrayLike, y: ArrayLike, ydot: ArrayLike, **inputs: Unpack[NamedInputs]
    ) -> Floats:
        """Return the accelerations {a_P} of the points in inertial space, without gravity, Eq. (33).

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            ydot: (n,) or (B, n) generalized accelerations, rad/s^2 and m/s^2.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (P, 3) or (B, P, 3) in the order of `point_names`, inertial components, m/s^2.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            accelerations = library.point_accelerations(x, y, ydot)
        """
        return self._run("point_accelerations", (x, y, ydot), inputs)[0]

    def point_jacobians(self, x: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the partial velocities [v_P,y] of the points with respect to {y}, Eq. (32).

        Where nothing is prescribed, `point_velocities` are their products with {y}.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (P, 3, n) or (B, P, 3, n) in the order of `point_names`, inertial components, m and 1.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            velocities = library.point_jacobians(x) @ y
        """
        return self._run("point_jacobians", (x,), inputs)[0]

    def mass_center(self, x: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the position {p_C} of the mass centre of all bodies from the inertial origin.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (3,) or (B, 3) inertial components, m; NaN if the parameters make every mass 0.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            height = library.mass_center(x)[2]
        """
        return self._run("mass_center", (x,), inputs)[0]

    def momentum(self, x: ArrayLike, y: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the linear momentum of all bodies and their angular momentum about their mass centre.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (6,) or (B, 6) inertial components: linear momentum, kg m/s, then angular momentum, kg m^2/s.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            linear, angular = np.split(library.momentum(x, y), 2)
        """
        return self._run("momentum", (x, y), inputs)[0]

    def centroidal_momentum_matrix(self, x: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the centroidal momentum matrix [A_G] (Orin, Goswami and Lee 2013).

        Where nothing is prescribed, `momentum` is its product with {y}.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (6, n) or (B, 6, n) inertial components: three rows of linear momentum, kg m and kg, then three of
            angular momentum about the mass centre of all bodies, kg m^2 and kg m.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            momentum = library.centroidal_momentum_matrix(x) @ y
        """
        return self._run("centroidal_momentum_matrix", (x,), inputs)[0]

    def centroidal_momentum_bias(self, x: ArrayLike, y: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the rate of the momentum of all bodies for {ydot} = 0 (Orin, Goswami and Lee 2013).

        The rate of `momentum` is [A_G]{ydot} plus this bias, which is d[A_G]/dt {y} and what prescribed
        motion adds. The weight of the bodies is no part of it.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (6,) or (B, 6) inertial components: linear, N, then angular about the mass centre, N m.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            rate = library.centroidal_momentum_matrix(x) @ ydot + library.centroidal_momentum_bias(x, y)
        """
        return self._run("centroidal_momentum_bias", (x, y), inputs)[0]

    def kinetic_energy(self, x: ArrayLike, y: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the kinetic energy of all bodies; it is {y}^T [A] {y} / 2 where nothing is prescribed.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            () or (B,), J.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            energy = library.kinetic_energy(x, y) + library.potential_energy(x)
        """
        return self._run("kinetic_energy", (x, y), inputs)[0]

    def potential_energy(self, x: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the potential energy of gravity and of the force elements that store energy.

        That of gravity is minus the sum of m g . p_G over the bodies: zero where all mass centres are at the
        inertial origin.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            () or (B,), J.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            energy = library.potential_energy(x)
        """
        return self._run("potential_energy", (x,), inputs)[0]
