"""Shapes of a body that has no geometry: its inertia ellipsoid, lines between its joints, and the joints.

Lengths of markers follow the lengths of the body and its neighbours, so that a watch and a crane look alike.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kanegen.model.arrays import Floats, SystemArrays
from kanegen.model.coordinates import FREEDOMS
from kanegen.model.system import System
from kanegen.viewer.ellipsoids import equivalent_ellipsoid
from kanegen.viewer.joints import hinge_axis
from kanegen.viewer.scene import IDENTITY, Shape, floats, rows

PALETTE = (
    *("#4e79a7", "#f28e2b", "#59a14f", "#e15759", "#76b7b2", "#edc948", "#b07aa1", "#ff9da7", "#9c755f"),
    "#86bcb6",
)
"""Colours of bodies, in turn."""

JOINT = "#3c4654"
"""Colour of joints."""

RAIL = "#8a94a3"
"""Colour of the lines along which bodies slide."""


class Skeleton:
    """The lengths of a tree, and the shapes by which its bodies are drawn.

    Attributes:
        size: A length (m) that no part of the tree exceeds from the ground by much; 1 where it has none.
    """

    def __init__(self, system: System, arrays: SystemArrays) -> None:
        self._system, self._arrays = system, arrays
        self._ellipsoids = [
            equivalent_ellipsoid(*one) for one in zip(arrays.mass, arrays.inertia, strict=True)
        ]
        reach = [0.0]
        for k, lower in enumerate(arrays.connection):
            reach.append(reach[lower] + float(np.linalg.norm(arrays.joint_position[k])) + self._stroke(k))
        own = [
            along + float(np.linalg.norm(arrays.mass_center[k])) + self._largest_axis(k)
            for k, along in enumerate(reach[1:])
        ]
        self.size = max(own, default=0.0) or 1.0

    def color(self, k: int) -> str:
        """Return the colour of body K, from 1; 0 is the ground."""
        return PALETTE[(k - 1) % len(PALETTE)] if k else "#9aa3af"

    def shapes(self, k: int) -> Iterator[Shape]:
        """Yield the shapes of body K, from 1, or of the ground, 0."""
        if k:
            yield from self._inertia(k)
            yield from self._marker(k)
        yield from self._links(k)
        yield from self._rails(k)

    def ranges(self, k: int) -> list[tuple[float, float]]:
        """Return (6,) the ranges of the freedoms of body K, from 1, for its sliders (rad, m)."""
        limits = self._system.bodies[k - 1].joint.limits
        widest = [np.pi] * 3 + [0.5 * self.size] * 3
        return [
            (
                lower if np.isfinite(lower) else min(-width, upper - width if np.isfinite(upper) else -width),
                upper if np.isfinite(upper) else max(width, lower + width if np.isfinite(lower) else width),
            )
            for lower, upper, width in zip(limits.lower, limits.upper, widest, strict=True)
        ]

    def _stroke(self, k: int) -> float:
        """Return how far a body, by its index from 0, slides at the most (m)."""
        joint, total = self._system.bodies[k].joint, 0.0
        for index in range(3, len(FREEDOMS)):
            ends = (joint.limits.lower[index], joint.limits.upper[index])
            finite = [abs(end) for end in ends if np.isfinite(end)]
            total += max(finite, default=0.0) if joint.moving[index] else abs(self._arrays.locked[k, index])
        return float(total)

    def _largest_axis(self, k: int) -> float:
        """Return the largest semi-axis of the ellipsoid of a body by its index from 0 (m)."""
        found = self._ellipsoids[k]
        return float(found[0].max()) if found else 0.0

    def _children(self, k: int) -> list[int]:
        """Return the numbers of the bodies on body K."""
        return [number for number, lower in enumerate(self._arrays.connection, start=1) if lower == k]

    def _thickness(self, k: int) -> float:
        """Return the radius of joints and lines of body K (m)."""
        if not k:
            return 0.012 * self.size
        lengths = [
            float(np.linalg.norm(self._arrays.joint_position[child - 1])) for child in self._children(k)
        ]
        lengths += [float(np.linalg.norm(self._arrays.mass_center[k - 1])), self._largest_axis(k - 1)]
        return min(0.1 * max(lengths), 0.02 * self.size) or 0.01 * self.size

    def _inertia(self, k: int) -> Iterator[Shape]:
        """Yield the inertia ellipsoid of body K, or a ball for a point mass."""
        center, color = floats(self._arrays.mass_center[k - 1]), self.color(k)
        found = self._ellipsoids[k - 1]
        if found:
            yield Shape("ellipsoid", "inertia", floats(found[0]), center, rows(found[1]), color)
        elif self._arrays.mass[k - 1] > 0:
            radius = max(0.035 * self.size, 1.8 * self._thickness(k))
            yield Shape("sphere", "inertia", [radius], center, IDENTITY, color)

    def _links(self, k: int) -> Iterator[Shape]:
        """Yield the lines from the origin of body K to its mass centre and to the joints on it."""
        ends = [self._arrays.joint_position[child - 1] for child in self._children(k)] if k else []
        if k and self._arrays.mass[k - 1] > 0:
            ends.append(self._arrays.mass_center[k - 1])
        for end in ends:
            yield from self._rod(np.zeros(3), end, 0.45 * self._thickness(k), self.color(k), "link")

    def _rod(self, start: Floats, end: Floats, radius: float, color: str, role: str) -> Iterator[Shape]:
        """Yield the line between two points of a body, nothing where they meet."""
        length = float(np.linalg.norm(end - start))
        if length > 1e-6 * self.size:
            rotation = rows(_along((end - start) / length))
            middle = floats((start + end) / 2)
            yield Shape(
                "rod", "link" if role == "link" else "joint", [radius, length], middle, rotation, color
            )

    def _marker(self, k: int) -> Iterator[Shape]:
        """Yield what stands for the joint of body K: a cylinder about a hinge, a ball, or a box."""
        joint = self._system.bodies[k - 1].joint
        radius = self._thickness(k)
        axis = hinge_axis(self._system, self._arrays, k)
        origin = [0.0, 0.0, 0.0]
        slides = any(joint.moving[3:])
        if axis is not None:
            yield Shape("cylinder", "joint", [radius, 3.2 * radius], origin, rows(_along(axis)), JOINT)
        elif any(joint.moving[:3]) and not all(joint.moving):
            yield Shape("sphere", "joint", [1.3 * radius], origin, IDENTITY, JOINT)
        elif slides and not any(joint.moving[:3]):
            yield Shape("box", "joint", [2.4 * radius] * 3, origin, IDENTITY, JOINT)

    def _rails(self, k: int) -> Iterator[Shape]:
        """Yield the lines along which bodies on body K slide, unless they move in all directions."""
        for child in self._children(k):
            joint = self._system.bodies[child - 1].joint
            directions = [index for index in range(3, len(FREEDOMS)) if joint.moving[index]]
            if len(directions) != 1:
                continue
            (index,) = directions
            axis = self._arrays.joint_orientation[child - 1].T[:, index - 3]
            start = self._arrays.joint_position[child - 1]
            limits = (joint.limits.lower[index], joint.limits.upper[index])
            lower, upper = limits if np.isfinite(limits).all() else (-0.25 * self.size, 0.25 * self.size)
            radius = 0.35 * self._thickness(child)
            yield from self._rod(start + lower * axis, start + upper * axis, radius, RAIL, "joint")


def _along(direction: Floats) -> Floats:
    """Return a (3, 3) rotation whose third column is a unit vector."""
    other = np.eye(3)[int(np.argmin(np.abs(direction)))]
    first = np.cross(other, direction)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(direction, first), direction], axis=1)
