"""Kane's plate pendulum, as MotionGenesis and MATLAB have integrated it for Drake."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

import kanegen as kg
from benchmarks.validation import digits
from benchmarks.validation.case import Case, build, load, row
from kanegen.studies.markdown import markdown_table

PARAMETERS = {
    "g": "9.81",
    "mA": "0.01",
    "LA": "0.075",
    "IAx": "5e-6",
    "mB": "0.1",
    "LB": "0.2",
    "IBx": "2.5e-4",
    "IBy": "5e-5",
    "IBz": "2e-4",
}
"""The parameters of the model as decimals, which mean exact numbers in the run with many digits."""

TIME = "10"
"""Time of the results, s."""

QUANTITIES = ("qA", "qB", "qA'", "qB'", "qA''", "qB''")
UNITS = ("deg", "deg", "rad/s", "rad/s", "rad/s²", "rad/s²")

INTEGRATION = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-15, "max_step": 0.005}
"""Tolerances and largest step of SciPy's method of order 8, whose errors stay below those of rounding."""

SOLVERS = {
    "MotionGenesis": (
        "-61.312983340691 -929.47789677244 -6.7440081040646 -2.7795690128833 41.137023263571 19.483647096003"
    ),
    "simulation A": (
        "-61.312983517329 -929.47789818494 -6.7440080750248 -2.7795696971631 41.137023170384 19.483647506439"
    ),
    "simulation B": (
        "-61.312983761859 -929.47789795831 -6.7440080514955 -2.7795695154087 41.137023317160 19.483647277708"
    ),
    "ode45": "-61.3129818234 -929.477885053 -6.74400835033 -2.77956334901 41.1370240118 19.4836437213",
}
"""What the source states of its four simulations, in the order of `QUANTITIES`."""


def case(certain: bool = True) -> Case:
    """Return the case: ten seconds by generated C, and the digits of the exact motion.

    Args:
        certain: Whether the digits of the exact motion are computed, which takes most of the time.
    """
    found = _by_generated_code()
    first, *others = (text.split() for text in SOLVERS.values())
    rows = []
    for i, (name, unit) in enumerate(zip(QUANTITIES, UNITS, strict=True)):
        spread = max(abs(float(other[i]) - float(first[i])) for other in others)
        rows.append(row(f"{name} at {TIME} s", unit, first[i], found[i], allowed=spread))
    return Case(
        title="Kane's plate pendulum",
        model="plate_pendulum",
        source=(
            "T. R. Kane, *Mechanical demonstration of mathematical stability and instability*, International "
            "Journal of Mechanical Engineering Education 2 (1974) 45-47. Numbers of MotionGenesis 5.9 and of "
            "MATLAB's ode45 in Drake, "
            "`multibody/benchmarks/chaotic_babyboot/MG/test/MG_chaotic_babyboot_test.cc`."
        ),
        problem=(
            "A rod swings about a horizontal hinge and carries a plate that turns about the rod; released at "
            "rest from 90° and 1°, the plate tumbles unpredictably. `forward_dynamics` in C, integrated by "
            "DOP853 with steps of at most 5 ms. Errors grow by several powers of ten within the ten seconds."
        ),
        allowance=(
            "The source has four simulations with different solvers and steps. The largest difference of the "
            "other three from the first, with which the table compares, is what its digits allow."
        ),
        rows=tuple(rows),
        notes=(_digits(found),) if certain else (),
    )


def _by_generated_code() -> np.ndarray:
    """Return the six results by generated C in double precision."""
    library = build("plate_pendulum", "forward_dynamics")

    def slope(_: float, state: np.ndarray) -> np.ndarray:
        return np.concatenate([state[2:], library.forward_dynamics(state[:2], state[2:])])

    start = np.concatenate([np.radians([90.0, 1.0]), np.zeros(2)])
    last = solve_ivp(slope, (0.0, float(TIME)), start, **INTEGRATION).y[:, -1]
    return np.concatenate([np.degrees(last[:2]), last[2:], slope(0.0, last)[2:]])


def _digits(found: np.ndarray) -> str:
    """Return the paragraph and the table with all digits that two runs in many digits agree on.

    Args:
        found: The six results of generated C.
    """
    runs = [_in_many_digits(run) for run in digits.RUNS]
    stated = {name: np.array(text.split(), float) for name, text in SOLVERS.items()}
    results = {**stated, "kanegen's C": found}
    heads = ["", "unit", "digits", *(f"error of {name}" for name in results)]
    lines = []
    for i, (name, unit) in enumerate(zip(QUANTITIES, UNITS, strict=True)):
        agreed = digits.agreed(runs[0][i], runs[1][i], most=22)
        errors = [f"{abs(numbers[i] - float(runs[0][i])):.0e}" for numbers in results.values()]
        lines.append([name, unit, agreed, *errors])
    (one, two) = digits.RUNS
    return (
        "The digits on which the four simulations do not agree. The literal equations in SymPy, with exact "
        f"decimals for all parameters and exact angles, are integrated by Taylor series with {one.bits} "
        f"bits, once in {one.steps} steps of order {one.order} and once in {two.steps} steps of order "
        f"{two.order}. All digits shown are the same in both. The last columns are the errors of the "
        "numbers of the source and of generated C.\n\n" + markdown_table(heads, lines, left=2)
    )


def _in_many_digits(run: digits.Run) -> list[digits.arb]:
    """Return the six results as exact as a run gives them."""
    field = digits.rates(kg.derive(load("plate_pendulum")), list(PARAMETERS))
    state = digits.motion(field, _start, PARAMETERS, TIME, run)
    with digits.ctx.workprec(run.bits):
        *_, first, second = field(*state, *(digits.arb(value) for value in PARAMETERS.values()))
        degrees = 180 / digits.arb.pi()
        return [state[0] * degrees, state[1] * degrees, *state[2:], first, second]


def _start() -> list[digits.arb]:
    """Return the first state: 90 degrees, 1 degree, at rest."""
    pi = digits.arb.pi()
    return [pi / 2, pi / 180, digits.arb(0), digits.arb(0)]
