"""Simulated motions: stiff springs and long times: X22 and X23."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from scipy.special import ellipj, ellipk, ellipkm1

import kanegen as kg
from kanegen.program.precision import precision_named
from kanegen.reference.states import random_states
from kanegen.simulation import simulate
from tests.battery import scenes
from tests.battery.experiments import Point, Row, Size, count, experiment
from tests.battery.measurement import PRECISIONS, PROMISE, Floats, built, forward, points, rounded, worst

ENERGIES = ("forward_dynamics", "kinetic_energy", "potential_energy")


@experiment("X22", "Stiff springs and dampers")
def stiffness(size: Size) -> Iterator[Row]:
    """Springs are efforts tau = -K x of the caller; accelerations keep their bound for every stiffness K.

    An explicit method of order 4 needs steps below 2 sqrt(2) / omega: its solution must stay bounded just
    below this limit and must not just above it. The governor has two arms on a turning shaft and a slider on
    spring-dampers of 8e5 N/m and 4e4 N s/m; the loss of energy must equal the work of the dampers.
    """
    powers = size.pick([0, 6, 12], range(13))
    system = scenes.planar([1.0, 1.0, 1.0])
    for precision in PRECISIONS:
        found: list[Point] = []
        for power in powers:
            states = random_states(system, 4, 22).rounded(precision)
            tau = rounded(-(10.0**power) * states.x, precision)
            found += points(10.0**power, forward(system, precision, states, tau))
        over = f"K = 1 to 1e{powers[-1]} N m/rad, 3 rods, 4 states each"
        yield worst(f"accelerations, {precision.name}", found, PROMISE, over)
    steps = size.pick(300, 2000)
    wrong = [
        _stays_bounded(10.0**power, share, steps) != (share < 1) for power in powers for share in (0.98, 1.02)
    ]
    over = f"K = 1 to 1e{powers[-1]} N m/rad, {steps} steps of 0.98 and 1.02 times the limit"
    yield count("limit of the step of RK4", wrong, over, "bounded below, unbounded above")
    yield from _governor_rows(size.pick(0.1, 1.0))


def _stays_bounded(stiffness: float, share: float, steps: int) -> bool:
    """Return whether RK4 keeps an oscillator below its initial amplitude."""
    system = scenes.planar([0.0], inertia=[np.eye(3)], gravity=(0.0, 0.0, 0.0))
    step = share * math.sqrt(8.0 / stiffness)
    path = simulate(
        built(system), [1e-3], [0.0], [0.0, steps * step], step=step, effort=lambda t, x, y: -stiffness * x
    )
    return bool(abs(path.x[-1, 0]) <= 1e-3)


SPRING, DAMPER = 8e5, 4e4
REST = math.sqrt(0.25 + (1 - math.sqrt(0.75) / 2 - 0.5) ** 2 - 3 / 16)
"""Length (m) of the unloaded couplers of the governor, which is their initial length."""


def governor() -> kg.System:
    """Return a vertical shaft with an arm of 1 m and a ball on either side, and a slider along the shaft."""
    freedoms = ["theta3", "theta1", "theta1", "s3"]
    hinge, ball = [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]
    return kg.System.from_arrays(
        connection=[0, 1, 1, 1],
        mass=[20.0, 5.0, 5.0, 10.0],
        inertia=[np.diag(d) for d in ([2.0, 2.0, 0.5], *[[0.1, 0.1, 0.05]] * 2, [0.2, 0.2, 0.1])],
        mass_center=[[0.0, 0.0, 0.5], ball, ball, [0.0, 0.0, 0.0]],
        joint_position=[[0.0, 0.0, 0.0], hinge, hinge, [0.0, 0.0, 0.0]],
        free=np.vstack([scenes.flags(1, name) for name in freedoms]),
        gravity=(0.0, 0.0, -9.81),
        name="governor",
    )


def couplers(time: float, x: Floats, y: Floats) -> Floats:
    """Return the efforts of spring-dampers between the middle of each arm and the slider."""
    del time
    tau = np.zeros(4)
    height, lift = x[3], y[3]
    for arm in (1, 2):
        s, c = math.sin(x[arm]), math.cos(x[arm])
        rise = 1.0 - 0.5 * c - height
        length = math.hypot(0.5 * s, rise)
        by_angle, by_height = (0.25 * s * c + rise * 0.5 * s) / length, -rise / length
        pull = SPRING * (length - REST) + DAMPER * (by_angle * y[arm] + by_height * lift)
        tau[arm] -= pull * by_angle
        tau[3] -= pull * by_height
    return tau


def _governor_rows(seconds: float) -> Iterator[Row]:
    library = built(governor(), outputs=ENERGIES)
    x, y = [0.0, math.pi / 6, -math.pi / 6, 0.5], [2 * math.pi, 0.0, 0.0, 0.0]
    times = np.linspace(0.0, seconds, 11)
    runs = {
        name: simulate(library, x, y, times, name, tolerance=tolerance, effort=couplers)
        for name, tolerance in (("Radau", 1e-9), ("DOP853", 1e-12))
    }
    evaluations = ", ".join(f"{name} {run.evaluations}" for name, run in runs.items())
    over = f"{seconds} s; evaluations: {evaluations}"
    for name, run in runs.items():
        yield Row(f"governor, energy and work, {name}", run.energy_drift.largest, 1e-6, "1e-6", over)
    apart = 10.0 ** -runs["Radau"].mescd(runs["DOP853"])
    yield Row("governor, Radau from DOP853", apart, 1e-6, "1e-6, mixed error", over)


GRAVITY = 9.81


def pendulum() -> kg.System:
    """Return a point mass of 1 kg at 1 m from a hinge, which starts horizontal and at rest."""
    return scenes.planar([1.0], mass_center=[[1.0, 0.0, 0.0]], inertia=np.zeros((1, 3, 3)))


def swing(times: Floats) -> Floats:
    """Return theta3 of the pendulum: sin(phi / 2) = k sn(K - t sqrt(g)), k^2 = 1/2, phi from the lowest
    point."""
    quarter = ellipk(0.5)
    late = np.remainder(math.sqrt(GRAVITY) * times, 4 * quarter)
    sine = ellipj(quarter - late, 0.5)[0]
    angle: Floats = 2 * np.arcsin(math.sqrt(0.5) * sine) - math.pi / 2
    return angle


@experiment("X23", "Motions that last")
def long_time(size: Size) -> Iterator[Row]:
    """A pendulum is compared with elliptic functions, a spinning and a flipping rotor with Euler's solution.

    The limits of the pendulum are those of benchmark A01 of the IFToMM library, 0.1 m at low and 1 mm at high
    precision over 2000 s; the error formula of that benchmark is not used.
    """
    seconds = size.pick(10.0, 2000.0)
    for case, options in PENDULUMS.items():
        precision = case.split()[-1]
        span = seconds if precision == "double" else min(seconds, 400.0)
        yield _pendulum(case, precision, span, options)
    yield from _spinning(size)
    yield from _flipping(size)


PENDULUMS: dict[str, dict[str, Any]] = {
    "RK4, step 5 ms, double": {"step": 5e-3},
    "DOP853, tolerance 1e-12, double": {"method": "DOP853", "tolerance": 1e-12},
    "RK4, step 5 ms, float": {"step": 5e-3},
    "RK4, step 5 ms, compensated, float": {"step": 5e-3, "compensated": True},
}
LIMITS = {"RK4, step 5 ms, float": 1e-1}
"""Limits of the distance (m) that are not 1 mm."""


def _pendulum(case: str, precision: str, seconds: float, options: dict[str, Any]) -> Row:
    times = np.linspace(0.0, seconds, max(21, round(2 * seconds) + 1))
    path = simulate(built(pendulum(), precision_named(precision)), [0.0], [0.0], times, **options)
    apart = 2 * np.abs(np.sin((path.x[:, 0].astype(np.float64) - swing(times)) / 2))
    limit = LIMITS.get(case, 1e-3)
    pairs = zip(times[1:].tolist(), np.maximum.accumulate(apart)[1:].tolist(), strict=True)
    curve = [Point(time, figure, limit) for time, figure in pairs]
    over = f"{seconds:g} s, {path.evaluations} evaluations; distance of the mass, m"
    return worst(case, curve, f"{limit:g} m", over)


ROTATION = ("coordinate_rates", "forward_dynamics", "kinetic_energy", "potential_energy", "momentum")


def rotor(*moments: float) -> kg.System:
    """Return a rotating free body whose speeds are the body components of its angular velocity."""
    system = scenes.planar(
        [1.0],
        mass_center=np.zeros((1, 3)),
        inertia=[np.diag(moments)],
        free=scenes.flags(1, "theta1", "theta2", "theta3"),
        gravity=(0.0, 0.0, 0.0),
    )
    return system.with_speeds("angular_velocity")


def _spinning(size: Size) -> Iterator[Row]:
    """Compare a symmetric rotor, whose angular velocity circles about its axis at a constant rate in the
    body."""
    turns = size.pick(5, 1000)
    spin, tilt = 2 * math.pi, 0.3
    times = np.linspace(0.0, turns, 5 * turns + 1)
    library = built(rotor(1.0, 1.0, 2.0), outputs=ROTATION)
    path = simulate(library, np.zeros(3), [tilt, 0.0, spin], times, "DOP853", tolerance=1e-13)
    phase = spin * times
    exact = np.stack([tilt * np.cos(phase), tilt * np.sin(phase), np.full_like(phase, spin)], axis=1)
    over = f"{turns} turns, {path.evaluations} evaluations of DOP853 at 1e-13"
    yield from _rotor_rows("spinner", path.y - exact, path.momentum_drift(linear=1.0)[1].largest, over)


def _flipping(size: Size) -> Iterator[Row]:
    """Compare a rotor that spins about its middle axis, axis 3, and flips again and again (Dzhanibekov)."""
    least, middle, most = 1.0, size.pick(1.1, 1.0 + 1e-6), 2.0
    nudge = size.pick(1e-2, 1e-5)
    energy, square = middle + most * nudge**2, middle**2 + (most * nudge) ** 2
    inner, outer = square - energy * least, energy * most - square
    rate = math.sqrt((most - middle) * inner / (least * middle * most))
    rest = (most - least) * (square - energy * middle) / ((most - middle) * inner)
    flip = 2 * ellipkm1(rest) / rate
    times = np.linspace(0.0, 1.5 * flip, 200)
    library = built(rotor(most, least, middle), outputs=ROTATION)
    path = simulate(library, np.zeros(3), [nudge, 0.0, -1.0], times, "DOP853", tolerance=1e-13)
    sn, cn, dn, _ = ellipj(rate * times - ellipkm1(rest), 1 - rest)
    sizes = [
        inner / (most * (most - least)),
        outer / (least * (most - least)),
        outer / (middle * (most - middle)),
    ]
    exact = np.sqrt(sizes) * np.stack([dn, cn, sn], axis=1)
    over = (
        f"moments {least:g} : {middle!r} : {most:g}, a flip after {flip / 2 / math.pi:.0f} turns, 1.5 flips"
    )
    over += f", {path.evaluations} evaluations of DOP853 at 1e-13"
    yield from _rotor_rows("Dzhanibekov", path.y - exact, path.momentum_drift(linear=1.0)[1].largest, over)


def _rotor_rows(case: str, error: Floats, drift: float, over: str) -> Iterator[Row]:
    """Yield the errors of the angular velocity and of the angular momentum in inertial axes."""
    yield Row(f"{case}, angular velocity", float(np.abs(error).max()), 1e-6, "1e-6 rad/s", over)
    yield Row(f"{case}, angular momentum", drift, 1e-9, "1e-9 of itself", over)
