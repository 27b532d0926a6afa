"""Problem A01 of the IFToMM library: a simple pendulum, for 2000 s, beside Jacobi's elliptic functions."""

from __future__ import annotations

import math

import numpy as np
from scipy.special import ellipj, ellipk

import kanegen as kg
from benchmarks.validation.case import Case, Row, build

SECONDS = 2000.0
"""Duration that the library asks for."""

INTERVAL = 0.5
"""Time between two outputs, s; the library asks for 4000 outputs."""

HIGH_PRECISION = 1e-3
"""Largest error of a solution that the library counts as one of high precision, m."""


def case(seconds: float = SECONDS) -> Case:
    """Return the case: the largest distance of P1 from its exact position at all outputs."""
    library = build("simple_pendulum", "forward_dynamics", "point_positions")
    times = np.linspace(0.0, seconds, 1 + round(seconds / INTERVAL))
    run = kg.simulate(library, [math.pi], [0.0], times, method="DOP853", tolerance=1e-13)
    found = library.point_positions(run.x)[:, 0, :2]
    error = np.linalg.norm(found - exact(times), axis=1).max()
    return Case(
        title="IFToMM A01, the simple pendulum",
        model="simple_pendulum",
        source=(
            "Problem A01 of the IFToMM library of computational benchmark problems; M. González, D. Dopico, "
            "U. Lugrís and J. Cuadrado, *A benchmarking system for MBS simulation software*, Multibody "
            "System Dynamics 16 (2006) 179-190."
        ),
        problem=(
            f"A point mass on a bar of 1 m, released at rest from the horizontal, for {seconds:g} s: "
            "`forward_dynamics` and `point_positions` in C, integrated by DOP853 with the tolerance 1e-13. "
            "The expected position of P1 is exact: sin(φ/2) = k sn(K(k) - √(g/L) t, k) with k = sin(π/4), φ "
            "from the vertical."
        ),
        allowance=(
            f"The library counts {HIGH_PRECISION:g} m as high precision. Its own formula weighs errors in "
            "another way; here it is the largest distance at any output."
        ),
        rows=(
            Row(
                f"largest distance of P1 from its exact position, {len(times)} outputs",
                "m",
                ("0",),
                (float(error),),
                HIGH_PRECISION,
            ),
        ),
    )


def exact(times: np.ndarray) -> np.ndarray:
    """Return the (T, 2) exact positions of P1, which starts at (-1, 0) at rest."""
    k = math.sin(math.pi / 4)
    sn, *_ = ellipj(ellipk(k**2) - math.sqrt(9.81) * times, k**2)
    from_vertical = 2 * np.arcsin(k * sn)
    return np.column_stack([-np.sin(from_vertical), -np.cos(from_vertical)])
