"""The motion of a point on a floating body, by the HuMAnS toolbox for RBDL's tests."""

from __future__ import annotations

import numpy as np

from benchmarks.validation.case import Case, build, row

STATE = np.array([1.3, 1.5, 1.7, 0.1, 1.1, 1.2])
"""Angles 3-2-1 and position, also their rates and second derivatives: rad, m and s."""

TOLERANCE = 1e-14
"""Difference that RBDL's own test allows, m, m/s and m/s^2."""


def case() -> Case:
    """Return the case: position, velocity and accelerations of the point."""
    library = build("floating_base", "point_positions", "point_velocities", "point_accelerations")
    still = np.zeros(6)
    rows = (
        row(
            "position",
            "m",
            "-6.357089363622626e-01 -6.831041744630977e-01 2.968974805916970e+00",
            library.point_positions(STATE),
            TOLERANCE,
        ),
        row(
            "velocity",
            "m/s",
            "3.091226260907569e-01 3.891012095550828e+00 4.100277995030419e+00",
            library.point_velocities(STATE, STATE),
            TOLERANCE,
        ),
        row(
            "acceleration, without that of the coordinates",
            "m/s²",
            "-5.302760158847160e+00 6.541369639625232e+00 -4.795115077652286e+00",
            library.point_accelerations(STATE, STATE, still),
            TOLERANCE,
        ),
        row(
            "acceleration",
            "m/s²",
            "-4.993637532756404e+00 1.043238173517606e+01 -6.948370826218673e-01",
            library.point_accelerations(STATE, STATE, STATE),
            TOLERANCE,
        ),
    )
    return Case(
        title="A point of a floating body by HuMAnS",
        model="floating_base",
        source=("Numbers of the HuMAnS toolbox of INRIA in M. Felis's RBDL, `tests/FloatingBaseTests.cc`."),
        problem=(
            "A body with three translations and the angles 3-2-1: `point_positions`, `point_velocities` and "
            "`point_accelerations` in C, where coordinates, rates and second derivatives are the same six "
            "numbers."
        ),
        allowance=f"The tolerance of the test, {TOLERANCE:g}; its numbers have 16 digits.",
        rows=rows,
    )
