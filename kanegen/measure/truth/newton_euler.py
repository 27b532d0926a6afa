"""Second algorithm: Newton and Euler, in the frames of the bodies, outward and back inward.

The generalized forces that accelerations need are found for many columns of accelerations at once. [A] has
those of unit accelerations without speed, gravity and loads; {f} those of no acceleration, with its sign
changed. Rotations and angle rates come from the written-out Eqs. (4) and (17), under other names where the
sequence is not 1-2-3.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from kanegen.measure.truth.balls import arb, arb_mat, column, cross, identity, skew, square, stacked, zeros
from kanegen.measure.truth.tree import Link, Tree
from kanegen.reference.matrices import renaming


@dataclass(frozen=True)
class Motion:
    """A body's motion, in its own components; accelerations are those less gravity, one column each."""

    rotation: arb_mat
    rate_matrix: arb_mat
    arm: arb_mat
    omega: arb_mat
    alpha: arb_mat
    acceleration: arb_mat


def inverse_dynamics(tree: Tree, ydot: arb_mat) -> arb_mat:
    """[A]{ydot} - {f} for every column of `ydot` (n, m): (n, m)."""
    return _required(tree, ydot, moving=True)


def mass_matrix(tree: Tree) -> arb_mat:
    """(n, n) [A], column by column."""
    return _required(tree, identity(tree.freedoms), moving=False)


def forcing(tree: Tree) -> arb_mat:
    """(n, 1) {f}."""
    return -inverse_dynamics(tree, zeros(tree.freedoms, 1))


def _required(tree: Tree, ydot: arb_mat, moving: bool) -> arb_mat:
    """Generalized forces; where not `moving`, as if there were no speeds, no gravity and no loads."""
    m = ydot.ncols()
    weight = _repeated(-tree.gravity, m) if moving else zeros(3, m)
    still = zeros(3, 1)
    motions = [Motion(identity(3), identity(3), still, still, zeros(3, m), weight)]
    for link in tree.links:
        motions.append(_motion(link, motions[link.lower], ydot, moving))
    forces, moments = [zeros(3, m) for _ in motions], [zeros(3, m) for _ in motions]
    rows = [zeros(1, m) for _ in range(tree.freedoms)]
    for k in range(len(tree.links), 0, -1):
        link, motion = tree.links[k - 1], motions[k]
        own_force, own_moment = _effort(link, motion, moving)
        force, moment = forces[k] + own_force, moments[k] + own_moment
        passed = motion.rotation.transpose() * force
        needed = stacked([motion.rate_matrix.transpose() * moment, link.orientation * passed])
        for index, place in enumerate(link.places):
            if place is not None:
                rows[place] = _row(needed, index)
        forces[link.lower] += passed
        moments[link.lower] += motion.rotation.transpose() * moment + cross(motion.arm, passed)
    return stacked(rows)


def _motion(link: Link, lower: Motion, ydot: arb_mat, moving: bool) -> Motion:
    """Outward: from the motion of the lower body to that of body K."""
    rotate, rates, rates_dot = _turning(link)
    to_lower = link.orientation.transpose()
    angles_ddot, translation_ddot = _chosen(ydot, link.places[:3]), _chosen(ydot, link.places[3:])
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
    """Force, and moment about O_K, that move body K, less its loads."""
    omega, m = motion.omega, motion.alpha.ncols()
    center_acceleration = motion.acceleration - skew(link.center) * motion.alpha
    spin = link.inertia * motion.alpha
    if moving:
        center_acceleration += _repeated(cross(omega, cross(omega, link.center)), m)
        spin += _repeated(cross(omega, link.inertia * omega) - link.torque, m)
    force = center_acceleration * link.mass
    if moving:
        force -= _repeated(link.force, m)
    return force, spin + cross(link.center, force)


def _turning(link: Link) -> tuple[arb_mat, arb_mat, arb_mat]:
    """[R_123] of Eq. (4), [P^AV] of Eq. (17), and its rate at the link's speeds.

    Where the speeds are components of the relative angular velocity, [P^AV] is the identity.
    """
    if link.quaternion is not None:
        return _rotation(link.quaternion), identity(3), zeros(3, 3)
    named = renaming(link.axes)
    (s1, c1), (s2, c2), (s3, c3) = (
        ((sine * named.sign), cosine) for sine, cosine in (angle.sin_cos() for angle in link.angles.entries())
    )
    if named.ends_alike:
        s2, c2 = c2, -s2
    _, d2, d3 = (rate * named.sign for rate in link.rates.entries())
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
    after = square(named.after)
    if not link.speeds_are_rates:
        return after * rotate * square(named.before), identity(3), zeros(3, 3)
    return after * rotate * square(named.before), after * rates, after * rates_dot


def _rotation(quaternion: arb_mat) -> arb_mat:
    """What turns components by a quaternion (4, 1) of any length but 0, after Rodrigues."""
    scalar, one, two, three = quaternion.entries()
    across = skew(column([one, two, three]))
    squared = scalar * scalar + one * one + two * two + three * three
    return identity(3) + (across * across - across * scalar) * (2 / squared)


def _chosen(ydot: arb_mat, places: Sequence[int | None]) -> arb_mat:
    """(3, m) rows of `ydot`, zeros where a freedom is locked."""
    return stacked([zeros(1, ydot.ncols()) if place is None else _row(ydot, place) for place in places])


def _row(matrix: arb_mat, index: int) -> arb_mat:
    m = matrix.ncols()
    return arb_mat(1, m, [matrix[index, j] for j in range(m)])


def _repeated(vector: arb_mat, m: int) -> arb_mat:
    """(3, m) with `vector` in every column."""
    return vector * arb_mat(1, m, [1] * m)
