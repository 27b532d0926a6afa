"""Frames and masses that are fixed in one another, and the one rigid body that they make."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from kanegen.model.rotations import UNIT, ZERO, Square, Triple, apply, dot, product, similar


@dataclass(frozen=True)
class Frame:
    """Where a frame stands in an outer one.

    Attributes:
        position: Its origin, in outer components (m).
        rotation: From its own components to outer ones.
    """

    position: Triple = ZERO
    rotation: Square = UNIT

    def point(self, p: Triple) -> Triple:
        """A point's outer coordinates from its own ones."""
        return _sum(self.position, apply(self.rotation, p))

    def then(self, inner: Frame) -> Frame:
        """Where a frame inside this one stands in the outer one."""
        return Frame(self.point(inner.position), product(self.rotation, inner.rotation))


@dataclass(frozen=True)
class Rigid:
    """Mass (kg), mass centre (m) and inertia about it (kg m^2), in some frame."""

    mass: float = 0.0
    center: Triple = ZERO
    inertia: Square = (ZERO, ZERO, ZERO)

    def seen_from(self, frame: Frame) -> Rigid:
        """The same, in the components of the frame in which `frame` says where this one stands."""
        return Rigid(self.mass, frame.point(self.center), similar(frame.rotation, self.inertia))


def lump(parts: Sequence[Rigid]) -> Rigid:
    """One rigid body from parts in one frame.

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
    total: Square = (ZERO, ZERO, ZERO)
    for tensor in tensors:
        total = _sum(total[0], tensor[0]), _sum(total[1], tensor[1]), _sum(total[2], tensor[2])
    return total


def _sum(a: Triple, b: Triple) -> Triple:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _difference(a: Triple, b: Triple) -> Triple:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]
