"""A tree whose accelerations lose more digits than their status tells; see "Known exceptions" in docs."""

from __future__ import annotations

import numpy as np

import kanegen as kg
from kanegen.measure.truth import truth

ROD_ON_LIGHT_LINKS = kg.System.from_arrays(
    connection=[0, 1, 2],
    mass=[1.4e-4, 1.3e-4, 2.6],
    inertia=[
        np.diag(i) for i in ([5.7e-12, 3.1e-10, 3.1e-10], [4.7e-10, 4.6e-9, 4.3e-9], [8.7e-4, 36.0, 36.0])
    ],
    mass_center=[[0.0, 0.076, 0.0], [-0.28, -0.13, 0.094], [-1.7, -3.0, 0.0]],
    joint_position=[[0.0, 0.0, -0.85], [0.1, 0.044, 0.096], [0.0, 0.15, -0.3]],
    free=np.array([[1, 0, 0, 0, 0, 1], [0, 1, 1, 0, 0, 0], [0, 1, 1, 0, 0, 0]], dtype=bool),
)
X = [-0.01, 0.11, -0.46, 0.17, -0.38, -0.54]
Y = [-1.9, 1.9, 1.3, -1.5, 1.4, -1.0]
TAU = [0.0, -30.13, 0.0, 0.0, 0.14, -3.14]


def test_the_proven_bound_shows_what_the_status_misses() -> None:
    """The rod turns about its mass centre, whose inertia m r^2 of the joint hides: 2.6 * 11.9 of 8.7e-4."""
    library = kg.build(ROD_ON_LIGHT_LINKS, ("forward_dynamics", "error_bound"), on_status="raise")
    ydot = library.forward_dynamics(X, Y, TAU)
    exact = truth(ROD_ON_LIGHT_LINKS, X, Y, TAU, outputs=("forward_dynamics",))["forward_dynamics"].value
    error, bound = np.abs(ydot - exact), library.error_bound(X, Y, ydot, TAU)
    assert (error <= bound).all()
    assert np.linalg.norm(bound) > 2.0**13 * 2.0**-53 * np.linalg.norm(exact)
    print(f"{np.linalg.norm(error) / np.linalg.norm(exact) * 2.0**53:.0f} roundoffs without status")
