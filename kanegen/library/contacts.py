"""Outputs under contacts: accelerations, and the loads by which contacts hold."""

from __future__ import annotations

from typing import Unpack

from numpy.typing import ArrayLike

from kanegen.library.compiled import CompiledModel
from kanegen.model.arguments import Floats, NamedInputs


class Contacts(CompiledModel):
    """Methods for the motion of a system whose contacts hold, see `System.with_contacts`.

    With the Jacobian J of the held directions, rows in the order of `contact_names`, they are the solution of

        [A]{ydot} = {f} + {tau} + [J]^T {lambda},    [J]{ydot} + d/dt [J] {y} = -mu {lambda},

    where mu is the damping of each contact, 0 unless it has one. What is held has no acceleration; whether it
    moves is a matter of {x} and {y}. Nothing keeps a load from pulling: which contacts hold is the caller's
    choice.
    """

    def contact_dynamics(
        self,
        x: ArrayLike,
        y: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the accelerations {ydot} where all contacts hold.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            tau: (n,) or (B, n) generalized forces beside loads and gravity, as in `forward_dynamics`.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n,) or (B, n), rad/s^2 and m/s^2. Where [A] is singular, or held directions without damping
            depend on each other, they are missing: NaN in a batch.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.
            StatusError: See `with_on_status`; by default a `SingularError` if the accelerations are missing
                in a single state. The message names the freedom or the contact.

        Example:
            ydot = library.contact_dynamics(x, y, tau=[1.0, 0.0])
        """
        return self._run("contact_dynamics", (x, y, tau, force, torque), inputs)[0]

    def contact_forces(
        self,
        x: ArrayLike,
        y: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the loads {lambda} with which the environment holds the contacts.

        For each contact these are the moment about the held origin, if it holds a frame, then the force, in
        inertial components and in held directions alone.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            tau: (n,) or (B, n) generalized forces beside loads and gravity, as in `forward_dynamics`.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (r,) or (B, r) in the order of `contact_names`, N m and N; missing as in `contact_dynamics`.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.
            StatusError: As for `contact_dynamics`.

        Example:
            loads = dict(zip(library.contact_names, library.contact_forces(x, y)))
        """
        return self._run("contact_forces", (x, y, tau, force, torque), inputs)[0]

    def contact_dynamics_derivatives(
        self,
        x: ArrayLike,
        y: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the derivatives of {ydot} under contacts by {x}, {y}, {tau} and the run-time parameters.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            tau: (n,) or (B, n) generalized forces beside loads and gravity, as in `forward_dynamics`.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n, K) or (B, n, K): a row for each freedom, rad/s^2 and m/s^2 over the units of the variables;
            `derivative_columns` gives the order of the columns.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.
            StatusError: As for `contact_dynamics`.

        Example:
            by = library.derivative_columns("contact_dynamics_derivatives")
            response = library.contact_dynamics_derivatives(x, y)[:, by["tau"]]
        """
        return self._run("contact_dynamics_derivatives", (x, y, tau, force, torque), inputs)[0]
