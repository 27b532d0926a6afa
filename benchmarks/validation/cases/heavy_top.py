"""The heavy top of Brüls and Cardona, with the tables that EXUDYN keeps for its verification."""

from __future__ import annotations

import numpy as np

import kanegen as kg
from benchmarks.validation import digits
from benchmarks.validation.case import Case, build, load, row
from kanegen.studies.markdown import markdown_table

ORIENTATIONS = {
    0.2: "-0.70828 0.43878 0.54573 0.0894",
    1.0: "0.73294 -0.27829 0.53182 -0.32018",
    2.0: "0.12295 -0.49108 0.35043 -0.78799",
}
"""Euler parameters by time (s), the scalar first."""

RATES = {2.0: "0.12223 150 -5.8556"}
"""Components of the angular velocity in the body by time (s), rad/s."""

PARAMETERS = {"g": "9.81"}
"""The parameter of the model as a decimal; the other numbers of the top are doubles."""

HALF_A_UNIT = {"orientation": 5e-6, "angular velocity": 5e-5}
"""Half a unit of the last digit of five digits, where the tables drop zeros at the end."""


EXACT = ("1", "2")
"""Times of exact results, s, the last ones of `ORIENTATIONS`."""

QUANTITIES = ("X₁", "X₂", "X₃", "ω₁", "ω₂", "ω₃")
UNITS = ("m", "m", "m", "rad/s", "rad/s", "rad/s")


def case(certain: bool = True) -> Case:
    """Return the case: two seconds with a quaternion, by generated C.

    Args:
        certain: Whether digits of the exact motion are computed, which takes most of the time.
    """
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
        notes=(_digits(run.x[2:], run.y[2:]),) if certain else (),
    )


def _digits(x: np.ndarray, y: np.ndarray) -> str:
    """Return the paragraph and the table with the digits that two runs agree on.

    Args:
        x: (T, 4) quaternions that generated C finds at the times of `EXACT`.
        y: (T, 3) angular velocities.
    """
    heads = ["", "time, s", "unit", "digits", "error of kanegen's C"]
    lines = []
    for i, time in enumerate(EXACT):
        found = [*_center([digits.arb(float(e)) for e in x[i]]), *(digits.arb(float(w)) for w in y[i])]
        runs = [_in_many_digits(time, run) for run in digits.RUNS]
        for name, unit, mine, first, second in zip(QUANTITIES, UNITS, found, *runs, strict=True):
            error = f"{abs(float(mine - first)):.0e}"
            lines.append([name, time, unit, digits.agreed(first, second, most=22), error])
    return (
        "Digits of position X of the mass centre and of the angular velocity in the body, for other "
        "programs: the literal equations in SymPy, with the exact decimal 9.81, are integrated by Taylor "
        "series as those of the "
        "plate pendulum. All digits shown are the same in both runs.\n\n"
        + markdown_table(heads, lines, left=3)
    )


def _in_many_digits(time: str, run: digits.Run) -> list[digits.arb]:
    """Return position and angular velocity as exact as a run gives them."""
    field = digits.rates(kg.derive(load("heavy_top")), list(PARAMETERS))
    state = digits.motion(field, _start, PARAMETERS, time, run)
    with digits.ctx.workprec(run.bits):
        return [*_center(state[:4]), *state[4:]]


def _start() -> list[digits.arb]:
    """Return the first quaternion and the first angular velocity."""
    return [digits.arb(number) for number in ("1", "0", "0", "0", "0", "150", "-4.61538")]


def _center(quaternion: list[digits.arb]) -> list[digits.arb]:
    """Return the inertial position of the mass centre, 1 m along axis 2 of the body."""
    e0, e1, e2, e3 = quaternion
    square = e0**2 + e1**2 + e2**2 + e3**2
    entries = (2 * (e1 * e2 - e0 * e3), e0**2 - e1**2 + e2**2 - e3**2, 2 * (e2 * e3 + e0 * e1))
    return [entry / square for entry in entries]
