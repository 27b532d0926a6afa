"""Joints of a body in an MJCF file, one after the other, as joints of kanegen that move it in the same way.

In MuJoCo the joints of a body move it in sequence, each in the frame that the joints before it have moved.
The placement of the body is a product of motions along and about fixed axes. Constant motions by the
reference coordinates are moved to the end of the product, so that {x} is MuJoCo's `qpos`. Neighbours in the
product that slide along and then turn about axes of one frame, through one point, are one joint of kanegen
with several freedoms; others have a body without mass between them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, permutations

from kanegen.model.coordinates import ANGLES, FREEDOMS, NOTES, ORIENTATIONS, SEQUENCES, TRANSLATIONS
from kanegen.model.rotations import (
    UNIT,
    ZERO,
    Square,
    Triple,
    apply,
    cross,
    dot,
    product,
    rotation_to_axis,
    transpose,
    turn,
)
from kanegen.readers.mjcf_compiled import MjcfJoint
from kanegen.readers.welding import Frame

Basis = tuple[Square, tuple[int, ...]]
"""The rotation to the components of a frame, and indices of its basis vectors."""

Turns = tuple[str, tuple[int, ...]]
"""The name of a sequence of axes, and the angles in it that are free."""

_ORDER = re.compile("free|(slide ?){0,3}(ball|(hinge ?){0,3})")
"""The order of joints that can be one joint of kanegen: its translations come before its rotation."""

TOLERANCE = 1e-14
"""Largest scalar product of unit vectors that counts as zero, a rounding error of several rotations."""


@dataclass(frozen=True)
class JointGroup:
    """Joints of a file that are one joint of kanegen.

    Attributes:
        joints: The joints of the file.
        frame: The joint frame, in the frame of the file's body before these joints.
        indices: Index in `FREEDOMS` of the freedom of each slide and hinge; empty for ball and free joints.
        coordinates: One of `ORIENTATIONS`.
        sequence: Name of the axes about which the angles turn.
        free: (6,) which freedoms are free.
        after: The frame of the file's body after these joints, in the frame of kanegen's body.
    """

    joints: tuple[MjcfJoint, ...]
    frame: Frame
    indices: tuple[int, ...]
    coordinates: str
    sequence: str
    free: tuple[bool, ...]
    after: Frame


def joint_groups(joints: Sequence[MjcfJoint]) -> Iterator[JointGroup]:
    """Yield the joints of a body, as many as possible together as one joint."""
    waiting = list(joints)
    while waiting:
        together = None
        for count in range(1, len(waiting) + 1):
            longer = _together(tuple(waiting[:count]))
            if longer is None:
                break
            together = longer
        assert together is not None, "one joint alone is always a group"
        yield together
        del waiting[: len(together.joints)]


def _together(joints: tuple[MjcfJoint, ...]) -> JointGroup | None:
    """Return several joints as one, or None if one joint of kanegen cannot move a body as they do."""
    if not _ORDER.fullmatch(" ".join(joint.type for joint in joints)):
        return None
    if joints[0].type == "free":
        return JointGroup(joints, Frame(), (), ORIENTATIONS[1], NOTES, (True,) * len(FREEDOMS), Frame())
    passed, axes, turning = Frame(), [], []
    for joint in joints:
        axis = ZERO if joint.type == "ball" else apply(passed.rotation, joint.axis)
        if joint.type != "slide":
            turning.append((passed.point(joint.anchor), axis))
        axes.append(axis)
        passed = passed.then(_to_reference(joint))
    center, basis = _common_point(turning), _basis([axis for axis in axes if any(axis)])
    if center is None or basis is None:
        return None
    return _along_basis(joints, center, basis, passed)


def _along_basis(
    joints: tuple[MjcfJoint, ...], center: Triple, basis: Basis, passed: Frame
) -> JointGroup | None:
    """Return slides, and hinges or a ball, along and about basis vectors of a frame as one joint.

    Args:
        joints: The joints of the file.
        center: (3,) the point about which they turn.
        basis: The rotation to the frame, and the index of its basis vector for each slide and hinge.
        passed: The constant motion by their reference coordinates.
    """
    frame, along = basis
    slides = sum(joint.type == "slide" for joint in joints)
    translations = tuple(TRANSLATIONS[i] for i in along[:slides])
    if len(set(translations)) < slides:
        return None
    if joints[-1].type == "ball":
        if frame != UNIT:
            return None
        coordinates, named = ORIENTATIONS[1], translations
        turns: Turns = NOTES, ANGLES
    else:
        found = _angles(along[slides:])
        if found is None:
            return None
        coordinates, named, turns = ORIENTATIONS[0], translations + found[1], found
    sequence, angles = turns
    free = tuple(i in translations or i in angles for i in range(len(FREEDOMS)))
    place = Frame(center, transpose(frame))
    return JointGroup(joints, place, named, coordinates, sequence, free, place.inverse().then(passed))


def _to_reference(joint: MjcfJoint) -> Frame:
    """Return the constant motion from coordinate zero of a joint to the place of the body in the file."""
    if not joint.reference or joint.type == "ball":
        return Frame()
    if joint.type == "slide":
        x, y, z = joint.axis
        return Frame((-joint.reference * x, -joint.reference * y, -joint.reference * z))
    axis, to_axis = rotation_to_axis(joint.axis)
    back = product(product(transpose(to_axis), turn(axis, joint.reference)), to_axis)
    x, y, z = apply(back, joint.anchor)
    return Frame((joint.anchor[0] - x, joint.anchor[1] - y, joint.anchor[2] - z), back)


def _common_point(turning: Sequence[tuple[Triple, Triple]]) -> Triple | None:
    """Return a point on every axis, each given by a point and a direction; the origin if there is no axis."""
    if not turning:
        return ZERO
    for center, _ in turning:
        if all(_is_on(center, point, axis) for point, axis in turning):
            return center
    return None


def _is_on(p: Triple, point: Triple, axis: Triple) -> bool:
    """Return whether `p` is on the axis through `point`, or is the point itself if there is no axis."""
    way = p[0] - point[0], p[1] - point[1], p[2] - point[2]
    off = cross(way, axis) if any(axis) else way
    size = max(map(abs, (*p, *point)))
    return max(map(abs, off)) <= TOLERANCE * size


def _basis(axes: Sequence[Triple]) -> Basis | None:
    """Return a frame whose basis vectors are the given axes, and the index of each axis among them.

    The frame is the rotation to its components, the identity where the axes allow it, else as near to it as
    they allow. None if two axes are neither the same nor orthogonal.
    """
    distinct: list[Triple] = []
    places = []
    for axis in axes:
        products = [dot(axis, other) for other in distinct]
        same = [i for i, cosine in enumerate(products) if cosine >= 1 - TOLERANCE]
        if not same and any(abs(cosine) > TOLERANCE for cosine in products):
            return None
        places.append(same[0] if same else len(distinct))
        if not same:
            distinct.append(axis)
    frame, indices = _nearest_frame(distinct)
    return frame, tuple(indices[place] for place in places)


def _nearest_frame(axes: Sequence[Triple]) -> Basis:
    """Return the rotation to a right-handed frame that has up to three orthogonal axes, and their indices."""
    if not axes:
        return UNIT, ()
    if len(axes) == 1:
        index, frame = rotation_to_axis(axes[0])
        return frame, (index,)
    if len(axes) == 3:
        right = dot(cross(axes[0], axes[1]), axes[2]) > 0
        orders = [order for order in permutations(range(3)) if _is_even(order) == right]
    else:
        orders = list(permutations(range(3)))
    order = max(orders, key=lambda order: sum(axis[i] for axis, i in zip(axes, order, strict=False)))
    first, second = axes[0], axes[1]
    third = cross(first, second)
    if not _is_even(order):
        third = -third[0], -third[1], -third[2]
    rows = dict(zip(order, (first, second, axes[2] if len(axes) == 3 else third), strict=True))
    return (rows[0], rows[1], rows[2]), tuple(order[: len(axes)])


def _is_even(order: Sequence[int]) -> bool:
    """Return whether an order of 0, 1, 2 is a cyclic one."""
    return tuple(order) in ((0, 1, 2), (1, 2, 0), (2, 0, 1))


def _angles(axes: Sequence[int]) -> Turns | None:
    """Return a sequence of axes and the angles in it that turn about `axes`, which are basis vectors.

    The sequence is that of the notes where it has them, else one of three different axes where one has them.
    None if no sequence has them, because neighbours are the same or there are more than three.
    """
    names = sorted(SEQUENCES, key=lambda name: (name != NOTES, len(set(SEQUENCES[name])) < 3))
    for name in names:
        for angles in combinations(ANGLES, len(axes)):
            if [SEQUENCES[name][angle] for angle in angles] == list(axes):
                return name, angles
    return None
