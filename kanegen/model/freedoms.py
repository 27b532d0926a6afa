"""The six freedoms between a body and its lower body, and what stands for them in {x} and {y}."""

from __future__ import annotations

from collections.abc import Iterable

FREEDOMS = ("theta1", "theta2", "theta3", "s1", "s2", "s3")
"""The six relative freedoms of a body, in the order of `Joint.free`: angles in rad, translations in m."""

SPEEDS = ("angle_rates", "angular_velocity")
"""What the speeds of a joint's angles can be: their rates, or the relative angular velocity in the body."""

ORIENTATIONS = ("angles", "quaternion")
"""The coordinates that turn a body: angles, locked or free, or four that hold no singularity."""

QUATERNION = ("e0", "e1", "e2", "e3")
"""The Euler parameters: a scalar and a vector in the joint frame, of any common length but 0."""


def named(flags: Iterable[bool]) -> tuple[str, ...]:
    """Those of `FREEDOMS` whose flags are set."""
    return tuple(name for name, flag in zip(FREEDOMS, flags, strict=True) if flag)
