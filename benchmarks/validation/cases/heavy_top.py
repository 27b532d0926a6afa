"""The heavy top of Brüls and Cardona, with the tables that EXUDYN keeps for its verification."""

from __future__ import annotations

import kanegen as kg
from benchmarks.validation.case import Case, build, row

ORIENTATIONS = {
    0.2: "-0.70828 0.43878 0.54573 0.0894",
    1.0: "0.73294 -0.27829 0.53182 -0.32018",
    2.0: "0.12295 -0.49108 0.35043 -0.78799",
}
"""Euler parameters by time (s), the scalar first."""

RATES = {2.0: "0.12223 150 -5.8556"}
"""Components of the angular velocity in the body by time (s), rad/s."""

HALF_A_UNIT = {"orientation": 5e-6, "angular velocity": 5e-5}
"""Half a unit of the last digit of five digits, where the tables drop zeros at the end."""


def case() -> Case:
    """Return the case: two seconds with a quaternion, by generated C."""
    library = build("heavy_top", "forward_dynamics", "coordinate_rates")
    times = [0.0, *ORIENTATIONS]
    start = [1.0, 0.0, 0.0, 0.0], [0.0, 150.0, -4.61538]
    run = kg.simulate(library, *start, times, method="DOP853", tolerance=1e-13)
    rows = [
        row(f"Euler parameters at {time} s", "1", text, run.x[times.index(time)], HALF_A_UNIT["orientation"])
        for time, text in ORIENTATIONS.items()
    ]
    rows += [
        row(
            f"angular velocity at {time} s",
            "rad/s",
            text,
            run.y[times.index(time)],
            HALF_A_UNIT["angular velocity"],
        )
        for time, text in RATES.items()
    ]
    return Case(
        title="The heavy top of Brüls and Cardona",
        model="heavy_top",
        source=(
            "O. Brüls and A. Cardona, *On the use of Lie group time integrators in multibody dynamics*, "
            "Journal of Computational and Nonlinear Dynamics 5 (2010) 031002, has the top. The numbers are "
            "those that EXUDYN keeps in `docs/verification/HeavyTopSolution`, by a Runge-Kutta method with "
            "steps of 1e-4 s."
        ),
        problem=(
            "A top of 15 kg on a fixed point spins at 150 rad/s. Quaternion and angular velocity as "
            "coordinates and speeds; `forward_dynamics` and `coordinate_rates` in C, integrated by DOP853 "
            "with the tolerance 1e-13. Within two seconds the top turns 47 times."
        ),
        allowance="The tables have five digits. Half a unit of the fifth digit is allowed.",
        rows=tuple(rows),
    )
