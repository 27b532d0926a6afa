"""A slender rod far from its joint on links that are much lighter, which no refinement makes accurate.

The links let the rod turn about its mass centre, and its inertia about the joint, m r^2 and more, hides the
inertia of this turn: 2.6 * 11.9 of 8.7e-4 kg m^2. Such accelerations have a status, and a proven bound.
"""

from __future__ import annotations

import numpy as np
import pytest

import kanegen as kg
from kanegen.library.native.status import StatusReport
from kanegen.lowering.conditioning import LARGEST_ACCEPTED_ERROR
from kanegen.measure.truth import truth
from kanegen.model.arrays import Floats

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


def exact(system: kg.System, x: Floats, y: Floats, tau: Floats) -> Floats:
    """Return the certified {ydot} of one state."""
    return truth(system, x, y, tau, outputs=("forward_dynamics",))["forward_dynamics"].value


def test_the_bound_is_proven_where_the_status_warns() -> None:
    system = rod_on_light_links()
    library = kg.build(system, ("forward_dynamics", "error_bound"))
    with pytest.warns(kg.KanegenWarning, match="not accurate"):
        ydot = library.forward_dynamics(X, Y, TAU)
    expected = exact(system, np.array(X), np.array(Y), np.array(TAU))
    error = np.abs(ydot - expected)
    assert np.linalg.norm(error) > LARGEST_ACCEPTED_ERROR * ROUNDOFF * np.linalg.norm(expected)
    assert (error <= library.error_bound(X, Y, ydot, TAU)).all()


@pytest.mark.parametrize("solver", ["cheapest", "factorisation"])
@pytest.mark.parametrize("refinement", ["auto", 0, 1, 2])
def test_no_large_error_is_silent(refinement: str | int, solver: str) -> None:
    """In states around one that a search for large errors found, for rods of 2.6 and 2.6e5 kg."""
    rng = np.random.default_rng(2)
    for share in (1.0, 1e5):
        system = rod_on_light_links(share)
        variant = kg.Variant(refinement=refinement, solver=solver)
        library = kg.build(system, ("forward_dynamics",), tier=variant)
        for _ in range(4):
            x, y = np.array(X) + rng.uniform(-0.3, 0.3, 6), rng.uniform(-2, 2, 6)
            tau = np.array(TAU) * share * rng.uniform(0, 1.5, 6)
            reports: list[StatusReport] = []
            ydot = library.with_on_status(reports.append).forward_dynamics(x, y, tau)
            if not reports:
                expected = exact(system, x, y, tau)
                error = np.linalg.norm(ydot - expected) / np.linalg.norm(expected)
                assert error <= LARGEST_ACCEPTED_ERROR * ROUNDOFF, (share, x, y, tau)
