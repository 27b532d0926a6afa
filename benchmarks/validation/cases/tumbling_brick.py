"""The rotation of a tumbling brick, check case 2 of the NASA Engineering and Safety Center."""

from __future__ import annotations

import numpy as np

import kanegen as kg
from benchmarks.validation.case import Case, build, row

RATES = {
    0.0: "10 20 30",
    10.0: "-2.41890222178 -23.5525695195 28.1285926300",
    12.0: "9.39062210775 -20.4797136405 29.7715840064",
    30.0: "12.6183907757 -17.3974747618 31.1195888868",
}
"""Components of the angular velocity in the body by time (s), deg/s."""

DIGITS = 2e-9
"""What the numbers allow, deg/s."""


def case() -> Case:
    """Return the case: thirty seconds of the rotation alone, by generated C."""
    library = build("tumbling_brick", "forward_dynamics", "coordinate_rates")
    first = np.radians([float(number) for number in RATES[0.0].split()])
    run = kg.simulate(library, [1.0, 0.0, 0.0, 0.0], first, list(RATES), method="DOP853", tolerance=1e-13)
    rows = [
        row(f"angular velocity at {time:g} s", "deg/s", text, np.degrees(run.y[i]), DIGITS)
        for i, (time, text) in enumerate(RATES.items())
        if i > 0
    ]
    return Case(
        title="The tumbling brick of NASA's check cases",
        model="tumbling_brick",
        source=(
            "NASA/TM-2015-218675, *Check-cases for verification of 6-degree-of-freedom flight vehicle "
            "simulations*, atmospheric case 2, without drag and damping: the angular rates with respect to "
            "the inertial frame of simulation 1, `Atmos_02_sim_01.csv`."
        ),
        problem=(
            "A brick is dropped and tumbles with rates of 10, 20 and 30 deg/s about its three axes. Nothing "
            "acts on the rotation, so the case is its rotation alone; `forward_dynamics` and "
            "`coordinate_rates` in C, integrated by DOP853 with the tolerance 1e-13. The rest of the check "
            "case, the fall above a rotating ellipsoid, is not rigid-body dynamics and is left out."
        ),
        allowance=(
            f"The report says no tolerance. The rates of the simulation have about eleven digits; {DIGITS:g} "
            "deg/s is allowed, as its fixed steps have errors beyond the digits that it prints."
        ),
        rows=tuple(rows),
    )
