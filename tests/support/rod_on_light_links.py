"""A slender rod far from its joint on links that are much lighter, with a state that loses most digits.

The links let the rod turn about its mass centre, and its inertia about the joint, m r^2 and more, hides the
inertia of this turn.
"""

from __future__ import annotations

import numpy as np

import kanegen as kg

X = [-0.01, 0.11, -0.46, 0.17, -0.38, -0.54]
Y = [-1.9, 1.9, 1.3, -1.5, 1.4, -1.0]
TAU = [0.0, -30.13, 0.0, 0.0, 0.14, -3.14]
ROUNDOFF = 2.0**-53


def rod_on_light_links(share: float = 1.0) -> kg.System:
    """Return two light links and a rod, whose mass is a share of 2.6 kg."""
    rod = [8.7e-4 * share, 36.0 * share, 36.0 * share]
    inertias = [[5.7e-12, 3.1e-10, 3.1e-10], [4.7e-10, 4.6e-9, 4.3e-9], rod]
    return kg.System.from_arrays(
        connection=[0, 1, 2],
        mass=[1.4e-4, 1.3e-4, 2.6 * share],
        inertia=[np.diag(one) for one in inertias],
        mass_center=[[0.0, 0.076, 0.0], [-0.28, -0.13, 0.094], [-1.7, -3.0, 0.0]],
        joint_position=[[0.0, 0.0, -0.85], [0.1, 0.044, 0.096], [0.0, 0.15, -0.3]],
        free=np.array([[1, 0, 0, 0, 0, 1], [0, 1, 1, 0, 0, 0], [0, 1, 1, 0, 0, 0]], dtype=bool),
    )
