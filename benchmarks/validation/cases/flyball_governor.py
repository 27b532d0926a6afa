"""Problem A05 of the IFToMM library: a stiff flyball governor, beside numbers of EXUDYN."""

from __future__ import annotations

import math

import kanegen as kg
from benchmarks.validation.case import Case, build, row

SLIDER = {0.1: "0.52383647557", 1.0: "0.50142092238", 10.0: "0.619622917"}
"""Height s of the slider by time (s), m, by EXUDYN."""

SPIN = {0.1: "6.1037178088", 1.0: "6.2711257419", 10.0: "5.54820362"}
"""Angular velocity of the shaft by time (s), rad/s, by EXUDYN."""

HEIGHT = 0.5
"""Height of the slider where its coordinate is zero, m."""


def case(last: float = 10.0) -> Case:
    """Return the case: the stiff equations by generated C and an explicit method.

    Args:
        last: Last time of the results, s.
    """
    library = build("flyball_governor", "forward_dynamics")
    spin, slider = (library.freedom_names.index(name) for name in ("spin", "s"))
    first = [2 * math.pi if i == spin else 0.0 for i in range(library.n)]
    times = [0.0, *(time for time in SLIDER if time <= last)]
    run = kg.simulate(library, [0.0] * library.n, first, times, method="DOP853", tolerance=1e-12)
    rows = [
        row(f"height of the slider at {time} s", "m", text, HEIGHT + run.x[times.index(time), slider])
        for time, text in SLIDER.items()
        if time <= last
    ]
    rows += [
        row(f"angular velocity of the shaft at {time} s", "rad/s", text, run.y[times.index(time), spin])
        for time, text in SPIN.items()
        if time <= last
    ]
    return Case(
        title="IFToMM A05, the stiff flyball governor",
        model="flyball_governor",
        source=(
            "Problem A05 of the IFToMM library of computational benchmark problems. The library shows its "
            "reference as a curve; the numbers are those of EXUDYN 1.13.6 with the kinematic tree of its "
            "example `stiffFlyballGovernorKT.py`: `python -m benchmarks.validation.exudyn_governor` prints "
            "them where EXUDYN is installed."
        ),
        problem=(
            "Two rods with 5 kg at their ends hang from a spinning shaft, and spring-dampers of 8e5 N/m and "
            "4e4 N s/m couple them to a slider. `forward_dynamics` in C, integrated by DOP853 with the "
            f"tolerance 1e-12, whose steps the dampers limit: {run.evaluations} evaluations."
        ),
        allowance=(
            "EXUDYN integrates by the trapezoidal rule. Its results for four steps from 5e-4 s to 6.25e-5 s "
            "are extrapolated (Richardson), and only digits that the last two extrapolations share are kept. "
            "Half a unit of the last digit is allowed."
        ),
        rows=tuple(rows),
    )
