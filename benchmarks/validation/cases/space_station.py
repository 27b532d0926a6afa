"""The rotation of the space station under a torque, by NASA's JEOD."""

from __future__ import annotations

import numpy as np

import kanegen as kg
from benchmarks.validation.case import Case, build, row

RATE = (0.0, -0.001134454274550824, 0.0)
"""First angular velocity, in the body, rad/s."""

ATTITUDE = np.array(
    [
        [0.1412307175854335, -0.9892782736897275, 0.03718039289432368],
        [-0.772691975098125, -0.1336331223242703, -0.6205556383087864],
        [0.6188707425862547, 0.05891252687959725, -0.7832804849780175],
    ]
)
"""First rotation from JEOD's inertial frame to the body."""

PHASES = (
    (0.0, 960.0, 0.0),
    (960.0, 1000.0, 0.0),
    (1000.0, 1080.0, 10.0),
    (1080.0, 2000.0, 10.0),
    (2000.0, 28800.0, 0.0),
)
"""First and last time of every phase of the motion, s, and torque about axis 1, N m."""

FIRST_ACCELERATION = "-1.042747386314226e-08 -4.411614753593177e-10 -5.496529462673259e-08"

RATES = {
    960.0: "-3.0108458605801e-05 -0.001133769499310447 -5.353893612196759e-05",
    1080.0: "-2.875994245324793e-05 -0.001132847272872249 -6.001347243499429e-05",
    28800.0: "-0.0007282187220568775 -0.0008332384627087039 -0.0002424925044840342",
}
"""Components of the angular velocity by time (s), rad/s."""

ATTITUDES = {
    960.0: """\
0.6291164786820322 -0.4032870243245685 -0.6645088654503835
-0.7633069023204688 -0.1589772717328463 -0.6261699449369249
0.1468844073435002 0.9011580344666612 -0.4078469906662705""",
    28800.0: """\
-0.110781359605145 -0.0346505107912517 -0.9932405712947602
-0.8498349541130382 -0.5148480361227724 0.1127477293262038
-0.5152747239402747 0.8565809020766398 0.02758835018344352""",
}
"""Rows of the rotation from JEOD's inertial frame to the body, by time (s)."""

ROUNDING = {"acceleration": 1e-20, "rate": 1e-14, "rotation": 1e-11}
"""Differences that are allowed, for rounding that adds up in JEOD: rad/s^2, rad/s, 1."""


def case() -> Case:
    """Return the case: eight hours, with a torque for a thousand seconds."""
    library = build("space_station", "forward_dynamics", "coordinate_rates", "body_poses")
    x, y = np.array([1.0, 0.0, 0.0, 0.0]), np.array(RATE)
    first = library.forward_dynamics(x, y)
    rows = [row("first angular acceleration", "rad/s²", FIRST_ACCELERATION, first, ROUNDING["acceleration"])]
    for begin, end, torque in PHASES:
        run = kg.simulate(
            library,
            x,
            y,
            [begin, end],
            method="DOP853",
            tolerance=1e-13,
            effort=lambda t, x, y, torque=torque: np.array([torque, 0.0, 0.0]),
        )
        x, y = run.x[-1], run.y[-1]
        if end in RATES:
            rows.append(row(f"angular velocity at {end:g} s", "rad/s", RATES[end], y, ROUNDING["rate"]))
        if end in ATTITUDES:
            found = library.body_poses(x)[0, :3] @ ATTITUDE
            for i, text in enumerate(ATTITUDES[end].splitlines()):
                quantity = f"row {i + 1} of the rotation at {end:g} s"
                rows.append(row(quantity, "1", text, found[i], ROUNDING["rotation"]))
    return Case(
        title="The space station of NASA's JEOD",
        model="space_station",
        source=(
            "JSC Engineering Orbital Dynamics (JEOD) of NASA, `verif/SIM_dyncomp`, run 9B: *Rotational State "
            "Comparison: Torque, Initial Rate*, `SET_test_val/RUN_9B/log_state_ASCII.csv`."
        ),
        problem=(
            "The station as one body with products of inertia turns at the rate of its orbit; from 1000 s to "
            "2000 s 10 N m act about axis 1. `forward_dynamics`, `coordinate_rates` and `body_poses` in C, "
            "integrated by DOP853 with the tolerance 1e-13 for eight hours."
        ),
        allowance=(
            "JEOD's log has 16 digits and states no tolerance. Rounding adds up over the steps of eight "
            "hours: 1e-14 rad/s and, in entries of the rotation, 1e-11 are allowed."
        ),
        rows=tuple(rows),
    )
