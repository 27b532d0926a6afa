"""Outputs that are second derivatives of other outputs, and products with derivatives without these."""

from __future__ import annotations

from typing import Unpack

from numpy.typing import ArrayLike

from kanegen.library.compiled import CompiledModel
from kanegen.model.arguments import Floats, NamedInputs


class Products(CompiledModel):
    """Methods for derivatives along a direction, gradients, products of Hessians, and second derivatives.

    Products cost a few times the output that is differentiated, whatever the number of variables. The K
    variables are {x}, {y}, {ydot} or {tau}, then force, torque, point_force, point_moment, t, prescribed and
    the run-time parameters, of which a system has some; `derivative_columns` gives their places.

    Arguments of `_vjp` stand in the order x, y, weights, tau: what a call needs comes before what it may
    leave out. Both `weights` and `tau` have n elements, so that an exchange raises no error; `tau=tau`
    prevents one.
    """

    def forcing_jvp(
        self,
        x: ArrayLike,
        y: ArrayLike,
        state_direction: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the derivatives of {f} along a direction: its Jacobian times the direction.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            state_direction: (K,) or (B, K) change of the variables: {x}, {y}, then loads, time,
                prescribed motion and run-time parameters, where the system has them. `derivative_columns`
                gives their places.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n,) or (B, n): N m and N, for a direction in the units of the variables.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.

        Example:
            change = library.forcing_jvp(x, y, state_direction)
        """
        return self._run("forcing_jvp", (x, y, state_direction, force, torque), inputs)[0]

    def forcing_vjp(
        self,
        x: ArrayLike,
        y: ArrayLike,
        weights: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the gradient of a weighted sum of {f}: the weights times the Jacobian.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            weights: (n,) or (B, n) weight of each entry of {f}.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (K,) or (B, K): an element for each variable, N m and N times the weights, over
            the unit of the variable.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.

        Example:
            gradient = library.forcing_vjp(x, y, weights)
            by_x = gradient[library.derivative_columns("forcing_vjp")["x"]]
        """
        return self._run("forcing_vjp", (x, y, weights, force, torque), inputs)[0]

    def forcing_hvp(
        self,
        x: ArrayLike,
        y: ArrayLike,
        weights: ArrayLike,
        state_direction: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the Hessian of a weighted sum of {f} times a direction.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            weights: (n,) or (B, n) weight of each entry of {f}.
            state_direction: (K,) or (B, K) change of the variables: {x}, {y}, then loads, time,
                prescribed motion and run-time parameters, where the system has them. `derivative_columns`
                gives their places.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (K,) or (B, K): the change of the gradient along the direction, an element for each variable.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.

        Example:
            product = library.forcing_hvp(x, y, weights, state_direction)
        """
        return self._run("forcing_hvp", (x, y, weights, state_direction, force, torque), inputs)[0]

    def inverse_dynamics_jvp(
        self,
        x: ArrayLike,
        y: ArrayLike,
        ydot: ArrayLike,
        direction: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the derivatives of [A]{ydot} - {f} along a direction: its Jacobian times the direction.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            ydot: (n,) or (B, n) generalized accelerations, rad/s^2 and m/s^2.
            direction: (K,) or (B, K) change of the variables: {x}, {y}, {ydot}, then loads, time,
                prescribed motion and run-time parameters, where the system has them. `derivative_columns`
                gives their places.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n,) or (B, n): N m and N, for a direction in the units of the variables.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.

        Example:
            change = library.inverse_dynamics_jvp(x, y, ydot, direction)
        """
        return self._run("inverse_dynamics_jvp", (x, y, ydot, direction, force, torque), inputs)[0]

    def inverse_dynamics_vjp(
        self,
        x: ArrayLike,
        y: ArrayLike,
        ydot: ArrayLike,
        weights: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the gradient of a weighted sum of [A]{ydot} - {f}: the weights times the Jacobian.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            ydot: (n,) or (B, n) generalized accelerations, rad/s^2 and m/s^2.
            weights: (n,) or (B, n) weight of each generalized force.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (K,) or (B, K): an element for each variable, N m and N times the weights, over
            the unit of the variable.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.

        Example:
            gradient = library.inverse_dynamics_vjp(x, y, ydot, weights)
            by_x = gradient[library.derivative_columns("inverse_dynamics_vjp")["x"]]
        """
        return self._run("inverse_dynamics_vjp", (x, y, ydot, weights, force, torque), inputs)[0]

    def inverse_dynamics_hvp(
        self,
        x: ArrayLike,
        y: ArrayLike,
        ydot: ArrayLike,
        weights: ArrayLike,
        direction: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the Hessian of a weighted sum of [A]{ydot} - {f} times a direction.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            ydot: (n,) or (B, n) generalized accelerations, rad/s^2 and m/s^2.
            weights: (n,) or (B, n) weight of each generalized force.
            direction: (K,) or (B, K) change of the variables: {x}, {y}, {ydot}, then loads, time,
                prescribed motion and run-time parameters, where the system has them. `derivative_columns`
                gives their places.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (K,) or (B, K): the change of the gradient along the direction, an element for each variable.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.

        Example:
            product = library.inverse_dynamics_hvp(x, y, ydot, weights, direction)
        """
        return self._run("inverse_dynamics_hvp", (x, y, ydot, weights, direction, force, torque), inputs)[0]

    def forward_dynamics_jvp(
        self,
        x: ArrayLike,
        y: ArrayLike,
        direction: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the derivatives of {ydot} along a direction: its Jacobian times the direction.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            direction: (K,) or (B, K) change of the variables: {x}, {y}, {tau}, then loads, time,
                prescribed motion and run-time parameters, where the system has them. `derivative_columns`
                gives their places.
            tau: Generalized forces, as in `forward_dynamics`.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n,) or (B, n): rad/s^2 and m/s^2, for a direction in the units of the variables. The
            rows of states of a batch in which [A] is singular are NaN.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.
            StatusError: As `forward_dynamics_derivatives`.

        Example:
            change = library.forward_dynamics_jvp(x, y, direction)
        """
        return self._run("forward_dynamics_jvp", (x, y, direction, tau, force, torque), inputs)[0]

    def forward_dynamics_vjp(
        self,
        x: ArrayLike,
        y: ArrayLike,
        weights: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the gradient of a weighted sum of {ydot}: the weights times the Jacobian.

        `weights` stand before `tau`, since `tau` may be left out. Both have n elements, so that an exchange
        raises no error; write `tau=tau`.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            weights: (n,) or (B, n) weight of each acceleration.
            tau: Generalized forces, as in `forward_dynamics`.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (K,) or (B, K): an element for each variable, rad/s^2 and m/s^2 times the weights, over
            the unit of the variable. The
            rows of states of a batch in which [A] is singular are NaN.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.
            StatusError: As `forward_dynamics_derivatives`.

        Example:
            gradient = library.forward_dynamics_vjp(x, y, weights, tau=tau)
            by_x = gradient[library.derivative_columns("forward_dynamics_vjp")["x"]]
        """
        return self._run("forward_dynamics_vjp", (x, y, weights, tau, force, torque), inputs)[0]

    def forward_dynamics_hvp(
        self,
        x: ArrayLike,
        y: ArrayLike,
        weights: ArrayLike,
        direction: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the Hessian of a weighted sum of {ydot} times a direction.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            weights: (n,) or (B, n) weight of each acceleration.
            direction: (K,) or (B, K) change of the variables: {x}, {y}, {tau}, then loads, time,
                prescribed motion and run-time parameters, where the system has them. `derivative_columns`
                gives their places.
            tau: Generalized forces, as in `forward_dynamics`.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (K,) or (B, K): the change of the gradient along the direction, an element for each variable. The
            rows of states of a batch in which [A] is singular are NaN.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.
            StatusError: As `forward_dynamics_derivatives`.

        Example:
            product = library.forward_dynamics_hvp(x, y, weights, direction)
        """
        return self._run("forward_dynamics_hvp", (x, y, weights, direction, tau, force, torque), inputs)[0]

    def inverse_dynamics_second_derivatives(
        self,
        x: ArrayLike,
        y: ArrayLike,
        ydot: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the second derivatives of [A]{ydot} - {f} by {x}, {y}, {ydot} and run-time parameters.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            ydot: (n,) or (B, n) generalized accelerations, rad/s^2 and m/s^2.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n, K, K) or (B, n, K, K): a symmetric matrix for each freedom, whose places
            `derivative_columns` gives, N m and N over the units of two variables.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.

        Example:
            by = library.derivative_columns("inverse_dynamics_second_derivatives")
            curvature = library.inverse_dynamics_second_derivatives(x, y, ydot)[:, by["x"], by["x"]]
        """
        return self._run("inverse_dynamics_second_derivatives", (x, y, ydot, force, torque), inputs)[0]

    def forward_dynamics_second_derivatives(
        self,
        x: ArrayLike,
        y: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the second derivatives of {ydot} by {x}, {y}, {tau} and the run-time parameters.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            tau: Generalized forces, as in `forward_dynamics`.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n, K, K) or (B, n, K, K): a symmetric matrix for each freedom, whose places
            `derivative_columns` gives, rad/s^2 and m/s^2 over the units of two variables. Those of states of
            a batch in which [A] is singular are NaN.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.
            StatusError: As `forward_dynamics_derivatives`.

        Example:
            by = library.derivative_columns("forward_dynamics_second_derivatives")
            curvature = library.forward_dynamics_second_derivatives(x, y)[:, by["x"], by["x"]]
        """
        return self._run("forward_dynamics_second_derivatives", (x, y, tau, force, torque), inputs)[0]
