"""Names of components of vectors, as they stand behind the name of a quantity: `point_positions.tip.z`."""

from __future__ import annotations

AXES = ("x", "y", "z")
"""The inertial axes."""

_PARTS = ("linear", "angular")


def linear_first() -> tuple[str, ...]:
    """Return the names of six components, the linear ones first, as in a momentum.

    Example:
        linear_first()[3]  # "angular.x"
    """
    return tuple(f"{part}.{axis}" for part in _PARTS for axis in AXES)


def angular_first() -> tuple[str, ...]:
    """Return the names of six components, the angular ones first, as in the velocity of a frame.

    Example:
        angular_first()[3]  # "linear.x"
    """
    return tuple(f"{part}.{axis}" for part in reversed(_PARTS) for axis in AXES)


def vector_components(count: int) -> tuple[str, ...]:
    """Return the names of three components of a vector, or of six of a momentum.

    Example:
        vector_components(3)  # ("x", "y", "z")
    """
    return AXES if count == len(AXES) else linear_first()
