"""Linear maps of motions and of inertial parameters through placements and single joints, and linear spans.

A motion is an angular velocity and the velocity of the origin of a frame. The ten inertial parameters of a
body pass from an upper to a lower frame by a matrix, which is the exponential of a generator times the
coordinate for a hinge or a slide: a generator of a hinge has the eigenvalues 0, +-i, +-2i, that of a slide
only 0. So what a joint does to a linear form of the parameters, in all its positions, follows from powers of
the generator alone.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kanegen.model.arrays import Floats
from kanegen.model.identification.inertial_parameters import UPPER
from kanegen.model.identification.single_joints import Placement, SingleJoint

SAME = 1e-10
"""Length below which a vector is zero, in units of those it is made from: far more than the rounding of
lengths and directions in a model file, far less than a drawing or a calibration distinguishes."""


def parameters_inward(placement: Placement) -> Floats:
    """Return the (10, 10) matrix that takes inertial parameters of the upper frame to the lower one."""
    turn, p = placement.rotation.T, placement.position
    columns = []
    for unit in np.eye(10):
        mass, moment, inertia = _unpacked(unit)
        h = turn @ moment
        shifted = turn @ inertia @ turn.T + _shift(h, p) + _shift(mass * p, p) / 2
        columns.append(_packed(mass, h + mass * p, shifted))
    return np.stack(columns, axis=1)


def generator(joint: SingleJoint) -> Floats:
    """Return the (10, 10) derivative of `parameters_inward` by the coordinate of a joint, at its zero."""
    axis = np.eye(3)[joint.axis]
    columns = []
    for unit in np.eye(10):
        mass, moment, inertia = _unpacked(unit)
        if joint.is_hinge:
            tilde = np.cross(axis, np.eye(3)).T
            columns.append(_packed(0.0, np.cross(axis, moment), tilde @ inertia - inertia @ tilde))
        else:
            columns.append(_packed(0.0, mass * axis, _shift(moment, axis)))
    return np.stack(columns, axis=1)


def mean_forms(forms: Floats, joint: SingleJoint) -> Floats:
    """Return the part of (r, 10) linear forms below a joint that does not depend on its coordinate, above it.

    It is the mean over all angles for a hinge, and the value at zero for a slide.
    """
    if not joint.is_hinge:
        return forms
    square = np.linalg.matrix_power(generator(joint), 2)
    one = np.eye(10)
    found: Floats = forms @ (square + one) @ (square + 4 * one) / 4
    return found


def changing_forms(forms: Floats, joint: SingleJoint) -> Floats:
    """Return a basis of what the coordinate of a joint adds to (r, 10) linear forms below it, above it."""
    changes, power = [], forms
    for _ in range(4 if joint.is_hinge else 2):
        power = power @ generator(joint)
        changes.append(power)
    return span(np.concatenate(changes))


def motions_outward(motions: Floats, placement: Placement) -> Floats:
    """Return (r, 6) motions of a lower frame as motions of the upper one, which is fixed to it."""
    omega, velocity = motions[:, :3], motions[:, 3:]
    moved = velocity + np.cross(omega, placement.position)
    found: Floats = np.concatenate([omega @ placement.rotation.T, moved @ placement.rotation.T], axis=1)
    return found


def reached_motions(motions: Floats, joint: SingleJoint) -> Floats:
    """Return a basis of the motions above a joint, in all its positions, for (r, 6) motions below it."""
    found, power = [motions, joint.motion[None]], motions
    for _ in range(3):
        power = commuted(joint.motion, power)
        found.append(power)
    return span(np.concatenate(found))


def commuted(motion: Floats, others: Floats) -> Floats:
    """Return the derivatives of (r, 6) other motions, seen above a joint, by its coordinate."""
    omega, velocity = motion[:3], motion[3:]
    turned = np.cross(others[:, :3], omega)
    found: Floats = np.concatenate(
        [turned, np.cross(others[:, 3:], omega) + np.cross(others[:, :3], velocity)], axis=1
    )
    return found


def energy_forms(motions: Floats, others: Floats) -> Floats:
    """Return the (r, 10) linear forms of inertial parameters that pair (r, 6) motions with others.

    A form has the value {v}^T {P} + {omega}^T {L}, with linear and angular momentum by the other motion.

    Args:
        motions: (r, 6) motions.
        others: (r, 6) others, one for each, or (6,) one for all.
    """
    omega, v = motions[:, :3], motions[:, 3:]
    w, velocity = others[..., :3], others[..., 3:]
    first = np.cross(v, w) + np.cross(velocity, omega)
    second = [omega[:, i] * w[..., j] + (omega[:, j] * w[..., i] if i != j else 0.0) for i, j in UPPER]
    found: Floats = np.column_stack([(v * velocity).sum(axis=1), first, *second])
    return found


def span(rows: Floats) -> Floats:
    """Return an orthonormal basis of the span of some rows of length about 1, as rows."""
    if not len(rows):
        return rows
    _, sizes, basis = np.linalg.svd(rows, full_matrices=False)
    found: Floats = basis[sizes > SAME]
    return found


def reduced(rows: Floats, order: Sequence[int]) -> tuple[list[int], Floats]:
    """Return columns in which independent rows can be made the identity, and the rows made so.

    Args:
        rows: (r, n) independent rows of length about 1.
        order: Columns in the order in which they are preferred; a preferred one is left out where its part
            that does not depend on those before it is small.
    """
    chosen: list[int] = []
    rest = rows.copy()
    for least in (0.1, 1e-3, 1e-6, 0.0):
        for column in order:
            size = np.linalg.norm(rest[:, column])
            if len(chosen) < len(rows) and column not in chosen and size > max(least, SAME):
                direction = rest[:, column] / size
                rest = rest - np.outer(direction, direction @ rest)
                chosen.append(column)
    chosen.sort()
    found = np.linalg.solve(rows[:, chosen], rows)
    found[:, chosen] = np.eye(len(chosen))
    return chosen, np.where(np.abs(found) < SAME, 0.0, found)


def _unpacked(parameters: Floats) -> tuple[float, Floats, Floats]:
    """Return mass, first moment and inertia of ten inertial parameters."""
    inertia = np.zeros((3, 3))
    for (i, j), value in zip(UPPER, parameters[4:], strict=True):
        inertia[i, j] = inertia[j, i] = value
    return float(parameters[0]), parameters[1:4], inertia


def _packed(mass: float, moment: Floats, inertia: Floats) -> Floats:
    """Return the ten inertial parameters."""
    return np.array([mass, *moment, *(inertia[place] for place in UPPER)])


def _shift(h: Floats, p: Floats) -> Floats:
    """Return 2 {h}.{p} [1] - {h}{p}^T - {p}{h}^T, which a shift by {p} adds to the inertia."""
    found: Floats = 2 * (h @ p) * np.eye(3) - np.outer(h, p) - np.outer(p, h)
    return found
