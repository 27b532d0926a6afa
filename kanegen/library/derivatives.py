"""Outputs that are derivatives of other outputs."""

from __future__ import annotations

from typing import Unpack

from numpy.typing import ArrayLike

from kanegen.choices import require_one
from kanegen.library.compiled import CompiledModel
from kanegen.model.arguments import Floats, NamedInputs
from kanegen.recursion.outputs import DIFFERENTIATED


class Derivatives(CompiledModel):
    """Methods for the derivatives of {f} and of its part by gravity, of generalized forces and of {ydot}.

    The last axis of a result has K columns, one for each differentiation variable; `derivative_columns` gives
    their order.
    """

    def forcing_derivatives(
        self,
        x: ArrayLike,
        y: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the derivatives of {f} with respect to {x}, {y} and the run-time parameters.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n, K) or (B, n, K): a row for each freedom, N m and N over the units of x, y and the parameters.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.

        Example:
            by = library.derivative_columns("forcing_derivatives")
            stiffness = -library.forcing_derivatives(x, y)[:, by["x"]]
        """
        return self._run("forcing_derivatives", (x, y, force, torque), inputs)[0]

    def gravity_forces_derivatives(self, x: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the derivatives of the part of {f} that gravity causes by {x} and the run-time parameters.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n, K) or (B, n, K): a row for each freedom, N m and N over the units of x and the parameters.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            by = library.derivative_columns("gravity_forces_derivatives")
            stiffness = -library.gravity_forces_derivatives(x)[:, by["x"]]
        """
        return self._run("gravity_forces_derivatives", (x,), inputs)[0]

    def inverse_dynamics_derivatives(
        self,
        x: ArrayLike,
        y: ArrayLike,
        ydot: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the derivatives of [A]{ydot} - {f} with respect to {x}, {y} and the run-time parameters.

        The derivative with respect to {ydot} is [A], the output `mass_matrix`.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            ydot: (n,) or (B, n) generalized accelerations, rad/s^2 and m/s^2.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n, K) or (B, n, K): a row for each freedom, N m and N over the units of x, y and the parameters.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.

        Example:
            derivatives = library.inverse_dynamics_derivatives(x, y, ydot)
        """
        return self._run("inverse_dynamics_derivatives", (x, y, ydot, force, torque), inputs)[0]

    def forward_dynamics_derivatives(
        self,
        x: ArrayLike,
        y: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the derivatives of {ydot} with respect to {x}, {y}, {tau} and the run-time parameters.

        The derivative with respect to {tau} is [A]^-1.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            tau: Generalized forces, as in `forward_dynamics`.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n, K) or (B, n, K): a row for each freedom, rad/s^2 and m/s^2 over the units of x, y, tau and the
            parameters. The rows of states of a batch in which [A] is singular are NaN.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.
            StatusError: See `with_on_status`; by default a `SingularError` if [A] is singular in a single
                state, or an infinite or NaN input makes a pivot NaN; other such inputs are reported as not
                finite.

        Example:
            by = library.derivative_columns("forward_dynamics_derivatives")
            inverse = library.forward_dynamics_derivatives(x, y)[:, by["tau"]]
        """
        return self._run("forward_dynamics_derivatives", (x, y, tau, force, torque), inputs)[0]

    def forcing_input_derivatives(
        self,
        x: ArrayLike,
        y: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the derivatives of {f} with respect to loads, time and prescribed motion.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n, K) or (B, n, K): a row for each freedom, N m and N over the units of the inputs. The elements
            of an array of loads are counted row by row; those of bodies that take no loads have zeros.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.

        Example:
            by = library.derivative_columns("forcing_input_derivatives")
            slopes = library.forcing_input_derivatives(x, y)[:, by["force"]]
        """
        return self._run("forcing_input_derivatives", (x, y, force, torque), inputs)[0]

    def inverse_dynamics_input_derivatives(
        self,
        x: ArrayLike,
        y: ArrayLike,
        ydot: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the derivatives of [A]{ydot} - {f} with respect to loads, time and prescribed motion.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            ydot: (n,) or (B, n) generalized accelerations, rad/s^2 and m/s^2.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n, K) or (B, n, K): a row for each freedom, N m and N over the units of the inputs. The elements
            of an array of loads are counted row by row; those of bodies that take no loads have zeros.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.

        Example:
            by = library.derivative_columns("inverse_dynamics_input_derivatives")
            slopes = library.inverse_dynamics_input_derivatives(x, y, ydot)[:, by["force"]]
        """
        return self._run("inverse_dynamics_input_derivatives", (x, y, ydot, force, torque), inputs)[0]

    def forward_dynamics_input_derivatives(
        self,
        x: ArrayLike,
        y: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the derivatives of {ydot} with respect to loads, time and prescribed motion.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            tau: Generalized forces, as in `forward_dynamics`.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n, K) or (B, n, K): a row for each freedom, rad/s^2 and m/s^2 over the units of the inputs. The
            elements of an array of loads are counted row by row; those of bodies that take no loads have
            zeros. The rows of states of a batch in which [A] is singular are NaN.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.
            StatusError: As `forward_dynamics_derivatives`.

        Example:
            by = library.derivative_columns("forward_dynamics_input_derivatives")
            slopes = library.forward_dynamics_input_derivatives(x, y)[:, by["force"]]
        """
        return self._run("forward_dynamics_input_derivatives", (x, y, tau, force, torque), inputs)[0]

    def derivative_columns(self, output: str) -> dict[str, slice]:
        """Return the columns of an output of derivatives, by array of differentiation variables.

        For a product with derivatives, such as "forward_dynamics_vjp", these are the places in its direction
        and in its gradient.

        Args:
            output: Name of the output, such as "forcing_derivatives".

        Returns:
            The slices of the last axis that belong to "x", "y", "ydot", "tau" and "parameters", and to
            "force", "torque", "point_force", "point_moment", "t" and "prescribed", where there are any.

        Raises:
            OptionError: If there is no such output.

        Example:
            library.derivative_columns("forward_dynamics_derivatives")["tau"]
        """
        require_one("output of derivatives", output, DIFFERENTIATED)
        read = {array.name: array.size for one in self.source.functions for array in one.inputs}
        sizes = len(self.coordinate_names), self.n, len(self._parameters)
        return DIFFERENTIATED[output].columns(*sizes, read)
