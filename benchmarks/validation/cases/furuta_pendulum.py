"""The Furuta pendulum, whose equations Cazzolato and Prime have published in closed form."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

import kanegen as kg
from benchmarks.validation.case import Case, build, exact_row, load

STATES = (
    ("hanging, both turn", (0.3, 0.4), (1.5, -2.0), (0.05, 0.0)),
    ("upright, at rest", (0.0, 3.1), (0.0, 0.0), (0.1, 0.0)),
    ("horizontal, fast", (-1.0, 1.6), (8.0, 5.0), (0.0, 0.02)),
    ("swinging up", (2.0, -2.5), (-6.0, 9.0), (-0.2, 0.01)),
)
"""Name, angles (rad), rates (rad/s) and torques (N m) of the states that are compared."""

UPRIGHT = (0.0, math.pi)
"""Angles of the upright position, rad."""

ROUNDING = 1e-12
"""Largest difference over the sum of the magnitudes of all terms: both sides round about 50 operations."""


def case() -> Case:
    """Return the case: accelerations, and the linear model of the upright position, by C and by the paper."""
    system = load("furuta_pendulum")
    library = build("furuta_pendulum", "forward_dynamics")
    values = {parameter.name: parameter.value for parameter in system.parameters}
    rows, printed = [], []
    for name, angles, rates, torques in STATES:
        found = library.forward_dynamics(angles, rates, torques)
        terms = _terms(values, angles, rates, torques)
        expected, size = terms.sum(axis=1), np.abs(terms).sum(axis=1).max()
        rows.append(exact_row(name, "rad/s²", expected, found, ROUNDING * size))
        printed.append(abs(expected[1] - 2 * terms[1, 3] - found[1]))
    upright = kg.linearize(system, UPRIGHT)
    for i, (state, effort) in enumerate(_upright(values)):
        found = [*upright.A[2 + i], *upright.B[2 + i]]
        expected = [*state, *effort]
        size = max(map(abs, expected))
        rows.append(exact_row(f"row {3 + i} of A and B, upright", "SI", expected, found, ROUNDING * size))
    return Case(
        title="The Furuta pendulum",
        model="furuta_pendulum",
        source=(
            "B. S. Cazzolato and Z. Prime, *On the dynamics of the Furuta pendulum*, Journal of Control "
            "Science and Engineering 2011, 528341, equations (33), (34) and (36)."
        ),
        problem=(
            "A motor turns an arm about the vertical; a pendulum swings about the arm. The paper has both "
            "accelerations in closed form, with friction and two torques; `forward_dynamics` in C computes "
            "the same, and `kg.linearize` the linear model (36) of the upright position."
        ),
        allowance=(
            f"Formulas have no digits: the rounding of about 50 operations on either side, {ROUNDING:g} of "
            "the sum of all terms, is allowed."
        ),
        rows=tuple(rows),
        notes=(
            "The sign of one term of (34) is corrected here. Public programs that follow the paper write "
            "-½ sin 2θ₂ [Ĵ₀Ĵ₂ + Ĵ₂² sin² θ₂] θ̇₁²; (33) and Lagrange's equation for θ₂, whose term is -½ "
            "Ĵ₂ sin 2θ₂ θ̇₁² on the left side, need the opposite sign, as the centrifugal force raises a "
            "hanging pendulum. With the sign of those programs θ̈₂ would differ by up to "
            f"{max(printed):.3g} rad/s².",
        ),
    )


def _upright(values: Mapping[str, float]) -> tuple[tuple[list[float], list[float]], ...]:
    """Return the last two rows of A and B in equation (36), about the upright position."""
    J0_hat, J2_hat, coupling = _inertias(values)
    m2, l2, b1, b2, gravity = (values[name] for name in ("m2", "l2", "b1", "b2", "g"))
    determinant = J0_hat * J2_hat - coupling**2
    lifted = gravity * m2 * l2
    first = [0, lifted * coupling, -b1 * J2_hat, -b2 * coupling]
    second = [0, lifted * J0_hat, -b1 * coupling, -b2 * J0_hat]
    inputs = ([J2_hat, coupling], [coupling, J0_hat])
    return tuple(
        ([entry / determinant for entry in row], [entry / determinant for entry in entries])
        for row, entries in zip((first, second), inputs, strict=True)
    )


def _inertias(values: Mapping[str, float]) -> tuple[float, float, float]:
    """Return the paper's J0_hat and J2_hat (kg m^2), and m2 L1 l2, which couples arm and pendulum."""
    m1, l1, L1, J1, m2, l2, J2 = (values[name] for name in "m1 l1 L1 J1 m2 l2 J2".split())
    return J1 + m1 * l1**2 + m2 * L1**2, J2 + m2 * l2**2, m2 * L1 * l2


def _terms(
    values: Mapping[str, float],
    angles: tuple[float, ...],
    rates: tuple[float, ...],
    torques: tuple[float, ...],
) -> np.ndarray:
    """Return the (2, 8) terms of (33) and (34), by five products of rates, two torques and gravity."""
    L1, b1, m2, l2, b2, gravity = (values[name] for name in ("L1", "b1", "m2", "l2", "b2", "g"))
    J0_hat, J2_hat, coupling = _inertias(values)
    sine, cosine, double = np.sin(angles[1]), np.cos(angles[1]), np.sin(2 * angles[1])
    arm = J0_hat + J2_hat * sine**2
    first = [
        -J2_hat * b1,
        coupling * cosine * b2,
        -(J2_hat**2) * double,
        -0.5 * J2_hat * coupling * cosine * double,
        J2_hat * coupling * sine,
        J2_hat,
        -coupling * cosine,
        0.5 * m2**2 * l2**2 * L1 * double,
    ]
    second = [
        coupling * cosine * b1,
        -b2 * arm,
        coupling * J2_hat * cosine * double,
        0.5 * double * J2_hat * arm,
        -0.5 * coupling**2 * double,
        -coupling * cosine,
        arm,
        -m2 * l2 * sine * arm,
    ]
    one, two = rates
    factors = np.array([one, two, one * two, one**2, two**2, *torques, gravity])
    determinant = J0_hat * J2_hat + J2_hat**2 * sine**2 - coupling**2 * cosine**2
    return np.array([first, second]) * factors / determinant
