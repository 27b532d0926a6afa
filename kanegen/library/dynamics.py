"""Outputs that are the equations of motion, their solution, and estimates of its error."""

from __future__ import annotations

from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kanegen.errors import ArrayError
from kanegen.library.compiled import CompiledModel
from kanegen.library.results import Diagnosis, diagnosis
from kanegen.model.arguments import Floats, NamedInputs


class Dynamics(CompiledModel):
    """Methods for [A], {f}, {ydot}, generalized forces and reactions."""

    def mass_matrix(self, x: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return the generalized mass matrix [A], Eq. (43).

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            inputs: Inputs that only some systems have, by name.

        Returns:
            (n, n) or (B, n, n) symmetric, kg m^2, kg m and kg. A library that was built with
            `mass_matrix="lower"` leaves 0 above the diagonal; with "packed" or "sparse" there are (k,) or
            (B, k) elements of the lower triangle, whose places `mass_matrix_places` has.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            A = library.mass_matrix(x)
        """
        return self._run("mass_matrix", (x,), inputs)[0]

    @property
    def mass_matrix_places(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Row and column of each element of [A] that is filled, row by row; two arrays of shape (k,).

        Raises:
            OptionError: If the library was built without the output mass_matrix.

        Example:
            library = kg.build(system, mass_matrix="packed")
            rows, columns = library.mass_matrix_places
            A = np.zeros((library.n, library.n))
            A[rows, columns] = A[columns, rows] = library.mass_matrix(x)
        """
        if "mass_matrix" not in self.source.outputs:
            raise self._absent("mass_matrix")
        pattern = self.source.mass_matrix_pattern
        rows, columns = np.array(pattern).T if pattern else np.indices((self.n, self.n)).reshape(2, -1)
        return rows, columns

    def forcing(
        self,
        x: ArrayLike,
        y: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the right side {f} of [A]{ydot} = {f}, Eq. (44).

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            force: (N, 3) or (B, N, 3) force {F'_K} on each body at its mass centre, in body components, N;
                (N, 3) acts in every state of a batch, None is zero.
            torque: (N, 3) or (B, N, 3) torque {M'_K} on each body, in body components, N m; (N, 3) acts in
                every state of a batch, None is zero.
            inputs: Inputs that only some systems have, by name: `point_force`, `point_moment`, `t` and
                `prescribed`.

        Returns:
            (n,) or (B, n), N m and N.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.

        Example:
            f = library.forcing(x, y)
        """
        return self._run("forcing", (x, y, force, torque), inputs)[0]

    def inverse_dynamics(
        self,
        x: ArrayLike,
        y: ArrayLike,
        ydot: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return [A]{ydot} - {f}, the generalized forces that {ydot} requires beside loads and gravity.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            ydot: (n,) or (B, n) generalized accelerations, rad/s^2 and m/s^2.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n,) or (B, n), N m and N.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.

        Example:
            tau = library.inverse_dynamics(x, y, ydot)
        """
        return self._run("inverse_dynamics", (x, y, ydot, force, torque), inputs)[0]

    def prescribed_efforts(
        self,
        x: ArrayLike,
        y: ArrayLike,
        ydot: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the generalized forces at the prescribed freedoms, beside loads and gravity.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            ydot: (n,) or (B, n) generalized accelerations, rad/s^2 and m/s^2.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`; `prescribed` is one of them here.

        Returns:
            (p,) or (B, p) in the order of `prescribed_names`, N m and N.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.

        Example:
            driven = kg.build(system.with_prescribed("q1"), outputs=("prescribed_efforts",))
            efforts = driven.prescribed_efforts([0.2], [0.0], [0.5], prescribed=[[0.1], [1.0], [0.0]])
        """
        return self._run("prescribed_efforts", (x, y, ydot, force, torque), inputs)[0]

    def reaction_loads(
        self,
        x: ArrayLike,
        y: ArrayLike,
        ydot: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the loads that joints transmit, along locked directions or in frames.

        They act from the lower body on the body K. Along a locked direction this is for an angle the moment
        about its origin O_K and the axis of the angle, for a translation the force along its axis of the
        joint frame: what `inverse_dynamics` gives for these directions if they are free and do not move. In
        a frame of the body it is all that the joint transmits, with the efforts on its freedoms: the moment
        about the origin of the frame and the force, in components of the frame, as a sensor there shows
        them.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            ydot: (n,) or (B, n) generalized accelerations, rad/s^2 and m/s^2.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (R,) or (B, R) in the order of `reaction_names`, N m for angles and moments, N for translations
            and forces.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.

        Example:
            loads = dict(zip(library.reaction_names, library.reaction_loads(x, y, ydot)))
        """
        return self._run("reaction_loads", (x, y, ydot, force, torque), inputs)[0]

    def forward_dynamics(
        self,
        x: ArrayLike,
        y: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the solution {ydot} of [A]{ydot} = {f} + {tau}.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            tau: (n,) or (B, n) generalized forces beside loads and gravity, N m and N; (n,) acts in every
                state of a batch, None is zero. The effort on a coupled freedom, times its factors, is part of
                those on the freedoms that it follows.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n,) or (B, n), rad/s^2 and m/s^2. Where [A] is singular they are missing: NaN in a batch.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.
            StatusError: See `with_on_status`; by default a `SingularError` if [A] is singular in a single
                state, or an infinite or NaN input makes a pivot NaN; other such inputs are reported as not
                finite. The message names the freedom.

        Example:
            ydot = library.forward_dynamics(x, y, tau=[1.0, 0.0])
        """
        return self._run("forward_dynamics", (x, y, tau, force, torque), inputs)[0]

    def error_estimate(
        self,
        x: ArrayLike,
        y: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return the absolute change of each entry of {ydot} by a first step of refinement.

        That is about the error of {ydot} without refinement. It does not include the loss of digits where
        loads, gravity, speeds and {tau} cancel.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            tau: Generalized forces, as in `forward_dynamics`.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n,) or (B, n) not negative, rad/s^2 and m/s^2.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.
            StatusError: As `forward_dynamics`.

        Example:
            estimate = library.error_estimate(x, y)
        """
        return self._run("error_estimate", (x, y, tau, force, torque), inputs)[0]

    def error_bound(
        self,
        x: ArrayLike,
        y: ArrayLike,
        ydot: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Floats:
        """Return a proven bound on the error of each entry of given accelerations {ydot}.

        The accelerations may come from any program. The bound holds for the state and the loads as they are
        passed, in this precision, and includes the rounding of its own computation, as
        docs/acceleration-errors.md says.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            ydot: (n,) or (B, n) generalized accelerations, rad/s^2 and m/s^2.
            tau: Generalized forces, as in `forward_dynamics`.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n,) or (B, n) not negative, rad/s^2 and m/s^2; every |{ydot} - exact| is at most this.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without this output.
            StatusError: See `with_on_status`; by default a `SingularError` if no bound is proven in a single
                state, because [A] is singular but for rounding or an infinite or NaN input makes a pivot NaN;
                other such inputs are reported as not finite.

        Example:
            bound = library.error_bound(x, y, ydot=library.forward_dynamics(x, y))
        """
        return self._run("error_bound", (x, y, ydot, tau, force, torque), inputs)[0]

    def regularity(self, x: ArrayLike, **inputs: Unpack[NamedInputs]) -> Floats:
        """Return for each freedom its pivot in the elimination over its inertia, the diagonal entry of [A].

        That is the share of its inertia that is left where the freedoms eliminated before it may move: 1 if
        they do not matter, 0 if [A] is singular. A joint whose three angles have their rates as speeds is
        eliminated in the frame of the body; there the share of theta1 contains cos^2(theta2), the square of
        the distance from gimbal lock.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            inputs: Inputs that only some systems have, as in `forcing`.

        Returns:
            (n,) or (B, n), 0 to 1.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If the library was built without this output.

        Example:
            weakest = library.freedom_names[library.regularity(x).argmin()]
        """
        return self._run("regularity", (x,), inputs)[0]

    def diagnose(
        self,
        x: ArrayLike,
        y: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> Diagnosis:
        """Return how accurate `forward_dynamics` is in some states, and at which freedom it is worst.

        Singular states are counted and raise no error.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            tau: Generalized forces, as in `forward_dynamics`.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            inputs: Inputs that only some systems have, as in `forcing`.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or there is no state.
            OptionError: If the library was built without "forward_dynamics", "error_estimate" or
                "regularity".

        Example:
            print(library.diagnose(x, y))
        """
        for name in ("forward_dynamics", "error_estimate", "regularity"):
            if name not in self._calls:
                raise self._absent(name)
        x, y = np.atleast_2d(np.asarray(x)), np.atleast_2d(np.asarray(y))
        if not len(x):
            raise ArrayError("diagnose: there is no state, the batch is empty.")
        quiet = self.with_on_status("ignore")
        acceleration = quiet.forward_dynamics(x, y, tau, force, torque, **inputs)
        estimate = quiet.error_estimate(x, y, tau, force, torque, **inputs)
        return diagnosis(self.source.model, x, acceleration, estimate, quiet.regularity(x, **inputs))
