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
from tests.support.cases import slow_except
from tests.support.rod_on_light_links import ROUNDOFF, TAU, X, Y, rod_on_light_links


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


@pytest.mark.parametrize("solver", slow_except(("cheapest", "factorisation"), "cheapest"))
@pytest.mark.parametrize("refinement", slow_except(("auto", 0, 1, 2), "auto"))
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
