"""Outputs for the identification of inertial parameters."""

from __future__ import annotations

from typing import Unpack

from numpy.typing import ArrayLike

from kanegen.library.compiled import CompiledModel
from kanegen.model.arguments import Floats, NamedInputs


class Identification(CompiledModel):
    """Methods for regressors."""

    def regressor(self, x: ArrayLike, y: ArrayLike, ydot: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the regressor [Y] of [A]{ydot} - {f} = [Y]{pi}, for the inertial parameters of all bodies.

        The columns of a body belong to its mass, its first moment (x, y, z) and its inertia (xx, xy, yy, xz,
        yz, zz) about the origin of its frame, in its components; `kanegen.inertial_parameters` has their
        values in a model. Gravity is included. Loads, force elements, armature and rotors are not: they add
        to [Y]{pi}. No number of {pi} enters the code (Atkeson, An and Hollerbach 1986).

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            ydot: (n,) or (B, n) generalized accelerations, rad/s^2 and m/s^2.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n, 10 N) or (B, n, 10 N), N m and N over kg, kg m and kg m^2.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            tau = library.regressor(x, y, ydot) @ kg.inertial_parameters(system)
        """
        return self._run("regressor", (x, y, ydot), inputs)[0]

    def base_regressor(
        self, x: ArrayLike, y: ArrayLike, ydot: ArrayLike, **inputs: Unpack[NamedInputs]
    ) -> Floats:
        """Return the base regressor [Y_b] of [Y]{pi} = [Y_b]{beta}, for the base parameters {beta}.

        Its columns are those of [Y] that are independent over all motions; `kanegen.base_parameters` says
        which, and which combinations of {pi} the base parameters are (Gautier and Khalil 1990).

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            ydot: (n,) or (B, n) generalized accelerations, rad/s^2 and m/s^2.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n, b) or (B, n, b), N m and N over kg, kg m and kg m^2.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            beta = kg.base_parameters(system).matrix @ kg.inertial_parameters(system)
            tau = library.base_regressor(x, y, ydot) @ beta
        """
        return self._run("base_regressor", (x, y, ydot), inputs)[0]
