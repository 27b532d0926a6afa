"""What joints carry."""

from __future__ import annotations

from typing import Unpack

from numpy.typing import ArrayLike

from kanegen.library.compiled import Compiled
from kanegen.model.arguments import Floats
from kanegen.model.load_arguments import Given


class Reactions(Compiled):
    """Loads along locked directions, in the order of `reaction_names`."""

    def reaction_loads(
        self,
        x: ArrayLike,
        y: ArrayLike,
        ydot: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **given: Unpack[Given],
    ) -> Floats:
        """The generalized forces that hold locked directions of joints, beside loads and gravity.

        They act from the lower body on the body: for an angle the moment about its origin O_K, about the axis
        of the angle; for a translation the force along its axis of the joint frame. `inverse_dynamics` would
        give them if these directions were free and stood still.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            ydot: Their rates, of the shape of `y`, rad/s^2 and m/s^2.
            force: As in `forcing`.
            torque: As in `forcing`.
            given: As in `forcing`.

        Returns:
            (R,) or (B, R), in N m for angles and N for translations.

        Raises:
            ArrayError: As in `forcing`.
            OptionError: If this output was not generated.
        """
        values = (x, y, ydot, None, force, torque)
        return self._run(self._call("reaction_loads"), values, given)[0]
