"""The Puma 560 of Corke's Robotics Toolbox."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.validation.case import Case, build, row

QN = (0.0, math.pi / 4, math.pi, 0.0, math.pi / 4, 0.0)
"""The pose qn of the toolbox, rad."""

WRENCH = np.array([[1.0, 2.0, 3.0]])
"""Components of the force (N) and of the moment (N m) that the flange exerts, in its frame."""

MASS_MATRIX = """\
3.6594 -0.4044 0.1006 -0.0025 0.0000 -0.0000
-0.4044 4.4137 0.3509 0.0000 0.0024 0.0000
0.1006 0.3509 0.9378 0.0000 0.0015 0.0000
-0.0025 0.0000 0.0000 0.1925 0.0000 0.0000
0.0000 0.0024 0.0015 0.0000 0.1713 0.0000
-0.0000 0.0000 0.0000 0.0000 0.0000 0.1941"""


CORIOLIS = """\
-0.1735 -2.0494 -0.1178 -0.0002 -0.0045 0.0001
0.6274 1.1572 1.9287 -0.0015 -0.0003 -0.0000
-0.3608 -0.7734 -0.0018 -0.0009 -0.0064 -0.0000
0.0011 0.0005 -0.0001 0.0002 0.0002 -0.0001
-0.0002 0.0028 0.0046 -0.0002 -0.0000 -0.0000
0.0001 0.0000 0.0000 0.0000 0.0000 0.0000"""


OPERATIONAL_INERTIA = """\
17.2954 -2.7542 -9.6233 -0.0000 0.2795 0.0000
-2.7542 12.1909 1.2459 -0.3254 -0.0703 -0.9652
-9.6233 1.2459 13.3348 -0.0000 0.2767 -0.0000
-0.0000 -0.3254 -0.0000 0.1941 0.0000 0.1941
0.2795 -0.0703 0.2767 0.0000 0.1713 0.0000
0.0000 -0.9652 -0.0000 0.1941 0.0000 0.5791"""

LINEAR_FIRST = np.ix_([3, 4, 5, 0, 1, 2], [3, 4, 5, 0, 1, 2])
"""Rows and columns in the order of the toolbox."""


def case() -> Case:
    """Return the case: torques, inertia and accelerations in the pose qn."""
    library = build(
        "puma560",
        "inverse_dynamics",
        "mass_matrix",
        "forward_dynamics",
        "coriolis_matrix",
        "operational_inertia",
    )
    zero, one, climbing = np.zeros(6), np.ones(6), np.array([1.0, 2.0, 3.0, 1.0, 2.0, 3.0])
    free = {"point_force": np.zeros((1, 3)), "point_moment": np.zeros((1, 3))}
    pressed = {"point_force": -WRENCH, "point_moment": -WRENCH}

    def torques(
        speeds: np.ndarray, accelerations: np.ndarray, loads: dict[str, np.ndarray] = free
    ) -> np.ndarray:
        return library.inverse_dynamics(QN, speeds, accelerations, **loads)

    weight = torques(zero, zero)
    speeds, efforts = [0.1, 0.2, 0.8, 0.2, 0.5, 1.0], [1.0, 3.2, 1.8, 0.1, 0.7, 4.6]
    accelerations = library.forward_dynamics(QN, speeds, efforts, **free)
    rows = [
        row("torques at rest", "N m", "-0.0000 31.6399 6.0351 0.0000 0.0283 0.0000", weight),
        row(
            "torques, q̈ = 1 rad/s²",
            "N m",
            "3.35311 36.0025 7.42596 0.190043 0.203441 0.194133",
            torques(zero, one),
        ),
        row(
            "torques, q̇ = 1 rad/s, q̈ = 1 rad/s²",
            "N m",
            "32.4952 60.867 17.7436 1.45452 1.29911 0.713781",
            torques(one, one),
        ),
        row(
            "torques, q̇ = 1 rad/s",
            "N m",
            "29.1421 56.5044 16.3528 1.26448 1.12392 0.519648",
            torques(one, zero),
        ),
        row(
            "the same, q̈ = 1 rad/s², without gravity",
            "N m",
            "32.4952 29.2271 11.7085 1.45452 1.27086 0.713781",
            torques(one, one) - weight,
        ),
        row(
            "torques at rest, flange exerts (1, 2, 3) N and (1, 2, 3) N m",
            "N m",
            "0.642756 29.0866 4.70321 2.82843 -1.97175 3.00000",
            torques(zero, zero, pressed),
        ),
        row(
            "torques of inertia, q̈ = (1, 2, 3, 1, 2, 3) rad/s²",
            "N m",
            "3.1500 9.4805 3.6189 0.1901 0.3519 0.5823",
            torques(zero, climbing) - weight,
        ),
        row(
            "accelerations, q̇ = (0.1, 0.2, 0.8, 0.2, 0.5, 1), torques (1, 3.2, 1.8, 0.1, 0.7, 4.6) N m",
            "rad/s²",
            "-7.4102 -9.8432 -10.9694 -4.4314 -0.9881 21.0228",
            accelerations,
        ),
    ]
    inertia = library.mass_matrix(QN)
    rows += [
        row(f"row {i + 1} of [A]", "kg m²", text, inertia[i])
        for i, text in enumerate(MASS_MATRIX.splitlines())
    ]
    coriolis = library.coriolis_matrix(QN, climbing)
    rows += [
        row(f"row {i + 1} of the Coriolis matrix, q̇ = (1, 2, 3, 1, 2, 3) rad/s", "kg m²/s", text, coriolis[i])
        for i, text in enumerate(CORIOLIS.splitlines())
    ]
    operational = library.operational_inertia(QN)[0][LINEAR_FIRST]
    rows += [
        row(f"row {i + 1} of the operational inertia of the flange", "kg, kg m, kg m²", text, operational[i])
        for i, text in enumerate(OPERATIONAL_INERTIA.splitlines())
    ]
    return Case(
        title="The Puma 560 of the Robotics Toolbox",
        model="puma560",
        source=(
            "P. Corke's Robotics Toolbox for Python, `models.DH.Puma560` and `tests/test_DHRobot.py`, with "
            "parameters of Armstrong, Khatib and Burdick, *The explicit dynamic model and inertial "
            "parameters of the PUMA 560 arm*, ICRA 1986, and Corke and Armstrong-Hélouvry, ICRA 1994."
        ),
        problem=(
            "An arm with six joints in the pose qn = (0, π/4, π, 0, π/4, 0), with the reflected inertia of "
            "its motors as `armature` and their viscous and Coulomb friction as drives: `inverse_dynamics`, "
            "`mass_matrix`, `forward_dynamics`, `coriolis_matrix` and `operational_inertia` in C. The "
            "principal moments of link 3 violate the triangle inequality, of which kanegen warns; the "
            "numbers are those of the toolbox."
        ),
        allowance="Half a unit of the last digit that the toolbox prints, four decimals or six digits.",
        rows=tuple(rows),
    )
