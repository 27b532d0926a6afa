"""A branched tree of RBDL's tests."""

from __future__ import annotations

import numpy as np

from benchmarks.validation.case import Case, build, row

ACCELERATIONS = (
    "-1.60319066147860E+00 -5.34396887159533E-01 4.10340466926070E+00 2.67198443579767E-01 "
    "5.30579766536965E+00"
)
"""Accelerations of the five hinges from rest, rad/s^2."""

TOLERANCE = 1e-13
"""Difference that RBDL's own test allows, rad/s^2."""


def case() -> Case:
    """Return the case: accelerations from rest under gravity."""
    library = build("simple_tree", "forward_dynamics")
    found = library.forward_dynamics(np.zeros(5), np.zeros(5))
    return Case(
        title="A branched tree of RBDL's tests",
        model="simple_tree",
        source="M. Felis's RBDL, `TestCalcDynamicSimpleTree3D` in `tests/DynamicsTests.cc`.",
        problem=(
            "Five equal bodies on hinges, in two branches, at rest under gravity: `forward_dynamics` in C."
        ),
        allowance=f"The tolerance of the test, {TOLERANCE:g}; its numbers have 15 digits.",
        rows=(row("accelerations", "rad/s²", ACCELERATIONS, found, TOLERANCE),),
    )
