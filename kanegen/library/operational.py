"""Outputs about the inertia that frames have where they are pushed."""

from __future__ import annotations

from typing import Unpack

from numpy.typing import ArrayLike

from kanegen.library.compiled import CompiledModel
from kanegen.model.arguments import Floats, NamedInputs


class OperationalSpace(CompiledModel):
    """Methods for the inertia of the frames `pose_names`.

    Rows are those of `frame_jacobians`: angular first, inertial components. A wrench {w} on a frame is a
    moment and a force at its origin. With the acceleration {a} of the frame, as in `frame_accelerations`,

        [Lambda] {a} + {bias} = {w}

    for `operational_inertia` [Lambda] and `operational_bias` (Khatib 1987). Where a frame cannot accelerate
    in six independent directions, [Lambda] is infinite; its inverse exists everywhere.
    """

    def operational_inertia(self, x: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the operational inertia [Lambda] = (J [A]^-1 J^T)^-1 of each frame.

        It is the wrench that a unit acceleration of the frame takes beside `operational_bias`. Every selected
        frame needs six directions of acceleration, so choose the frames with `System.with_poses`.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (k, 6, 6) or (B, k, 6, 6) in the order of `pose_names`, both halves equal to the last bit, kg m^2,
            kg m and kg. Where it does not exist for a frame, or [A] is singular, all are NaN in a batch.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.
            StatusError: See `with_on_status`; by default a `SingularError` if it does not exist in a single
                state. The message names the frame and the moment or force along which the frame cannot move,
                by its row. Close to such a state a warning says that digits are lost.

        Example:
            arm = kg.load("models/six_revolute_arm.toml").with_poses(["flange"])
            library = kg.build(arm, outputs=("operational_inertia",))
            (inertia,) = library.operational_inertia([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
        """
        return self._run("operational_inertia", (x,), inputs)[0]

    def operational_inertia_inverse(self, x: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return J [A]^-1 J^T of each frame: the acceleration that a unit wrench on the frame adds.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (k, 6, 6) or (B, k, 6, 6) in the order of `pose_names`, positive semidefinite, both halves equal
            to the last bit, 1/(kg m^2), 1/(kg m) and 1/kg. Where [A] is singular they are missing: NaN in a
            batch.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.
            StatusError: See `with_on_status`; by default a `SingularError` if [A] is singular in a single
                state. The message names the freedom.

        Example:
            mobility = library.operational_inertia_inverse(x)
        """
        return self._run("operational_inertia_inverse", (x,), inputs)[0]

    def operational_bias(
        self,
        x: ArrayLike,
        y: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the wrench on each frame for which the frame does not accelerate, alone on the system.

        It is minus `operational_inertia` times the acceleration that the frame has without a wrench. For
        {tau} = 0 it is the sum of the centrifugal, Coriolis and gravity terms mu + p of Khatib (1987).

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            tau: Generalized forces, as in `forward_dynamics`.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (k, 6) or (B, k, 6) in the order of `pose_names`, N m and N.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.
            StatusError: As `operational_inertia`.

        Example:
            arm = kg.load("models/six_revolute_arm.toml").with_poses(["flange"])
            library = kg.build(arm, outputs=("operational_bias",))
            (holding,) = library.operational_bias([0.1, 0.2, 0.3, 0.4, 0.5, 0.6], np.zeros(6))
        """
        return self._run("operational_bias", (x, y, tau, force, torque), inputs)[0]
