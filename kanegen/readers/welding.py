"""Welding: rigid parts with fixed positions relative to each other, and the one rigid body that they form."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from kanegen.model.rotations import UNIT, ZERO, Square, Triple, apply, dot, product, similar, transpose


@dataclass(frozen=True)
class Frame:
    """A frame inside an outer frame.

    Attributes:
        position: (3,) origin of the frame, in outer components (m).
        rotation: (3, 3) rotation from components of the frame to outer components.
    """

    position: Triple = ZERO
    rotation: Square = UNIT

    def point(self, p: Triple) -> Triple:
        """Return the outer coordinates of a point `p` that is given in this frame (m)."""
        return _sum(self.position, apply(self.rotation, p))

    def inverse(self) -> Frame:
        """Return the outer frame as a frame inside this one."""
        back = transpose(self.rotation)
        x, y, z = apply(back, self.position)
        return Frame((-x, -y, -z), back)

    def then(self, inner: Frame) -> Frame:
        """Return a frame `inner` inside this one as a frame inside the outer one."""
        return Frame(self.point(inner.position), product(self.rotation, inner.rotation))


@dataclass(frozen=True)
class Rigid:
    """Mass properties of a rigid part in some frame.

    Attributes:
        mass: Mass (kg).
        center: (3,) mass centre (m).
        inertia: (3, 3) inertia about the mass centre (kg m^2).
    """

    mass: float = 0.0
    center: Triple = ZERO
    inertia: Square = (ZERO, ZERO, ZERO)

    def resolved_in(self, frame: Frame) -> Rigid:
        """Return the same part in outer components; `frame` is the frame of the part in the outer frame."""
        return Rigid(self.mass, frame.point(self.center), similar(frame.rotation, self.inertia))


def weld(parts: Sequence[Rigid]) -> Rigid:
    """Return the rigid body that parts in one frame form.

    A single part that has mass keeps its centre and inertia to the last bit.
    """
    heavy = [part for part in parts if part.mass]
    if not heavy:
        return Rigid(inertia=_total([part.inertia for part in parts]))
    mass = sum(part.mass for part in heavy)
    center = first = heavy[0].center
    for part in heavy:
        x, y, z = _difference(part.center, first)
        share = part.mass / mass
        center = _sum(center, (share * x, share * y, share * z))
    shifted = [_parallel_axis(part.mass, _difference(part.center, center)) for part in heavy]
    return Rigid(mass, center, _total([part.inertia for part in parts] + shifted))


def _parallel_axis(mass: float, d: Triple) -> Square:
    """Return m (d.d [1] - {d} {d}^T): the inertia of a point mass displaced by d."""

    def row(i: int) -> Triple:
        return (
            mass * (dot(d, d) * UNIT[i][0] - d[i] * d[0]),
            mass * (dot(d, d) * UNIT[i][1] - d[i] * d[1]),
            mass * (dot(d, d) * UNIT[i][2] - d[i] * d[2]),
        )

    return row(0), row(1), row(2)


def _total(tensors: Sequence[Square]) -> Square:
    """Return the sum of tensors."""
    total: Square = (ZERO, ZERO, ZERO)
    for tensor in tensors:
        total = _sum(total[0], tensor[0]), _sum(total[1], tensor[1]), _sum(total[2], tensor[2])
    return total


def _sum(a: Triple, b: Triple) -> Triple:
    """Return the sum of two vectors."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _difference(a: Triple, b: Triple) -> Triple:
    """Return the difference of two vectors."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]
