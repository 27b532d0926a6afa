"""Second algorithm: Newton and Euler, in the frames of the bodies, outward and back inward.

The generalized forces that accelerations require are computed for many columns of accelerations at once. The
columns of [A] are the forces of unit accelerations without speeds, gravity and loads; {f} is the negative of
the forces that no acceleration requires. Rotations and angle rates come from the written-out Eqs. (4) and
(17); any other sequence of axes is 1-2-3 in a frame whose basis vectors have other names (`Renaming`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Self

from kanegen.measure.truth.balls import (
    arb,
    arb_mat,
    column,
    cross,
    identity,
    skew,
    square,
    stacked,
    unit,
    zeros,
)
from kanegen.measure.truth.tree import Link, Tree
from kanegen.model.coordinates import Axes


@dataclass(frozen=True)
class Motion:
    """The motion of body K, in its own components, for m columns of accelerations.

    Attributes:
        rotation: (3, 3) rotation from the components of the lower body.
        rate_matrix: (3, 3) angle-rate matrix [P_K^AV].
        arm: (3, 1) vector from the lower body's origin to O_K, in the lower body.
        omega: (3, 1) angular velocity.
        alpha: (3, m) angular accelerations.
        acceleration: (3, m) accelerations of O_K less gravity.
    """

    rotation: arb_mat
    rate_matrix: arb_mat
    arm: arb_mat
    omega: arb_mat
    alpha: arb_mat
    acceleration: arb_mat


@dataclass(frozen=True)
class Renaming:
    """The map from the sequence of axes 1-2-3 to another sequence.

    Axes a-b-c are 1-2-3 in a frame whose basis vectors have other names; where this frame is left-handed, the
    angles count the other way round. A sequence a-b-a ends with a turn about a, which is a turn about the
    third axis between two quarter turns about b: the first of these adds to the middle angle, the second is
    part of `after`.

    Attributes:
        before: (3, 3) from joint-frame components to those of the other names.
        after: (3, 3) back to components of body K.
        sign: Sign of the angles, 1 or -1.
        is_proper_euler: Whether the last axis is the first.
    """

    before: arb_mat
    after: arb_mat
    sign: int
    is_proper_euler: bool

    @classmethod
    def of(cls, axes: Axes) -> Self:
        """Return the renaming of a sequence of axes."""
        first, second, last = axes
        names = stacked([unit(axis).transpose() for axis in (first, second, 3 - first - second)])
        after = names.transpose()
        if last == first:
            after = after * square([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
        return cls(names, after, 1 if second == (first + 1) % 3 else -1, last == first)


def inverse_dynamics(tree: Tree, ydot: arb_mat) -> arb_mat:
    """Return the (n, m) forces [A]{ydot} - {f} for every column of `ydot` (n, m)."""
    return _required_forces(tree, ydot, moving=True)


def mass_matrix(tree: Tree) -> arb_mat:
    """Return the (n, n) mass matrix [A]."""
    return _required_forces(tree, identity(tree.freedoms), moving=False)


def forcing(tree: Tree) -> arb_mat:
    """Return the (n, 1) forcing {f}."""
    return -inverse_dynamics(tree, zeros(tree.freedoms, 1))


def _required_forces(tree: Tree, ydot: arb_mat, moving: bool) -> arb_mat:
    """Return the (n, m) generalized forces that accelerations require.

    Args:
        tree: The tree in its state.
        ydot: (n, m) columns of accelerations.
        moving: Whether speeds, gravity and loads count.
    """
    m = ydot.ncols()
    weight = _repeated(-tree.gravity, m) if moving else zeros(3, m)
    still = zeros(3, 1)
    motions = [Motion(identity(3), identity(3), still, still, zeros(3, m), weight)]
    for link in tree.links:
        motions.append(_motion(link, motions[link.lower], ydot, moving))
    forces, moments = [zeros(3, m) for _ in motions], [zeros(3, m) for _ in motions]
    rows = [zeros(1, m) for _ in range(tree.freedoms)]
    for spin in tree.spins:
        carrier, spinning = motions[spin.carrier], _rows(ydot, [spin.shares]) * spin.ratio
        about_axis = (spin.axis.transpose() * carrier.alpha + spinning) * (spin.inertia * spin.ratio)
        for place, share in spin.shares.items():
            rows[place] = rows[place] + about_axis * share
        moments[spin.carrier] += spin.axis * spinning * spin.inertia
        if moving:
            rate = sum((tree.speeds[i, 0] * share for i, share in spin.shares.items()), arb(0))
            momentum = spin.axis * (rate * spin.ratio * spin.inertia)
            moments[spin.carrier] += _repeated(cross(carrier.omega, momentum), m)
    for k in range(len(tree.links), 0, -1):
        link, motion = tree.links[k - 1], motions[k]
        own_force, own_moment = _effort(link, motion, moving)
        force, moment = forces[k] + own_force, moments[k] + own_moment
        passed = motion.rotation.transpose() * force
        needed = stacked([motion.rate_matrix.transpose() * moment, link.orientation * passed])
        for index, shares in enumerate(link.shares):
            moved = _rows(ydot, [shares])
            for place, share in shares.items():
                rows[place] = rows[place] + (_row(needed, index) + moved * link.armature[index]) * share
        forces[link.lower] += passed
        moments[link.lower] += motion.rotation.transpose() * moment + cross(motion.arm, passed)
    return stacked(rows)


def _motion(link: Link, lower: Motion, ydot: arb_mat, moving: bool) -> Motion:
    """Return the motion of body K from that of its lower body."""
    rotate, rates, rates_dot = _rotation_and_rates(link)
    to_lower = link.orientation.transpose()
    angles_ddot, translation_ddot = _rows(ydot, link.shares[:3]), _rows(ydot, link.shares[3:])
    rotation, arm = rotate * link.orientation, link.position + to_lower * link.translation
    carried = rotation * lower.omega
    relative = rates * link.rates if moving else zeros(3, 1)
    slide = to_lower * link.translation_rates if moving else zeros(3, 1)
    alpha = rotation * lower.alpha + rates * angles_ddot
    acceleration = lower.acceleration - skew(arm) * lower.alpha + to_lower * translation_ddot
    if moving:
        m = ydot.ncols()
        alpha += _repeated(rates_dot * link.rates + cross(carried, relative), m)
        centripetal = cross(lower.omega, cross(lower.omega, arm) + slide * arb(2))
        acceleration += _repeated(centripetal, m)
    return Motion(rotation, rates, arm, carried + relative, alpha, rotation * acceleration)


def _effort(link: Link, motion: Motion, moving: bool) -> tuple[arb_mat, arb_mat]:
    """Return the (3, m) forces and moments about O_K that move body K, less its loads."""
    omega, m = motion.omega, motion.alpha.ncols()
    center_acceleration = motion.acceleration - skew(link.center) * motion.alpha
    moment = link.inertia * motion.alpha
    if moving:
        center_acceleration += _repeated(cross(omega, cross(omega, link.center)), m)
        moment += _repeated(cross(omega, link.inertia * omega) - link.torque, m)
    force = center_acceleration * link.mass
    if moving:
        force -= _repeated(link.force, m)
    return force, moment + cross(link.center, force)


def _rotation_and_rates(link: Link) -> tuple[arb_mat, arb_mat, arb_mat]:
    """Return (3, 3) matrices of the joint: its rotation, [P_K^AV], and the time derivative of [P_K^AV].

    They are Eqs. (4) and (17) for angles. Where the speeds are components of the relative angular velocity,
    [P_K^AV] is the identity.
    """
    if link.quaternion is not None:
        return _rotation_by_quaternion(link.quaternion), identity(3), zeros(3, 3)
    renaming = Renaming.of(link.axes)
    (s1, c1), (s2, c2), (s3, c3) = (
        ((sine * renaming.sign), cosine)
        for sine, cosine in (angle.sin_cos() for angle in link.angles.entries())
    )
    if renaming.is_proper_euler:
        s2, c2 = c2, -s2
    _, d2, d3 = (rate * renaming.sign for rate in link.rates.entries())
    rotate = square(
        [
            [c2 * c3, c1 * s3 + s1 * s2 * c3, s1 * s3 - c1 * s2 * c3],
            [-c2 * s3, c1 * c3 - s1 * s2 * s3, s1 * c3 + c1 * s2 * s3],
            [s2, -s1 * c2, c1 * c2],
        ]
    )
    rates = square([[c2 * c3, s3, 0.0], [-c2 * s3, c3, 0.0], [s2, 0.0, 1.0]])
    rates_dot = square(
        [
            [-s2 * c3 * d2 - c2 * s3 * d3, c3 * d3, 0.0],
            [s2 * s3 * d2 - c2 * c3 * d3, -s3 * d3, 0.0],
            [c2 * d2, 0.0, 0.0],
        ]
    )
    rotate = renaming.after * rotate * renaming.before
    if not link.speeds_are_rates:
        return rotate, identity(3), zeros(3, 3)
    return rotate, renaming.after * rates, renaming.after * rates_dot


def _rotation_by_quaternion(quaternion: arb_mat) -> arb_mat:
    """Return the (3, 3) rotation by a (4, 1) quaternion of any length but 0, after Rodrigues."""
    scalar, one, two, three = quaternion.entries()
    across = skew(column([one, two, three]))
    squared = scalar * scalar + one * one + two * two + three * three
    return identity(3) + (across * across - across * scalar) * (2 / squared)


def _rows(ydot: arb_mat, freedoms: Sequence[Mapping[int, arb]]) -> arb_mat:
    """Return (3, m) accelerations of three freedoms: sums of rows of `ydot`, zeros where one is locked."""
    found = []
    for shares in freedoms:
        total = zeros(1, ydot.ncols())
        for place, share in shares.items():
            total = total + _row(ydot, place) * share
        found.append(total)
    return stacked(found)


def _row(matrix: arb_mat, index: int) -> arb_mat:
    """Return one row as a (1, m) matrix."""
    m = matrix.ncols()
    return arb_mat(1, m, [matrix[index, j] for j in range(m)])


def _repeated(vector: arb_mat, m: int) -> arb_mat:
    """Return the (3, m) matrix with a (3, 1) vector in every column."""
    return vector * arb_mat(1, m, [1] * m)
