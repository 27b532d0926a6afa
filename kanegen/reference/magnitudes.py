"""Magnitudes of the terms that [A] and {f} are summed from, to which rounding errors are relative.

An entry of [A] or {f} is a sum over the bodies of products of vectors, and each vector is itself summed
along the path from the ground to its body. Rounding errors scale with the terms that are added on the way,
not with the sum at the end. So a magnitude is the sum (43) or (44) with every vector replaced by the
largest length that it or one of its parts has anywhere on the path, and with plus signs only. Whichever way
a program goes along the tree, its partial sums stay below a small multiple of the magnitude.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike

from kanegen.model.arguments import LoadInputs
from kanegen.model.arrays import Floats, SystemArrays
from kanegen.program.precision import DOUBLE, Precision
from kanegen.reference.arguments import point_inputs, prescribed_motion
from kanegen.reference.force_elements import contributions
from kanegen.reference.freedoms import UNPRESCRIBED, free_columns, full_order, gathered
from kanegen.reference.kinematics import BodyKinematics
from kanegen.reference.matrices import Numbers, apply, length, transposed
from kanegen.reference.motors import armature_in_order, spin_of


@dataclass(frozen=True)
class PathMaxima:
    """The largest lengths of vectors on the path from the ground to one body, in SI units.

    Accelerations are those at constant free speeds; prescribed accelerations count.

    Attributes:
        omega_y: (..., 6N) lengths of the columns of partial angular velocities.
        origin_y: (..., 6N) lengths of the columns of partial velocities of origins.
        center_y: (..., 6N) the same for this body's mass centre and for everything before it.
        rate: (...) lengths of angular velocities, absolute and relative.
        velocity: (...) lengths of velocities of origins.
        rate_dot: (...) lengths of angular accelerations.
        velocity_dot: (...) lengths of accelerations of origins.
        center_acceleration: (...) the same for this body's mass centre and for everything before it.
    """

    omega_y: Floats
    origin_y: Floats
    center_y: Floats
    rate: Floats
    velocity: Floats
    rate_dot: Floats
    velocity_dot: Floats
    center_acceleration: Floats


def path_maxima(
    system: SystemArrays,
    bodies: tuple[BodyKinematics, ...],
    y: Numbers,
    prescribed: Numbers = UNPRESCRIBED,
) -> tuple[PathMaxima, ...]:
    """Return the largest lengths on the paths to bodies 1 to N.

    Args:
        system: The numbers of the tree.
        bodies: Kinematics of bodies 1 to N.
        y: (..., n) generalized speeds.
        prescribed: (..., 3, p) values, rates and second derivatives of the prescribed freedoms.
    """
    count = len(bodies)
    speeds = full_order(system, y, prescribed[..., 1, :])
    accelerations = full_order(system, np.zeros_like(y), prescribed[..., 2, :])
    zero, columns = np.zeros(y.shape[:-1]), np.zeros((*y.shape[:-1], 6 * count))
    found = [PathMaxima(columns, columns, columns, zero, zero, zero, zero, zero)]
    for k, body in enumerate(bodies):
        found.append(_maxima(system, k, body, found[system.connection[k]], speeds, accelerations))
    return tuple(found[1:])


def _maxima(
    system: SystemArrays,
    k: int,
    body: BodyKinematics,
    lower: PathMaxima,
    speeds: Numbers,
    accelerations: Numbers,
) -> PathMaxima:
    """Return the largest lengths on the path to one body from those on the path to its lower body.

    Args:
        system: The numbers of the tree.
        k: Index of the body, from 0.
        body: Kinematics of the body.
        lower: Largest lengths on the path to its lower body.
        speeds: (..., 6N) speeds in the order of Eq. (1).
        accelerations: (..., 6N) prescribed accelerations in the same order.
    """
    arm = np.maximum(length(body.offset), length(system.joint_position[k]))
    arm_to_center = length(system.mass_center[k])
    omega_y = length(body.omega_y, axis=-2)
    origin_y = _largest(lower.origin_y, length(body.origin_y, axis=-2), arm[..., None] * lower.omega_y)
    center_y = _largest(origin_y, length(body.center_y, axis=-2), arm_to_center * omega_y)

    rate = _largest(lower.rate, length(body.omega), length(speeds[..., 3 * k : 3 * k + 3]))
    velocity = _largest(
        lower.velocity, length(apply(body.origin_y, speeds)), length(body.offset_dot), lower.rate * arm
    )
    relative = accelerations[..., 3 * k : 3 * k + 3]
    rate_dot = _largest(
        lower.rate_dot,
        length(apply(body.omega_y_dot, speeds)),
        length(apply(body.omega_y, accelerations)),
        length(relative),
        rate * rate,
    )
    velocity_dot = _largest(
        lower.velocity_dot,
        length(apply(body.origin_y_dot, speeds)),
        length(apply(body.origin_y, accelerations)),
        lower.rate_dot * arm,
        rate * velocity,
    )
    center_acceleration = _largest(
        velocity_dot,
        length(apply(body.center_y_dot, speeds)),
        length(apply(body.center_y, accelerations)),
        rate_dot * arm_to_center,
        rate * length(body.center_velocity),
        rate * rate * arm_to_center,
    )
    return PathMaxima(
        omega_y, origin_y, center_y, rate, velocity, rate_dot, velocity_dot, center_acceleration
    )


def mass_matrix_magnitude(system: SystemArrays, maxima: tuple[PathMaxima, ...]) -> Floats:
    """Return the (..., n, n) magnitudes of the terms of [A], Eq. (43)."""
    center_y, omega_y = _columns(system, maxima)
    linear = transposed(system.mass[:, None] * center_y) @ center_y
    angular = transposed(_inertia_size(system)[:, None] * omega_y) @ omega_y
    magnitude: Floats = linear + angular + _motor_magnitude(system, maxima)
    return magnitude


def _motor_magnitude(system: SystemArrays, maxima: tuple[PathMaxima, ...]) -> Floats:
    """Return the (n, n) or (..., n, n) magnitudes of what motors add to [A]."""
    magnitude: Floats = np.diag(armature_in_order(system))
    for rotor in system.rotors:
        place, momentum, spin = spin_of(system, rotor)
        row = length(momentum) * maxima[rotor.body - 1].omega_y if rotor.body else 0.0 * maxima[0].omega_y
        own = np.zeros((*row.shape, row.shape[-1]))
        own[..., place, :] = row
        own = own + transposed(own)
        own[..., place, place] += spin
        magnitude = magnitude + own
    rates = gathered(system, np.eye(system.free.size), free_columns(system), sizes=True)
    sizes: Floats = rates.T @ magnitude @ rates
    return sizes


def rotor_forcing_magnitude(
    system: SystemArrays,
    maxima: tuple[PathMaxima, ...],
    y: Numbers,
    prescribed: Numbers = UNPRESCRIBED,
) -> Floats:
    """Return the (..., n) magnitudes of what rotors add to {f}; the arguments are those of `path_maxima`."""
    rates, accelerations = (
        full_order(system, y, prescribed[..., 1, :]),
        full_order(system, np.zeros_like(y), prescribed[..., 2, :]),
    )
    magnitude = np.zeros_like(rates)
    for rotor in system.rotors:
        place, momentum, spin = spin_of(system, rotor)
        size = length(momentum)
        magnitude[..., place] += spin * np.abs(accelerations[..., place])
        if rotor.body:
            carrier = maxima[rotor.body - 1]
            spinning = np.abs(rates[..., place]) * carrier.rate + np.abs(accelerations[..., place])
            magnitude += size * spinning[..., None] * carrier.omega_y
            magnitude[..., place] += size * carrier.rate_dot
    return gathered(system, magnitude, free_columns(system), sizes=True)


def forcing_magnitude(
    system: SystemArrays, maxima: tuple[PathMaxima, ...], force: Floats | None, torque: Floats | None
) -> Floats:
    """Return the (..., n) magnitudes of the terms of {f}, Eq. (44).

    Programs that take moments of momentum about moving origins also add and cancel `v_O x m v_O`.

    Args:
        system: The numbers of the tree.
        maxima: Largest lengths on the paths to the bodies.
        force: (..., N, 3) forces on the bodies (N), or None.
        torque: (..., N, 3) torques on the bodies (N m), or None.
    """
    center_y, omega_y = _columns(system, maxima)
    acceleration = np.stack([body.center_acceleration for body in maxima], axis=-1)
    rate_dot = np.stack([body.rate_dot for body in maxima], axis=-1)
    velocity = np.stack([body.velocity for body in maxima], axis=-1)
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
    **loads: Unpack[LoadInputs],
) -> Floats:
    """Return the (..., n) magnitudes of the terms of force elements and loads on points.

    Args:
        system: The numbers of the tree.
        bodies: Kinematics of the bodies.
        x: (..., m) coordinates.
        y: (..., n) generalized speeds.
        prescribed: As in `equations.mass_matrix`.
        loads: As in `equations.forcing`.
    """
    motion = prescribed_motion(system, prescribed, x)
    speeds, free = full_order(system, y, motion[..., 1, :]), free_columns(system)
    parts = contributions(system, bodies, (x, motion[..., 0, :]), speeds, point_inputs(system, x, **loads))
    sizes = (gathered(system, part.magnitude, free, sizes=True) for part in parts)
    return sum(sizes, start=np.zeros(y.shape))


def rounding_bound(
    bodies: int, precision: Precision = DOUBLE, storage: Precision = DOUBLE, angle: float = 0.0
) -> float:
    """Return how far two programs may differ, relative to the magnitudes of the terms: 8 (N + 8 + phi) u.

    Every rotation, cross product and sum along the tree adds a few roundings, so errors grow at most
    linearly with N; the term 8 in brackets stands for sines, products and inertias within a body. The
    factor 8 in front is a product: 2, because both programs round, times 2 x 2, because a program that sums
    inward may have partial sums twice as large as the magnitudes here, which are taken outward, in both
    factors of a product. docs/accuracy.md says how the bound was tested.

    Args:
        bodies: Number of bodies N.
        precision: Precision of the program's arithmetic. u is its unit roundoff, or that of the reference,
            which computes in double, if this is larger.
        storage: Precision of the program's arrays. Fewer digits than in the arithmetic mean one more
            rounding.
        angle: Largest sum phi of the magnitudes of the terms of a coupled angle (rad), 0 without couplings.
            The angle has their rounding errors, by which vectors turn.
    """
    stored = storage.roundoff if storage.roundoff > precision.roundoff else 0.0
    return 8 * (bodies + 8 + angle) * max(precision.roundoff, DOUBLE.roundoff) + stored


def _columns(system: SystemArrays, maxima: tuple[PathMaxima, ...]) -> tuple[Floats, Floats]:
    """Return (..., N, n) largest lengths of the free columns of [v_G,y] and of [omega_y]."""
    free = free_columns(system)
    center_y = np.stack([gathered(system, body.center_y, free, sizes=True) for body in maxima], axis=-2)
    omega_y = np.stack([gathered(system, body.omega_y, free, sizes=True) for body in maxima], axis=-2)
    return center_y, omega_y


def _inertia_size(system: SystemArrays) -> Floats:
    """Return the (N,) Frobenius norms of the inertias."""
    size: Floats = np.linalg.norm(system.inertia, axis=(1, 2))
    return size


def _largest(*values: Floats) -> Floats:
    """Return the elementwise maximum of several arrays."""
    result = values[0]
    for value in values[1:]:
        result = np.maximum(result, value)
    return result
