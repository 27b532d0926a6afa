"""How large the numbers are that [A] and {f} are summed from: the yardstick for rounding errors.

An entry of [A] or {f} is a sum over the bodies of products of vectors, and each vector is itself built along
the path from the ground to its body. Rounding errors scale with what is added on the way, not with what is
left at the end. So this module takes the sums (43) and (44) with every vector replaced by the largest length
that it or its parts take anywhere on the path, and with plus signs only. Whatever way a program goes along
the tree, its partial sums stay below a small multiple of these.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike

from kanegen.model.arguments import LoadInputs
from kanegen.model.arrays import Floats, SystemArrays
from kanegen.program.precision import DOUBLE, Precision
from kanegen.reference.arguments import acting, motion
from kanegen.reference.force_elements import contributions
from kanegen.reference.freedoms import UNPRESCRIBED, free_columns, full_order
from kanegen.reference.kinematics import BodyKinematics
from kanegen.reference.matrices import Numbers, apply, length, transposed


@dataclass(frozen=True)
class Reach:
    """The largest lengths on the path from the ground to one body; units as the vector's.

    Attributes:
        omega_y: (..., 6N) columns of the partial angular velocities.
        origin_y: (..., 6N) columns of the partial velocities of the origins.
        center_y: (..., 6N) columns of those of this body's mass centre, and of everything before it.
        rate: (...) angular velocities, absolute and relative.
        velocity: (...) velocities of the origins.
        rate_dot: (...) angular accelerations at constant speeds, save for those that are prescribed.
        velocity_dot: (...) accelerations of the origins, likewise.
        center_acceleration: (...) acceleration of this body's mass centre, and of everything before it.
    """

    omega_y: Floats
    origin_y: Floats
    center_y: Floats
    rate: Floats
    velocity: Floats
    rate_dot: Floats
    velocity_dot: Floats
    center_acceleration: Floats


def reaches(
    system: SystemArrays,
    bodies: tuple[BodyKinematics, ...],
    y: Numbers,
    prescribed: Numbers = UNPRESCRIBED,
) -> tuple[Reach, ...]:
    """The reach of bodies 1 to N, from their kinematics, the speeds `y` (..., n) and what is prescribed."""
    count = len(bodies)
    speeds = full_order(system, y, prescribed[..., 1, :])
    given = full_order(system, np.zeros_like(y), prescribed[..., 2, :])
    zero, columns = np.zeros(y.shape[:-1]), np.zeros((*y.shape[:-1], 6 * count))
    found = [Reach(columns, columns, columns, zero, zero, zero, zero, zero)]
    for k, body in enumerate(bodies):
        found.append(_reach(system, k, body, found[system.connection[k]], speeds, given))
    return tuple(found[1:])


def _reach(
    system: SystemArrays, k: int, body: BodyKinematics, lower: Reach, speeds: Numbers, given: Numbers
) -> Reach:
    """`speeds` and `given` are (..., 6N) all speeds, and the accelerations that are prescribed."""
    arm = np.maximum(length(body.offset), length(system.joint_position[k]))
    lever = length(system.mass_center[k])
    omega_y = length(body.omega_y, axis=-2)
    origin_y = _largest(lower.origin_y, length(body.origin_y, axis=-2), arm[..., None] * lower.omega_y)
    center_y = _largest(origin_y, length(body.center_y, axis=-2), lever * omega_y)

    rate = _largest(lower.rate, length(body.omega), length(speeds[..., 3 * k : 3 * k + 3]))
    velocity = _largest(
        lower.velocity, length(apply(body.origin_y, speeds)), length(body.offset_dot), lower.rate * arm
    )
    turning, moving = given[..., 3 * k : 3 * k + 3], apply(body.origin_y, given)
    rate_dot = _largest(
        lower.rate_dot,
        length(apply(body.omega_y_dot, speeds)),
        length(apply(body.omega_y, given)),
        length(turning),
        rate * rate,
    )
    velocity_dot = _largest(
        lower.velocity_dot,
        length(apply(body.origin_y_dot, speeds)),
        length(moving),
        lower.rate_dot * arm,
        rate * velocity,
    )
    center_acceleration = _largest(
        velocity_dot,
        length(apply(body.center_y_dot, speeds)),
        length(apply(body.center_y, given)),
        rate_dot * lever,
        rate * length(body.center_velocity),
        rate * rate * lever,
    )
    return Reach(omega_y, origin_y, center_y, rate, velocity, rate_dot, velocity_dot, center_acceleration)


def mass_matrix_magnitude(system: SystemArrays, reach: tuple[Reach, ...]) -> Floats:
    """(..., n, n) Eq. (43) in magnitudes."""
    center_y, omega_y = _columns(system, reach)
    linear = transposed(system.mass[:, None] * center_y) @ center_y
    angular = transposed(_inertia_size(system)[:, None] * omega_y) @ omega_y
    magnitude: Floats = linear + angular
    return magnitude


def forcing_magnitude(
    system: SystemArrays, reach: tuple[Reach, ...], force: Floats | None, torque: Floats | None
) -> Floats:
    """(..., n) Eq. (44) in magnitudes; `force` and `torque` are (..., N, 3).

    Programs that take moments of momentum about moving origins also add and cancel `v_O x m v_O`.
    """
    center_y, omega_y = _columns(system, reach)
    acceleration = np.stack([body.center_acceleration for body in reach], axis=-1)
    rate_dot = np.stack([body.rate_dot for body in reach], axis=-1)
    velocity = np.stack([body.velocity for body in reach], axis=-1)
    linear = system.mass * (acceleration + length(system.gravity))
    angular = _inertia_size(system) * rate_dot + system.mass * velocity**2
    if force is not None:
        linear = linear + length(force)
    if torque is not None:
        angular = angular + length(torque)
    return apply(transposed(center_y), linear) + apply(transposed(omega_y), angular)


def element_magnitude(
    system: SystemArrays,
    bodies: tuple[BodyKinematics, ...],
    x: Numbers,
    y: Numbers,
    prescribed: ArrayLike | None = None,
    **given: Unpack[LoadInputs],
) -> Floats:
    """(..., n) what the generalized forces of force elements and loads on points are rounded by.

    Args:
        system: The numbers of the tree.
        bodies: Their kinematics.
        x: (..., m) coordinates.
        y: (..., n) generalized speeds.
        prescribed: As in `reference.mass_matrix`.
        given: As in `reference.forcing`.
    """
    told = motion(system, prescribed, x)
    speeds, free = full_order(system, y, told[..., 1, :]), free_columns(system)
    parts = contributions(system, bodies, (x, told[..., 0, :]), speeds, acting(system, x, **given))
    return sum((part.size[..., free] for part in parts), start=np.zeros(y.shape))


def rounding_bound(bodies: int, precision: Precision = DOUBLE, storage: Precision = DOUBLE) -> float:
    """How far two programs may differ in a tree of N bodies, relative to the magnitudes: 8 (N + 8) u.

    Every rotation, cross product and sum along the tree adds a few roundings, so the error grows at most
    linearly with N; the second 8 stands for sines, products and inertias within a body. The first is 2 for
    two programs times 4, because a program that sums inward can have partial sums twice as long as the
    outward ones that are measured here, in both factors of a product. See docs/accuracy.md for the test.
    u is that of the less precise program, of which the reference is one, in double. Results in arrays of
    fewer digits than the arithmetic are rounded once more, which is at most the roundoff of these.
    """
    stored = storage.roundoff if storage.roundoff > precision.roundoff else 0.0
    return 8 * (bodies + 8) * max(precision.roundoff, DOUBLE.roundoff) + stored


def _columns(system: SystemArrays, reach: tuple[Reach, ...]) -> tuple[Floats, Floats]:
    """(..., N, n) reach of the free columns of the partial velocities and partial angular velocities."""
    free = free_columns(system)
    center_y = np.stack([body.center_y[..., free] for body in reach], axis=-2)
    omega_y = np.stack([body.omega_y[..., free] for body in reach], axis=-2)
    return center_y, omega_y


def _inertia_size(system: SystemArrays) -> Floats:
    """(N,) Frobenius norms."""
    size: Floats = np.linalg.norm(system.inertia, axis=(1, 2))
    return size


def _largest(*values: Floats) -> Floats:
    result = values[0]
    for value in values[1:]:
        result = np.maximum(result, value)
    return result
