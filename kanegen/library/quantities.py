"""What else there is to know of a state."""

from __future__ import annotations

from typing import Unpack

from numpy.typing import ArrayLike

from kanegen.library.compiled import Compiled
from kanegen.model.arguments import Floats
from kanegen.model.load_arguments import Given


class Quantities(Compiled):
    """Energies, momentum, mass centre, poses of the bodies, rates of the coordinates."""

    def kinetic_energy(self, x: ArrayLike, y: ArrayLike, **given: Unpack[Given]) -> Floats:
        """Kinetic energy of all bodies in inertial space; {y}^T [A] {y} / 2 where nothing is prescribed.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            given: As in `forcing`.

        Returns:
            () or (B,), in J.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If this output was not generated.
        """
        return self._run(self._call("kinetic_energy"), (x, y), given)[0]

    def potential_energy(self, x: ArrayLike, **given: Unpack[Given]) -> Floats:
        """Potential energy of gravity: minus the sum of m g . p_G over the bodies.

        It is zero where all mass centres are at the inertial origin, and everywhere without gravity.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            given: As in `forcing`.

        Returns:
            () or (B,), in J.

        Raises:
            ArrayError: If `x` has the wrong shape or type.
            OptionError: If this output was not generated.
        """
        return self._run(self._call("potential_energy"), (x,), given)[0]

    def momentum(self, x: ArrayLike, y: ArrayLike, **given: Unpack[Given]) -> Floats:
        """Linear momentum of all bodies, then their angular momentum about their common mass centre.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            given: As in `forcing`.

        Returns:
            (6,) or (B, 6), inertial components: three in kg m/s, then three in kg m^2/s.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If this output was not generated.
        """
        return self._run(self._call("momentum"), (x, y), given)[0]

    def mass_center(self, x: ArrayLike, **given: Unpack[Given]) -> Floats:
        """Position of the mass centre of all bodies from the inertial origin.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            given: As in `forcing`.

        Returns:
            (3,) or (B, 3), inertial components, in m; NaN where parameters make all masses 0.

        Raises:
            ArrayError: If `x` has the wrong shape or type.
            OptionError: If this output was not generated.
        """
        return self._run(self._call("mass_center"), (x,), given)[0]

    def body_poses(self, x: ArrayLike, **given: Unpack[Given]) -> Floats:
        """Rotation and origin of every body, or of those that the system names: Eqs. (3) and (22).

        Body K, which is `pose_names[i]`, has `poses[..., i, :, :]`. Its rows 0 to 2 are [R_K], which takes
        inertial components to body components, so they are the basis vectors of K in inertial components; row
        3 is the position of O_K from the inertial origin, in inertial components (m). A point {r'} of K is at
        [R_K]^T {r'} + {p_O_K}.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            given: As in `forcing`.

        Returns:
            (N, 4, 3) or (B, N, 4, 3), N being the number of `pose_names`.

        Raises:
            ArrayError: If `x` has the wrong shape or type.
            OptionError: If this output was not generated.
        """
        return self._run(self._call("body_poses"), (x,), given)[0]

    def coordinate_rates(self, x: ArrayLike, y: ArrayLike, **given: Unpack[Given]) -> Floats:
        """{xdot}: Eq. (9) where speeds are components of angular velocities, else {y}.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            given: As in `forcing`.

        Returns:
            (m,) or (B, m), in rad/s, m/s and 1/s. States of a batch in which the angles of a body have no
            rates have NaN, and a `KanegenWarning` counts them.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If this output was not generated.
            SingularError: If the axes of three angles lie in a plane in the one state; names the middle one.
        """
        return self._run(self._call("coordinate_rates"), (x, y), given)[0]
