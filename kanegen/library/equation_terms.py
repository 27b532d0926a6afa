"""Outputs that are parts of the equations of motion: of {f}, and matrices beside [A]."""

from __future__ import annotations

from typing import Unpack

from numpy.typing import ArrayLike

from kanegen.library.compiled import CompiledModel
from kanegen.model.arguments import Floats, NamedInputs


class EquationTerms(CompiledModel):
    """Methods for the parts of {f} by gravity and by motion, for the Coriolis matrix, and for [A]^-1."""

    def gravity_forces(self, x: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the part of {f} that gravity causes: the sum of [v_G,y]^T m {g} over the bodies, Eq. (44).

        {f} is the sum of `gravity_forces`, of `velocity_forces` and of what loads and force elements apply.
        So a system without these stays at rest under generalized forces that are the opposite of
        `gravity_forces`. Where all speeds are rates, they are minus the derivatives by {x} of the energy of
        gravity.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n,) or (B, n), N m and N.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            holding = -library.gravity_forces(x)
        """
        return self._run("gravity_forces", (x,), inputs)[0]

    def velocity_forces(self, x: ArrayLike, y: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the part of {f} that {y} and prescribed motion cause, Eqs. (39)-(41) for {ydot} = {0}.

        These are centrifugal, Coriolis and gyroscopic forces, without gravity, loads and force elements; with
        the inertia forces of prescribed accelerations. They are -C{y} with `coriolis_matrix` where nothing is
        prescribed.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n,) or (B, n), N m and N.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            applied = library.forcing(x, y) - library.gravity_forces(x) - library.velocity_forces(x, y)
        """
        return self._run("velocity_forces", (x, y), inputs)[0]

    def coriolis_matrix(self, x: ArrayLike, y: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the Coriolis matrix [C]: the sum of m [v_P,y]^T [dv_P,y/dt] over all particles P.

        [v_P,y] are the partial velocities of a particle, and time derivatives are those in inertial space. As
        [A] is the sum of m [v_P,y]^T [v_P,y], this means for every kind of speeds:

        - [dA/dt] - 2 [C] is skew, and [dA/dt] = [C] + [C]^T;
        - [C]{y} = -velocity_forces where nothing is prescribed. Prescribed motion counts in [dv_P,y/dt], and
          in [dA/dt]; what it causes beside the speeds {y} is in `velocity_forces` alone.

        Where all speeds are rates of coordinates, [C] is the matrix of Christoffel symbols,
        C_ij = sum of (dA_ij/dx_k + dA_ik/dx_j - dA_jk/dx_i) y_k / 2, or half the derivative of [C]{y} by {y}.
        With angular velocities as speeds, that half derivative does not make [dA/dt] - 2 [C] skew, and [C] is
        the sum above: for the angular velocity {w} of a free body with the central inertia [I] it is the skew
        matrix of tr[I]/2 {w} - [I]{w}. For bodies, it is the factorisation of Niemeyer and Slotine (1990) and
        Echeandia and Wensing (2021). Reflected inertia adds nothing to [C], rotors add Christoffel symbols.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n, n) or (B, n, n), kg m^2/s, kg m/s and kg/s.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            needed = library.coriolis_matrix(x, y) @ y  # -library.velocity_forces(x, y)
        """
        return self._run("coriolis_matrix", (x, y), inputs)[0]

    def mass_matrix_inverse(self, x: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the inverse of the generalized mass matrix [A] of Eq. (43).

        Column j holds what a unit generalized force at freedom j adds to {ydot}. To solve [A]{ydot} = {b} for
        few right sides, `forward_dynamics` costs less.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n, n) or (B, n, n), both halves equal to the last bit, 1/(kg m^2), 1/(kg m) and 1/kg. Where [A]
            is singular they are missing: NaN in a batch.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.
            StatusError: See `with_on_status`; by default a `SingularError` if [A] is singular in a single
                state. The message names the freedom.

        Example:
            A_inverse = library.mass_matrix_inverse(x)
        """
        return self._run("mass_matrix_inverse", (x,), inputs)[0]
