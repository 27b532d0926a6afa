"""Motions that last: X23."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from scipy.special import ellipj, ellipk, ellipkm1

import kanegen as kg
from kanegen.library.simulation import simulate
from kanegen.program.precision import precision_named
from tests.battery import scenes
from tests.battery.measuring import Floats, built, worst
from tests.battery.rows import Point, Row, Size, subject

GRAVITY = 9.81


def pendulum() -> kg.System:
    """A point mass of 1 kg, 1 m from a hinge; it starts level and at rest."""
    return scenes.planar([1.0], mass_center=[[1.0, 0.0, 0.0]], inertia=np.zeros((1, 3, 3)))


def swing(times: Floats) -> Floats:
    """Its theta3: sin(phi / 2) = k sn(K - t sqrt(g)), k^2 = 1/2, the angle phi being from below."""
    quarter = ellipk(0.5)
    late = np.remainder(math.sqrt(GRAVITY) * times, 4 * quarter)
    sine = ellipj(quarter - late, 0.5)[0]
    angle: Floats = 2 * np.arcsin(math.sqrt(0.5) * sine) - math.pi / 2
    return angle


@subject("X23", "Motions that last")
def long_time(size: Size) -> Iterator[Row]:
    """A pendulum against elliptic functions; a spinner and Dzhanibekov's against Euler's solution.

    The limits of the pendulum are those of the benchmark A01 of the IFToMM library, 0.1 m at low and 1 mm at
    high precision over 2000 s; its own formula for errors is not used.
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
"""Of the distance, m, where it is not 1 mm."""


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
    """A free body at rest but for its rotation, whose speeds are its angular velocity in the body."""
    system = scenes.planar(
        [1.0],
        mass_center=np.zeros((1, 3)),
        inertia=[np.diag(moments)],
        free=scenes.flags(1, "theta1", "theta2", "theta3"),
        gravity=(0.0, 0.0, 0.0),
    )
    return system.with_speeds("angular_velocity")


def _spinning(size: Size) -> Iterator[Row]:
    """A symmetric rotor: in the body its angular velocity circles about the axis at a constant rate."""
    turns = size.pick(5, 1000)
    spin, tilt = 2 * math.pi, 0.3
    times = np.linspace(0.0, turns, 5 * turns + 1)
    library = built(rotor(1.0, 1.0, 2.0), outputs=ROTATION)
    path = simulate(library, np.zeros(3), [tilt, 0.0, spin], times, "DOP853", tolerance=1e-13)
    phase = spin * times
    exact = np.stack([tilt * np.cos(phase), tilt * np.sin(phase), np.full_like(phase, spin)], axis=1)
    over = f"{turns} turns, {path.evaluations} evaluations of DOP853 at 1e-13"
    yield from _judged("spinner", path.y - exact, path.momentum_drift(linear=1.0)[1].largest, over)


def _flipping(size: Size) -> Iterator[Row]:
    """Dzhanibekov's: spun about the middle axis, which is axis 3, it turns over again and again."""
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
    yield from _judged("Dzhanibekov", path.y - exact, path.momentum_drift(linear=1.0)[1].largest, over)


def _judged(case: str, error: Floats, drift: float, over: str) -> Iterator[Row]:
    """Angular velocity against Euler's solution, and the angular momentum in inertial axes."""
    yield Row(f"{case}, angular velocity", float(np.abs(error).max()), 1e-6, "1e-6 rad/s", over)
    yield Row(f"{case}, angular momentum", drift, 1e-9, "1e-9 of itself", over)
