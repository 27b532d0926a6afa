"""The rotation of a tumbling brick, check case 2 of the NASA Engineering and Safety Center."""

from __future__ import annotations

import numpy as np

import kanegen as kg
from benchmarks.validation.case import Case, build, exact_row, row

RATES = {
    0.0: "10 20 30",
    10.0: "-2.41890222178 -23.5525695195 28.1285926300",
    12.0: "9.39062210775 -20.4797136405 29.7715840064",
    30.0: "12.6183907757 -17.3974747618 31.1195888868",
}
"""Components of the angular velocity in the body by time (s), deg/s."""

DIGITS = 2e-9
"""What the numbers allow, deg/s."""

ATTITUDES = {
    10.0: (-0.07542154770649163, 0.06529865734720618, -1.1522489754883445, 3.711514845285328e-08),
    12.0: (1.199858606938276, 0.4458172613593594, -0.6462676575120714, 6.413734624381774e-08),
    30.0: (-0.07486336822299243, -0.06666555465260421, -0.9800251968615921, 1.0027827516629087e-06),
}
"""Yaw, pitch and roll from the local frame (north, east, down), and longitude, by time (s), rad."""

EARTH = 7.292115e-5
"""Angular velocity of the Earth in the check cases, rad/s."""

ATTITUDE_DIGITS = 2e-10
"""What the numbers allow in entries of the rotation."""


def case() -> Case:
    """Return the case: thirty seconds of the rotation alone, by generated C."""
    library = build("tumbling_brick", "forward_dynamics", "coordinate_rates", "body_poses")
    first = np.radians([float(number) for number in RATES[0.0].split()])
    run = kg.simulate(library, [1.0, 0.0, 0.0, 0.0], first, list(RATES), method="DOP853", tolerance=1e-13)
    rows = [
        row(f"angular velocity at {time:g} s", "deg/s", text, np.degrees(run.y[i]), DIGITS)
        for i, (time, text) in enumerate(RATES.items())
        if i > 0
    ]
    for i, (time, angles) in enumerate(ATTITUDES.items(), start=1):
        found = library.body_poses(run.x[i])[0, :3]
        for j, expected in enumerate(_rotation(time, *angles)):
            quantity = f"row {j + 1} of [R] at {time:g} s"
            rows.append(exact_row(quantity, "1", expected, found[j], ATTITUDE_DIGITS))
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
            "deg/s is allowed, as its fixed steps have errors beyond the digits that it prints, and "
            f"{ATTITUDE_DIGITS:g} in the entries of [R], which are computed from as many digits."
        ),
        rows=tuple(rows),
    )


def _rotation(time: float, yaw: float, pitch: float, roll: float, longitude: float) -> np.ndarray:
    """Return the (3, 3) rotation from the first local frame, which is inertial, to the brick.

    The brick falls in the plane of the equator. Its local frame turns about north, as the Earth does and as
    its longitude grows; from there yaw, pitch and roll lead to the brick.
    """
    turned = longitude + EARTH * time
    return _about(0, roll) @ _about(1, pitch) @ _about(2, yaw) @ _about(0, turned)


def _about(axis: int, angle: float) -> np.ndarray:
    """Return the rotation from a frame to the one that is turned about an axis."""
    j, k = (axis + 1) % 3, (axis + 2) % 3
    rotation = np.eye(3)
    rotation[j, j] = rotation[k, k] = np.cos(angle)
    rotation[j, k], rotation[k, j] = np.sin(angle), -np.sin(angle)
    return rotation
