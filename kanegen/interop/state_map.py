"""`StateMap`: states, forces and matrices of a system in the convention of another program, and back.

With q and v the other program's coordinates and velocities, v = [J]{y} and vdot = [J]{ydot} + [Jdot]{y}. Work
is the same in both, so {tau} = [J]^T tau' and [A] = [J]^T M [J]. The other program's equations are
M vdot + bias = tau', so {f} = -[J]^T (bias + M [Jdot]{y}). A Jacobian by v becomes one by {y} with [J] on its
right.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from kanegen.errors import ArrayError, ModelError, quoted
from kanegen.interop.blocks import Block, Follower, Positions
from kanegen.model.arguments import floats
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.reference.matrices import apply, transposed


@dataclass(frozen=True)
class StateMap:
    """The map between a system of kanegen and a model of another program, both ways.

    Every method takes one state, or a batch of B states with a leading axis. Methods `to_...` return values
    of the other program, methods `from_...` those of kanegen; both take the state as {x} and {y}. Where
    speeds are rates of three angles, [J] is singular at gimbal lock, where its inverse is inaccurate.

    Attributes:
        blocks: The joints.
        m: Number of coordinates in {x}.
        n: Number of speeds in {y}.
        nq: Number of coordinates in q.
        nv: Number of velocities in v; n and the number of followers.
        followers: Joints that are coupled in kanegen and move by themselves in the other model. With them, v
            and vdot that kanegen takes must keep the couplings, and forces of the other program that do some
            work are not unique.
    """

    blocks: tuple[Block, ...]
    m: int
    n: int
    nq: int
    nv: int
    followers: tuple[Follower, ...] = ()

    def to_q(self, x: ArrayLike) -> Floats:
        """Return (..., nq) q from (..., m) {x}.

        Raises:
            ArrayError: If the shape is another, or a quaternion is zero.

        Example:
            q = states.to_q(x)
        """
        given = _array("x", x, self.m)
        q = np.zeros((*given.shape[:-1], self.nq))
        every: tuple[Positions, ...] = (*self.blocks, *self.followers)
        for block in every:
            q[..., block.q] = block.to_q(given[..., block.x])
        return q

    def from_q(self, q: ArrayLike) -> Floats:
        """Return (..., m) {x} from (..., nq) q; angles are from -pi to pi where q has no angle itself.

        Raises:
            ArrayError: If the shape is another, or a quaternion is not of unit length.

        Example:
            x = states.from_q(pinocchio.neutral(model))
        """
        given = _array("q", q, self.nq)
        x = np.zeros((*given.shape[:-1], self.m))
        for block in self.blocks:
            x[..., block.x] = block.from_q(given[..., block.q])
        return x

    def jacobian(self, x: ArrayLike) -> Floats:
        """Return (..., nv, n) the matrix [J] of v = [J]{y}.

        Raises:
            ArrayError: If the shape of x is another.

        Example:
            v = states.jacobian(x) @ y
        """
        given = _array("x", x, self.m)
        matrix = np.zeros((*given.shape[:-1], self.nv, self.n))
        for block in self.blocks:
            matrix[..., np.array(block.v)[:, None], np.array(block.y)] = block.jacobian(given[..., block.x])
        for follower in self.followers:
            matrix[..., follower.v[0], follower.y] = follower.factors
        return matrix

    def drift(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Return (..., nv) the product [Jdot]{y}: vdot where {ydot} = {0}.

        Raises:
            ArrayError: If a shape is another.

        Example:
            vdot = states.jacobian(x) @ ydot + states.drift(x, y)
        """
        given, speeds = _array("x", x, self.m), self._beside(x, "y", y, self.n)
        found = np.zeros((*given.shape[:-1], self.nv))
        for block in self.blocks:
            found[..., block.v] = block.drift(given[..., block.x], speeds[..., block.y])
        return found

    def to_v(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Return (..., nv) v from (..., m) {x} and (..., n) {y}.

        Example:
            q, v = states.to_q(x), states.to_v(x, y)
        """
        return apply(self.jacobian(x), self._beside(x, "y", y, self.n))

    def from_v(self, x: ArrayLike, v: ArrayLike) -> Floats:
        """Return (..., n) {y} from (..., m) {x} and (..., nv) v.

        Example:
            x = states.from_q(q)
            y = states.from_v(x, v)
        """
        return _solved(self.jacobian(x), self._beside(x, "v", v, self.nv))

    def to_vdot(self, x: ArrayLike, y: ArrayLike, ydot: ArrayLike) -> Floats:
        """Return (..., nv) vdot from {x}, {y} and (..., n) {ydot}.

        Example:
            vdot = states.to_vdot(x, y, library.forward_dynamics(x, y))
        """
        return apply(self.jacobian(x), self._beside(x, "ydot", ydot, self.n)) + self.drift(x, y)

    def from_vdot(self, x: ArrayLike, y: ArrayLike, vdot: ArrayLike) -> Floats:
        """Return (..., n) {ydot} from {x}, {y} and (..., nv) vdot.

        Example:
            ydot = states.from_vdot(x, y, pinocchio.aba(model, data, q, v, tau))
        """
        return _solved(self.jacobian(x), self._beside(x, "vdot", vdot, self.nv) - self.drift(x, y))

    def to_tau(self, x: ArrayLike, tau: ArrayLike) -> Floats:
        """Return (..., nv) generalized forces of the other program that do the work of (..., n) {tau}.

        Example:
            pinocchio.aba(model, data, states.to_q(x), states.to_v(x, y), states.to_tau(x, tau))
        """
        self._require_unique("generalized forces")
        return _solved(transposed(self.jacobian(x)), self._beside(x, "tau", tau, self.n))

    def from_tau(self, x: ArrayLike, tau: ArrayLike) -> Floats:
        """Return (..., n) {tau} that does the work of (..., nv) generalized forces of the other program.

        Example:
            states.from_tau(x, data.qfrc_actuator)
        """
        return apply(transposed(self.jacobian(x)), self._beside(x, "tau", tau, self.nv))

    def to_mass_matrix(self, x: ArrayLike, a: ArrayLike) -> Floats:
        """Return (..., nv, nv) M from (..., n, n) [A].

        Example:
            m = states.to_mass_matrix(x, library.mass_matrix(x))
        """
        self._require_unique("a mass matrix")
        turn = transposed(self.jacobian(x))
        half = np.linalg.solve(turn, self._matrix_beside(x, "A", a, self.n, self.n))
        return transposed(np.asarray(np.linalg.solve(turn, transposed(half))))

    def from_mass_matrix(self, x: ArrayLike, m: ArrayLike) -> Floats:
        """Return (..., n, n) [A] from (..., nv, nv) M, all of whose entries are filled.

        Example:
            a = states.from_mass_matrix(x, pinocchio.crba(model, data, q))
        """
        jacobian = self.jacobian(x)
        found: Floats = transposed(jacobian) @ self._matrix_beside(x, "M", m, self.nv, self.nv) @ jacobian
        return found

    def to_bias(self, x: ArrayLike, y: ArrayLike, a: ArrayLike, f: ArrayLike) -> Floats:
        """Return (..., nv) the bias of M vdot + bias = tau' from {x}, {y}, [A] and {f}.

        Example:
            bias = states.to_bias(x, y, library.mass_matrix(x), library.forcing(x, y))
        """
        inertial = apply(self.to_mass_matrix(x, a), self.drift(x, y))
        return -self.to_tau(x, f) - inertial

    def from_bias(self, x: ArrayLike, y: ArrayLike, m: ArrayLike, bias: ArrayLike) -> Floats:
        """Return (..., n) {f} from {x}, {y}, M and the bias of M vdot + bias = tau'.

        Example:
            f = states.from_bias(x, y, m, pinocchio.nonLinearEffects(model, data, q, v))
        """
        inertial = apply(self._matrix_beside(x, "M", m, self.nv, self.nv), self.drift(x, y))
        return -self.from_tau(x, self._beside(x, "bias", bias, self.nv) + inertial)

    def to_columns(self, x: ArrayLike, jacobian: ArrayLike) -> Floats:
        """Return (..., r, nv) a Jacobian by v from (..., r, n) one by {y}; its rows stay.

        Example:
            states.to_columns(x, library.point_jacobians(x)[0])
        """
        self._require_unique("a Jacobian")
        rows = transposed(self._matrix_beside(x, "jacobian", jacobian, None, self.n))
        return transposed(np.asarray(np.linalg.solve(transposed(self.jacobian(x)), rows)))

    def from_columns(self, x: ArrayLike, jacobian: ArrayLike) -> Floats:
        """Return (..., r, n) a Jacobian by {y} from (..., r, nv) one by v; its rows stay.

        Example:
            states.from_columns(x, pinocchio.computeJointJacobian(model, data, q, joint))
        """
        found: Floats = self._matrix_beside(x, "jacobian", jacobian, None, self.nv) @ self.jacobian(x)
        return found

    def _beside(self, x: ArrayLike, name: str, value: ArrayLike, size: int) -> Floats:
        """Return an argument of shape (..., size) for the states of {x}.

        Raises:
            ArrayError: If it has another shape.
        """
        batch, array = _array("x", x, self.m).shape[:-1], _array(name, value, size)
        if array.shape[:-1] != batch:
            raise ArrayError(f"{name}: expected shape {(*batch, size)} to go with x, got {array.shape}.")
        return array

    def _matrix_beside(
        self, x: ArrayLike, name: str, value: ArrayLike, rows: int | None, columns: int
    ) -> Floats:
        """Return an argument of shape (..., rows, columns) for the states of {x}, None for any number.

        Raises:
            ArrayError: If it has another shape.
        """
        batch, array = _array("x", x, self.m).shape[:-1], _matrix(name, value, rows, columns)
        if array.shape[:-2] != batch:
            shape = (*batch, *array.shape[-2:])
            raise ArrayError(f"{name}: expected shape {shape} to go with x, got {array.shape}.")
        return array

    def _require_unique(self, what: str) -> None:
        """Make sure that no joint of the other model is coupled in kanegen.

        Raises:
            ModelError: If one is, so that values by its velocity do not follow from those by {y}.
        """
        if self.followers:
            raise ModelError(
                f"{what} in the other program: {len(self.followers)} of its velocities follow others, so "
                "there is more than one. Take a model whose joints are coupled, too, or convert to kanegen."
            )


def exchanged_rows(jacobian: ArrayLike) -> Floats:
    """Return (..., 6, k) a Jacobian with its angular and linear rows exchanged.

    kanegen has the angular rows first, as Drake and the spatial vectors of MuJoCo have. Pinocchio and ROS
    have the linear rows first.

    Raises:
        ArrayError: If there are not six rows.

    Example:
        exchanged_rows(pinocchio.getFrameJacobian(model, data, frame, pinocchio.LOCAL_WORLD_ALIGNED))
    """
    given = _matrix("jacobian", jacobian, 6, None)
    return np.concatenate([given[..., 3:, :], given[..., :3, :]], axis=-2)


def state_map_of(
    blocks: Sequence[Block | Follower], system: System, nq: int, nv: int, program: str
) -> StateMap:
    """Return the map of blocks, after a check that they have every freedom of the system.

    Args:
        blocks: The joints of the other program's model.
        system: The system.
        nq: Number of coordinates of the model.
        nv: Number of velocities of the model.
        program: Name of the other program, for messages.

    Raises:
        ModelError: If the model lacks freedoms of the system.
    """
    followers = tuple(block for block in blocks if isinstance(block, Follower))
    others = tuple(block for block in blocks if not isinstance(block, Follower))
    found = {place for block in others for place in block.y}
    missing = [name for place, name in enumerate(system.freedom_names) if place not in found]
    if missing:
        names = ", ".join(missing)
        raise ModelError(
            f"system {quoted(system.name)}: {program}'s model has no joints for these freedoms: {names}. "
            "Lock them, or name the joints alike."
        )
    return StateMap(others, len(system.coordinates), len(system.freedoms), nq, nv, followers)


def _array(name: str, value: ArrayLike, size: int) -> Floats:
    """Return an argument of shape (..., size).

    Raises:
        ArrayError: If it has another shape.
    """
    array = np.asarray(floats(name, value, np.dtype(np.float64)), dtype=np.float64)
    if array.ndim == 0 or array.shape[-1] != size:
        raise ArrayError(f"{name}: expected shape ({size},) or (B, {size}), got {array.shape}.")
    return array


def _matrix(name: str, value: ArrayLike, rows: int | None, columns: int | None) -> Floats:
    """Return an argument of shape (..., rows, columns), None for any number.

    Raises:
        ArrayError: If it has another shape.
    """
    array = np.asarray(floats(name, value, np.dtype(np.float64)), dtype=np.float64)
    wanted = (rows, columns)
    if array.ndim < 2 or any(a not in (None, b) for a, b in zip(wanted, array.shape[-2:], strict=True)):
        shape = ", ".join("r" if size is None else str(size) for size in wanted)
        raise ArrayError(f"{name}: expected shape ({shape}) or (B, {shape}), got {array.shape}.")
    return array


def _solved(matrix: Floats, vector: Floats) -> Floats:
    """Return the solutions (..., n) of linear equations, which may be more than n if they agree."""
    if matrix.shape[-2] != matrix.shape[-1]:
        return apply(np.asarray(np.linalg.pinv(matrix)), vector)
    return np.asarray(np.linalg.solve(matrix, vector[..., None]))[..., 0]
