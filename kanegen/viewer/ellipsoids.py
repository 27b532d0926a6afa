"""Inertia as a picture: the ellipsoid of uniform density with the mass and the inertia of a body.

An ellipsoid of mass m with semi-axes a, b, c has the principal moments m (b^2 + c^2) / 5 and so on, thus
a^2 = 5 (I_2 + I_3 - I_1) / (2 m) (Goldstein, Poole and Safko, Classical Mechanics, section 5.5).
"""

from __future__ import annotations

import numpy as np

from kanegen.model.arrays import Floats

THINNEST = 0.04
"""Smallest semi-axis that is drawn, relative to the largest of the same body, so that rods and plates
show."""


def equivalent_ellipsoid(mass: float, inertia: Floats) -> tuple[Floats, Floats] | None:
    """Return the semi-axes and the axes of the uniform ellipsoid with the inertia of a body.

    Args:
        mass: Mass (kg).
        inertia: (3, 3) inertia about the mass centre, body components (kg m^2).

    Returns:
        (3,) semi-axes (m), and (3, 3) matrix whose columns are their directions in body components, right
        handed; None for a body without mass or without extent.

    Example:
        semi_axes, axes = equivalent_ellipsoid(2.0, np.diag([0.1, 0.1, 0.02]))
    """
    if mass <= 0.0:
        return None
    moments, axes = np.linalg.eigh(inertia)
    squares = 2.5 * (moments.sum() - 2 * moments) / mass
    semi_axes: Floats = np.sqrt(np.maximum(squares, 0.0))
    if not semi_axes.max() > 0.0:
        return None
    if np.linalg.det(axes) < 0:
        axes[:, 0] = -axes[:, 0]
    directions: Floats = axes
    return np.maximum(semi_axes, THINNEST * semi_axes.max()), directions
