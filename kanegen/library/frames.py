"""Outputs about frames: poses, velocities, accelerations and Jacobians of bodies and named frames."""

from __future__ import annotations

from typing import Unpack

from numpy.typing import ArrayLike

from kanegen.library.compiled import CompiledModel
from kanegen.model.arguments import Floats, NamedInputs


class Frames(CompiledModel):
    """Methods for the frames `pose_names`: every body, or the frames that `System.with_poses` chooses.

    Six rows are three of the angular velocity, then three of the velocity of the origin of the frame, all in
    inertial components. Pinocchio's LOCAL_WORLD_ALIGNED has the two halves the other way round, and its LOCAL
    has them in components of the frame; MuJoCo's mj_jac has them as two arrays:

        aligned = jacobian[[3, 4, 5, 0, 1, 2]]          # rows of Pinocchio's LOCAL_WORLD_ALIGNED
        local = np.kron(np.eye(2), rotation) @ aligned  # rows of its LOCAL; rotation = body_poses(x)[i, :3]
        jacp, jacr = jacobian[3:], jacobian[:3]         # of MuJoCo's mj_jac at the origin of the frame

    Columns are in the order of {y}. Pinocchio's getFrameClassicalAcceleration is the acceleration that is
    meant here; its getFrameAcceleration lacks the part omega x v of the origin.
    """

    def body_poses(self, x: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return rotation and origin of the frames `pose_names`, Eqs. (3) and (22).

        The rows 0 to 2 of `poses[..., i, :, :]` are [R] of the frame that is `pose_names[i]`, for a body
        [R_K]: its basis vectors in inertial components. Row 3 is the position {p_O} of its origin from the
        inertial origin, in inertial components. So a point {r'} of the frame is at [R]^T {r'} + {p_O}.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (k, 4, 3) or (B, k, 4, 3) for k frames, 1 and m.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            poses = library.body_poses(x)
            rotation, origin = poses[0, :3], poses[0, 3]
        """
        return self._run("body_poses", (x,), inputs)[0]

    def frame_velocities(self, x: ArrayLike, y: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return angular velocities, Eq. (11), and velocities of the origins, Eq. (27), of the frames.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (k, 6) or (B, k, 6) in the order of `pose_names`, angular first, inertial components, rad/s and
            m/s.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            spin, velocity = np.split(library.frame_velocities(x, y)[0], 2)
        """
        return self._run("frame_velocities", (x, y), inputs)[0]

    def frame_accelerations(
        self, x: ArrayLike, y: ArrayLike, ydot: ArrayLike, **inputs: Unpack[NamedInputs]
    ) -> Floats:
        """Return angular accelerations and accelerations of the origins, Eqs. (20) and (33), of the frames.

        Gravity is no part of them. They are J {ydot} + the `frame_bias_accelerations`, where J are the
        `frame_jacobians`.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            ydot: (n,) or (B, n) generalized accelerations, rad/s^2 and m/s^2.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (k, 6) or (B, k, 6) in the order of `pose_names`, angular first, inertial components, rad/s^2 and
            m/s^2.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            acceleration = library.frame_accelerations(x, y, ydot)[0, 3:]
        """
        return self._run("frame_accelerations", (x, y, ydot), inputs)[0]

    def frame_bias_accelerations(self, x: ArrayLike, y: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return what `frame_accelerations` gives for {ydot} = 0: the derivative of the Jacobians times {y}.

        Accelerations of prescribed freedoms are a part of them.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (k, 6) or (B, k, 6) in the order of `pose_names`, angular first, inertial components, rad/s^2 and
            m/s^2.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            bias = library.frame_bias_accelerations(x, y)
        """
        return self._run("frame_bias_accelerations", (x, y), inputs)[0]

    def frame_jacobians(self, x: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the partial velocities of the frames by {y}, Eqs. (15) and (32).

        Where no freedom is prescribed, `frame_velocities` are these times {y}.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (k, 6, n) or (B, k, 6, n) in the order of `pose_names`, angular rows first, inertial components, 1
            and m.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            wrench = [0, 0, 0.2, 1, 0, 0]  # moment (N m), then force at the origin of the frame (N)
            tau = library.frame_jacobians(x)[0].T @ wrench
        """
        return self._run("frame_jacobians", (x,), inputs)[0]
