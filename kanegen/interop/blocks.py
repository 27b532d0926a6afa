"""The joints of another program: blocks of its q and v, and how they follow from kanegen's {x} and {y}.

Each block names its places in {x}, {y}, q and v. Its velocities are v = [J]{y}, with a matrix [J] that may
depend on {x}. In shapes, `...` is the batch: nothing, or (B,).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from kanegen.interop.orientations import Orientation
from kanegen.model.arrays import Floats
from kanegen.reference.matrices import apply

Places = tuple[int, ...]


class Positions(Protocol):
    """Joints whose part of q follows from {x}."""

    @property
    def x(self) -> Places:
        """Places of the joints in {x}."""

    @property
    def y(self) -> Places:
        """Places of the joints in {y}."""

    @property
    def q(self) -> Places:
        """Places of the joints in q."""

    @property
    def v(self) -> Places:
        """Places of the joints in v."""

    def to_q(self, x: Floats) -> Floats:
        """Return the part of q from the part of {x}."""


class Block(Positions, Protocol):
    """One joint, or several of the same kind, with freedoms in both programs."""

    def from_q(self, q: Floats) -> Floats:
        """Return the part of {x} from the part of q."""

    def jacobian(self, x: Floats) -> Floats:
        """Return (..., k, k) the matrix [J] of v = [J]{y}, from the part of {x}."""

    def drift(self, x: Floats, y: Floats) -> Floats:
        """Return (..., k) the product [Jdot]{y}, from the parts of {x} and {y}."""


@dataclass(frozen=True)
class Scalars:
    """Joints with one coordinate each, which is the same in both programs: rad or m."""

    x: Places
    y: Places
    q: Places
    v: Places

    def to_q(self, x: Floats) -> Floats:
        """Return the coordinates, which are the same."""
        return x

    def from_q(self, q: Floats) -> Floats:
        """Return the coordinates, which are the same."""
        return q

    def jacobian(self, x: Floats) -> Floats:
        """Return identities: both programs have the same speeds."""
        return _identity(x, len(self.v))

    def drift(self, x: Floats, y: Floats) -> Floats:
        """Return zeros, since [J] is constant."""
        return np.zeros_like(y)


@dataclass(frozen=True)
class Follower:
    """A joint with one coordinate that moves by itself in the other program, and is coupled in kanegen.

    Attributes:
        x: Places in {x} of the freedoms that it follows.
        y: Their places in {y}.
        q: Its place in q.
        v: Its place in v.
        factors: Factor of each freedom that it follows.
        offset: Its value where all of them are zero (rad, m).
    """

    x: Places
    y: Places
    q: Places
    v: Places
    factors: tuple[float, ...]
    offset: float

    def to_q(self, x: Floats) -> Floats:
        """Return (..., 1) its coordinate from those that it follows."""
        found: Floats = x @ np.array(self.factors)[:, None] + self.offset
        return found


@dataclass(frozen=True)
class CosineSine:
    """A hinge without limits whose q is the cosine and the sine of its angle."""

    x: Places
    y: Places
    q: Places
    v: Places

    def to_q(self, x: Floats) -> Floats:
        """Return cosine and sine of the angle."""
        return np.concatenate([np.cos(x), np.sin(x)], axis=-1)

    def from_q(self, q: Floats) -> Floats:
        """Return the angle, from -pi to pi."""
        return np.arctan2(q[..., 1:], q[..., :1])

    def jacobian(self, x: Floats) -> Floats:
        """Return identities: both programs have the same speeds."""
        return _identity(x, 1)

    def drift(self, x: Floats, y: Floats) -> Floats:
        """Return zeros, since [J] is constant."""
        return np.zeros_like(y)


@dataclass(frozen=True)
class Ball:
    """A ball joint: q is a unit quaternion, v the relative angular velocity in the body.

    Attributes:
        orientation: The orientation of kanegen's body in its joint frame.
        scalar_last: Whether q has the scalar behind the vector.
    """

    x: Places
    y: Places
    q: Places
    v: Places
    orientation: Orientation
    scalar_last: bool

    def to_q(self, x: Floats) -> Floats:
        """Return the unit quaternion of the orientation."""
        found = self.orientation.euler_parameters(x)
        return np.roll(found, -1, axis=-1) if self.scalar_last else found

    def from_q(self, q: Floats) -> Floats:
        """Return the angles or the Euler parameters."""
        return self.orientation.coordinates(np.roll(q, 1, axis=-1) if self.scalar_last else q)

    def jacobian(self, x: Floats) -> Floats:
        """Return [P], Eq. (8), or the identity for speeds that are the angular velocity."""
        _, rate_matrix, _ = self.orientation.matrices(x, np.zeros((*x.shape[:-1], 3)))
        return rate_matrix

    def drift(self, x: Floats, y: Floats) -> Floats:
        """Return [Pdot]{y}, zeros for an angular velocity."""
        _, _, rate_matrix_dot = self.orientation.matrices(x, y)
        return apply(rate_matrix_dot, y)


@dataclass(frozen=True)
class Floating:
    """A body with six freedoms: position before orientation, linear before angular velocity.

    Attributes:
        ball: The orientation; its places count within the block.
        is_local: Whether the linear velocity has components in the body, not in the joint frame.
    """

    x: Places
    y: Places
    q: Places
    v: Places
    ball: Ball
    is_local: bool

    def to_q(self, x: Floats) -> Floats:
        """Return the position and the unit quaternion."""
        return np.concatenate([x[..., :3], self.ball.to_q(x[..., 3:])], axis=-1)

    def from_q(self, q: Floats) -> Floats:
        """Return translations, then angles or Euler parameters."""
        return np.concatenate([q[..., :3], self.ball.from_q(q[..., 3:])], axis=-1)

    def jacobian(self, x: Floats) -> Floats:
        """Return [R] (or the identity) and [P] on the diagonal."""
        turning = x[..., 3:]
        rotation, rate_matrix, _ = self.ball.orientation.matrices(turning, np.zeros((*x.shape[:-1], 3)))
        found = np.zeros((*x.shape[:-1], 6, 6))
        found[..., :3, :3] = rotation if self.is_local else np.eye(3)
        found[..., 3:, 3:] = rate_matrix
        return found

    def drift(self, x: Floats, y: Floats) -> Floats:
        """Return -{omega} x {v} for components in the body (else zero), and [Pdot]{y}."""
        turning, rates = x[..., 3:], y[..., 3:]
        rotation, rate_matrix, rate_matrix_dot = self.ball.orientation.matrices(turning, rates)
        linear = -np.cross(apply(rate_matrix, rates), apply(rotation, y[..., :3]))
        return np.concatenate([linear * self.is_local, apply(rate_matrix_dot, rates)], axis=-1)


@dataclass(frozen=True)
class Planar:
    """A body that moves in a plane: q is position, cosine and sine; v has components in the body."""

    x: Places
    y: Places
    q: Places
    v: Places

    def to_q(self, x: Floats) -> Floats:
        """Return position, cosine and sine of the angle."""
        return np.concatenate([x[..., :2], np.cos(x[..., 2:]), np.sin(x[..., 2:])], axis=-1)

    def from_q(self, q: Floats) -> Floats:
        """Return position and angle, from -pi to pi."""
        return np.concatenate([q[..., :2], np.arctan2(q[..., 3:], q[..., 2:3])], axis=-1)

    def jacobian(self, x: Floats) -> Floats:
        """Return the rotation to the body, in the plane."""
        sine, cosine = np.sin(x[..., 2]), np.cos(x[..., 2])
        found = _identity(x, 3)
        found[..., 0, 0] = found[..., 1, 1] = cosine
        found[..., 0, 1], found[..., 1, 0] = sine, -sine
        return found

    def drift(self, x: Floats, y: Floats) -> Floats:
        """Return -{omega} x {v}, in the body."""
        v = apply(self.jacobian(x), y)
        return np.stack([v[..., 1] * y[..., 2], -v[..., 0] * y[..., 2], np.zeros_like(y[..., 2])], axis=-1)


def _identity(x: Floats, size: int) -> Floats:
    """Return (..., k, k) identities for the batch of (..., m) coordinates."""
    return np.broadcast_to(np.eye(size), (*x.shape[:-1], size, size)).copy()
