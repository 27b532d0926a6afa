"""A compiled model: NumPy in, NumPy out."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kanegen.c import Source
from kanegen.choices import require_one
from kanegen.derivatives import DERIVATIVES, columns
from kanegen.diagnosis import Diagnosis, diagnosis
from kanegen.errors import ArrayError, KanegenWarning, ModelError, OptionError
from kanegen.evaluation import Evaluation
from kanegen.native.arguments import Floats
from kanegen.native.build import build
from kanegen.native.calls import Call, Native
from kanegen.numbers import finite
from kanegen.precision import named
from kanegen.program.ir import EVALUATE
from kanegen.suggest import did_you_mean


def load(
    source: Source,
    compiler: str | None = None,
    flags: str | Sequence[str] | None = None,
    threads: bool = False,
) -> Library:
    """Compile `source`, or find it in the cache, and load it.

    Args:
        source: From `kanegen.generate`.
        compiler: Command of a C compiler; by default the first that is found.
        flags: Its flags; by default optimised with IEEE semantics kept.
        threads: Let OpenMP share batches of 1024 states and more among threads, as many as `OMP_NUM_THREADS`
            says. No bit depends on it. A process that has used them must not fork. A compiler without OpenMP
            brings a `KanegenWarning`, and one thread.

    Raises:
        BuildError: If there is no compiler, it fails, or what it makes cannot be loaded.
    """
    return Library(Native(source, build(source, compiler, flags, threads)), dict(source.model.parameters))


class Library:
    """The functions of a model, with values of its parameters.

    The coordinates of a state are an array of shape (m,), m being n where there are no quaternions, and its
    speeds one of shape (n,); many at once are (B, m) and (B, n), and every result then has B rows, also where
    B is 0. Contiguous arrays of its `storage` are passed to C as they are; lists, integers, other floats and
    other orders of memory are converted first. So a library in single precision rounds doubles; its results
    are arrays of float32. NaN and infinity pass through. A result does not depend on its place in a batch or
    on what else is there, and is that of the state alone: with strict semantics it is the same bits from
    every compiler at every level, since sine and cosine are kanegen's own unless the variant says otherwise.
    Objects are immutable and may be shared by threads; C runs without the interpreter's lock. They can be
    pickled: another process of the machine loads the same compiled file.
    """

    def __init__(self, native: Native, parameters: Mapping[str, float]) -> None:
        self._native = native
        self._parameters = dict(parameters)
        self._constants = native.constants(self._parameters)
        model = native.source.model
        self._takes_loads = model.takes_loads
        self._together = native.calls.get(EVALUATE) or native.calls[self.outputs[0]]

    def __repr__(self) -> str:
        return f"<Library {self.name}: {self.n} freedoms, {', '.join(self.outputs)}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _reopen, (self.source, self._native.path, self._parameters)

    @property
    def source(self) -> Source:
        """What was compiled."""
        return self._native.source

    @property
    def path(self) -> Path:
        """File of the shared library."""
        return self._native.path

    @property
    def name(self) -> str:
        """Name of the system."""
        return self.source.model.name

    @property
    def n(self) -> int:
        """Number of freedoms."""
        return len(self.freedom_names)

    @property
    def freedom_names(self) -> tuple[str, ...]:
        """n names of the freedoms, in the order of {y}."""
        return self.source.model.freedom_names

    @property
    def coordinate_names(self) -> tuple[str, ...]:
        """m names in the order of {x}: of the freedoms, or of the four elements of a quaternion."""
        return self.source.model.coordinate_names

    @property
    def speed_names(self) -> tuple[str, ...]:
        """n names in the order of {y}: of the coordinate whose rate it is, or of the component."""
        return self.source.model.speed_names or self.freedom_names

    @property
    def point_names(self) -> tuple[str, ...]:
        """Names of the points, in the order of the rows of outputs about them."""
        return tuple(name for name, _ in self.source.model.points)

    @property
    def outputs(self) -> tuple[str, ...]:
        """What it can compute."""
        return self.source.outputs

    @property
    def precision(self) -> str:
        """The arithmetic of its C: "double", "float", "long double" or "double-double"."""
        return self.source.precision

    @property
    def storage(self) -> str:
        """What its arrays hold: "double" is float64 in NumPy, "float" float32, "long double" longdouble.

        For "double-double" they are float64 with a last axis of 2 behind the documented ones: every number is
        the exact sum of two doubles, of which the first is that sum rounded. Arguments have that axis too.
        """
        return self.source.storage

    @property
    def parameters(self) -> dict[str, float]:
        """Values of the run-time parameters; a copy."""
        return dict(self._parameters)

    def with_parameters(self, values: Mapping[str, float]) -> Library:
        """The same library with other values of some parameters; the others stay as they are.

        Args:
            values: By name of the parameter, in the unit of the place where it stands. Only the names and
                that they are finite is checked; `System.with_parameters` also checks what they mean.

        Raises:
            ModelError: If a name is unknown, or a value is not a finite number of the library's precision.
        """
        for name in values:
            if name not in self._parameters:
                raise ModelError(f"unknown parameter {name!r}. {did_you_mean(name, self._parameters)}")
        checked = {name: finite(value, f"parameter {name!r}") for name, value in values.items()}
        for name, value in checked.items():
            named(self.precision).rounded(value, f"parameter {name!r}")
        return Library(self._native, {**self._parameters, **checked})

    def mass_matrix(self, x: ArrayLike) -> Floats:
        """[A] of Eq. (43).

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.

        Returns:
            (n, n) or (B, n, n), in kg m^2, kg m and kg.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If this output was not generated.
        """
        return self._call("mass_matrix")(self._constants, (x,))[0]

    def forcing(
        self, x: ArrayLike, y: ArrayLike, force: ArrayLike | None = None, torque: ArrayLike | None = None
    ) -> Floats:
        """{f} of Eq. (44).

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            force: (N, 3) or (B, N, 3) force on each body at its mass centre, in body components, N; one
                (N, 3) acts in every state of a batch, None is zero.
            torque: The same for the torque on each body, N m.

        Returns:
            (n,) or (B, n), in N m and N.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If this output was not generated.
        """
        if force is not None or torque is not None:
            self._require_loads(force)
        return self._call("forcing")(self._constants, (x, y, None, None, force, torque))[0]

    def inverse_dynamics(
        self,
        x: ArrayLike,
        y: ArrayLike,
        ydot: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
    ) -> Floats:
        """[A]{ydot} - {f}: the generalized forces that produce {ydot}, beside loads and gravity.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            ydot: Their rates, of the shape of `y`, rad/s^2 and m/s^2.
            force: As in `forcing`.
            torque: As in `forcing`.

        Returns:
            (n,) or (B, n), in N m and N.

        Raises:
            ArrayError: As in `forcing`.
            OptionError: If this output was not generated.
        """
        if force is not None or torque is not None:
            self._require_loads(force)
        values = (x, y, ydot, None, force, torque)
        return self._call("inverse_dynamics")(self._constants, values)[0]

    def forward_dynamics(
        self,
        x: ArrayLike,
        y: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
    ) -> Floats:
        """{ydot} of [A]{ydot} = {f} + {tau}.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            tau: (n,) or (B, n) generalized forces beside loads and gravity, N m and N; one (n,) acts in every
                state of a batch, None is zero.
            force: As in `forcing`.
            torque: As in `forcing`.

        Returns:
            (n,) or (B, n), in rad/s^2 and m/s^2. States of a batch in which [A] is singular have NaN, and a
            `KanegenWarning` counts them. Where the result is refined and still not accurate to 1e-12 (5e-4
            in single precision), a `KanegenWarning` says so.

        Raises:
            ArrayError: As in `forcing`.
            OptionError: If this output was not generated.
            SingularError: If [A] is singular in the one state, or the state is not finite; names the freedom.
        """
        if force is not None or torque is not None:
            self._require_loads(force)
        values = (x, y, None, tau, force, torque)
        return self._call("forward_dynamics")(self._constants, values)[0]

    def error_estimate(
        self,
        x: ArrayLike,
        y: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
    ) -> Floats:
        """How much a first step of refinement changes each entry of {ydot}: about its error without any.

        It does not see what is lost where loads, gravity, speeds and {tau} cancel.

        Args:
            x: As in `forward_dynamics`, like everything else.
            y: Generalized speeds.
            tau: Generalized forces.
            force: Forces on the bodies.
            torque: Torques on the bodies.

        Returns:
            (n,) or (B, n), in rad/s^2 and m/s^2, not negative.

        Raises:
            ArrayError, OptionError, SingularError: As `forward_dynamics`.
        """
        if force is not None or torque is not None:
            self._require_loads(force)
        values = (x, y, None, tau, force, torque)
        return self._call("error_estimate")(self._constants, values)[0]

    def regularity(self, x: ArrayLike) -> Floats:
        """For each freedom its pivot in the elimination over its inertia, the entry on the diagonal of [A].

        That is the share that is left where the freedoms eliminated before it may move: 1 where they do not
        matter, 0 where [A] is singular. A joint whose three angles have their rates as speeds is eliminated
        in the body's frame; there the share of theta1 holds the square of the distance to the state where
        the angles fail, cos^2(theta2).

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.

        Returns:
            (n,) or (B, n).

        Raises:
            ArrayError: If `x` has the wrong shape or type.
            OptionError: If this output was not generated.
        """
        return self._call("regularity")(self._constants, (x,))[0]

    def diagnose(
        self,
        x: ArrayLike,
        y: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
    ) -> Diagnosis:
        """How far `forward_dynamics` can be trusted in these states, and which freedom is the worst.

        Singular states are counted, not refused.

        Args:
            x: As in `forward_dynamics`, like everything else.
            y: Generalized speeds.
            tau: Generalized forces.
            force: Forces on the bodies.
            torque: Torques on the bodies.

        Raises:
            ArrayError: As `forward_dynamics`, and if there is no state.
            OptionError: If "forward_dynamics", "error_estimate" and "regularity" were not all generated.
        """
        for name in ("forward_dynamics", "error_estimate", "regularity"):
            self._call(name)
        x, y = np.atleast_2d(np.asarray(x)), np.atleast_2d(np.asarray(y))
        if not len(x):
            raise ArrayError("diagnose: there is no state, the batch is empty.")
        with warnings.catch_warnings(action="ignore", category=KanegenWarning):
            acceleration = self.forward_dynamics(x, y, tau, force, torque)
            estimate = self.error_estimate(x, y, tau, force, torque)
        return diagnosis(self.source.model, x, acceleration, estimate, self.regularity(x))

    def kinetic_energy(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Kinetic energy of all bodies in inertial space, {y}^T [A] {y} / 2.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.

        Returns:
            () or (B,), in J.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If this output was not generated.
        """
        return self._call("kinetic_energy")(self._constants, (x, y))[0]

    def potential_energy(self, x: ArrayLike) -> Floats:
        """Potential energy of gravity: minus the sum of m g . p_G over the bodies.

        It is zero where all mass centres are at the inertial origin, and everywhere without gravity.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.

        Returns:
            () or (B,), in J.

        Raises:
            ArrayError: If `x` has the wrong shape or type.
            OptionError: If this output was not generated.
        """
        return self._call("potential_energy")(self._constants, (x,))[0]

    def momentum(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Linear momentum of all bodies, then their angular momentum about their common mass centre.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.

        Returns:
            (6,) or (B, 6), inertial components: three in kg m/s, then three in kg m^2/s.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If this output was not generated.
        """
        return self._call("momentum")(self._constants, (x, y))[0]

    def mass_center(self, x: ArrayLike) -> Floats:
        """Position of the mass centre of all bodies from the inertial origin.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.

        Returns:
            (3,) or (B, 3), inertial components, in m; NaN where parameters make all masses 0.

        Raises:
            ArrayError: If `x` has the wrong shape or type.
            OptionError: If this output was not generated.
        """
        return self._call("mass_center")(self._constants, (x,))[0]

    def body_poses(self, x: ArrayLike) -> Floats:
        """Rotation and origin of every body: Eqs. (3) and (22).

        Body K has `poses[..., K - 1, :, :]`. Its rows 0 to 2 are [R_K], which takes inertial components to
        body components, so they are the basis vectors of K in inertial components; row 3 is the position of
        O_K from the inertial origin, in inertial components (m). A point {r'} of K is at
        [R_K]^T {r'} + {p_O_K}.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.

        Returns:
            (N, 4, 3) or (B, N, 4, 3).

        Raises:
            ArrayError: If `x` has the wrong shape or type.
            OptionError: If this output was not generated.
        """
        return self._call("body_poses")(self._constants, (x,))[0]

    def coordinate_rates(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """{xdot}: Eq. (9) where speeds are components of angular velocities, else {y}.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.

        Returns:
            (m,) or (B, m), in rad/s, m/s and 1/s. States of a batch in which the angles of a body have no
            rates have NaN, and a `KanegenWarning` counts them.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If this output was not generated.
            SingularError: If the axes of three angles lie in a plane in the one state; names the middle one.
        """
        return self._call("coordinate_rates")(self._constants, (x, y))[0]

    def point_positions(self, x: ArrayLike) -> Floats:
        """Positions of the points of the model from the inertial origin, in the order of `point_names`.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.

        Returns:
            (P, 3) or (B, P, 3), inertial components, in m.

        Raises:
            ArrayError: If `x` has the wrong shape or type.
            OptionError: If this output was not generated.
        """
        return self._call("point_positions")(self._constants, (x,))[0]

    def point_velocities(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Velocities of the points of the model.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.

        Returns:
            (P, 3) or (B, P, 3), inertial components, in m/s.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If this output was not generated.
        """
        return self._call("point_velocities")(self._constants, (x, y))[0]

    def point_accelerations(self, x: ArrayLike, y: ArrayLike, ydot: ArrayLike) -> Floats:
        """Accelerations of the points of the model; gravity is no part of them.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            ydot: Their rates, of the shape of `y`, rad/s^2 and m/s^2.

        Returns:
            (P, 3) or (B, P, 3), inertial components, in m/s^2.

        Raises:
            ArrayError: If an argument has the wrong shape or type.
            OptionError: If this output was not generated.
        """
        return self._call("point_accelerations")(self._constants, (x, y, ydot))[0]

    def point_jacobians(self, x: ArrayLike) -> Floats:
        """Partial velocities of the points of the model by {y}: `point_velocities` is their product with it.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.

        Returns:
            (P, 3, n) or (B, P, 3, n), inertial components, in m and 1.

        Raises:
            ArrayError: If `x` has the wrong shape or type.
            OptionError: If this output was not generated.
        """
        return self._call("point_jacobians")(self._constants, (x,))[0]

    def forcing_derivatives(
        self, x: ArrayLike, y: ArrayLike, force: ArrayLike | None = None, torque: ArrayLike | None = None
    ) -> Floats:
        """Derivatives of {f} by {x}, {y} and the run-time parameters; `derivative_columns` says where.

        Args:
            x: As in `forcing`, like everything else.
            y: Generalized speeds.
            force: Forces on the bodies.
            torque: Torques on the bodies.

        Returns:
            (n, K) or (B, n, K): a row for each freedom, in N m and N over the units of what it is by.

        Raises:
            ArrayError, OptionError: As `forcing`.
        """
        if force is not None or torque is not None:
            self._require_loads(force)
        return self._call("forcing_derivatives")(self._constants, (x, y, None, None, force, torque))[0]

    def inverse_dynamics_derivatives(
        self,
        x: ArrayLike,
        y: ArrayLike,
        ydot: ArrayLike,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
    ) -> Floats:
        """Derivatives of [A]{ydot} - {f} by {x}, {y} and the run-time parameters; by {ydot} it is [A].

        Args:
            x: As in `inverse_dynamics`, like everything else.
            y: Generalized speeds.
            ydot: Their rates.
            force: Forces on the bodies.
            torque: Torques on the bodies.

        Returns:
            (n, K) or (B, n, K), as `forcing_derivatives`.

        Raises:
            ArrayError, OptionError: As `inverse_dynamics`.
        """
        if force is not None or torque is not None:
            self._require_loads(force)
        values = (x, y, ydot, None, force, torque)
        return self._call("inverse_dynamics_derivatives")(self._constants, values)[0]

    def forward_dynamics_derivatives(
        self,
        x: ArrayLike,
        y: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
    ) -> Floats:
        """Derivatives of {ydot} by {x}, {y}, {tau}, which are [A]^-1, and the run-time parameters.

        Args:
            x: As in `forward_dynamics`, like everything else.
            y: Generalized speeds.
            tau: Generalized forces.
            force: Forces on the bodies.
            torque: Torques on the bodies.

        Returns:
            (n, K) or (B, n, K), in rad/s^2 and m/s^2 over the units of what they are by; NaN where [A] is
            singular in a state of a batch.

        Raises:
            ArrayError, OptionError, SingularError: As `forward_dynamics`.
        """
        if force is not None or torque is not None:
            self._require_loads(force)
        values = (x, y, None, tau, force, torque)
        return self._call("forward_dynamics_derivatives")(self._constants, values)[0]

    def derivative_columns(self, output: str) -> dict[str, slice]:
        """Which of the last axis of an output of derivatives is by "x", "y", "tau" and "parameters".

        Raises:
            OptionError: If there is no such output.
        """
        require_one("output of derivatives", output, DERIVATIVES)
        m, n = len(self.coordinate_names), self.n
        return columns(output, m, n, len(self._parameters))

    def evaluate(
        self,
        x: ArrayLike,
        y: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        *,
        ydot: ArrayLike | None = None,
        tau: ArrayLike | None = None,
    ) -> Evaluation:
        """Every output at once, which costs less than one after the other.

        Args:
            x: As in `forcing`.
            y: As in `forcing`; needed where an output depends on it.
            force: As in `forcing`.
            torque: As in `forcing`.
            ydot: As in `inverse_dynamics`; needed where that is among the outputs.
            tau: As in `forward_dynamics`.

        Returns:
            The outputs in order, each also an attribute of its name.

        Raises:
            ArrayError, SingularError: As the functions of the outputs.
        """
        if force is not None or torque is not None:
            self._require_loads(force)
        values = (x, y, ydot, tau, force, torque)
        return Evaluation(self.outputs, self._together(self._constants, values))

    def _call(self, name: str) -> Call:
        call = self._native.calls.get(name)
        if call is None:
            raise OptionError(
                f"system {self.name!r} was built without the output {name!r}. It has "
                f"{', '.join(self.outputs)}; ask for more with outputs=(...)."
            )
        return call

    def _require_loads(self, force: object) -> None:
        if not self._takes_loads:
            name = "torque" if force is None else "force"
            raise ArrayError(
                f"{name}: no body of system {self.name!r} takes loads. Say which do in the model's loads."
            )


def _reopen(source: Source, path: Path, parameters: Mapping[str, float]) -> Library:
    return Library(Native(source, path), parameters)
