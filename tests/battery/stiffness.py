"""Springs and dampers so stiff that explicit methods must take tiny steps: X22."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

import kanegen as kg
from kanegen.library.simulation import simulate
from kanegen.reference.states import random_states
from tests.battery import scenes
from tests.battery.measuring import PRECISIONS, PROMISE, Floats, built, forward, points, rounded, worst
from tests.battery.rows import Point, Row, Size, count, subject

ENERGIES = ("forward_dynamics", "kinetic_energy", "potential_energy")


@subject("X22", "Stiff springs and dampers")
def stiffness(size: Size) -> Iterator[Row]:
    """Springs are efforts of the caller: tau = -K x. Accelerations keep their bound whatever K.

    An explicit method of order 4 must step below 2 sqrt(2) / omega; it stays bounded just below, and not just
    above. The governor is two arms on a turning shaft, whose slider hangs by spring-dampers of 8e5 N/m and
    4e4 N s/m; what the dampers take must be what the energy loses.
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
    wrong = [_stays(10.0**power, share, steps) != (share < 1) for power in powers for share in (0.98, 1.02)]
    over = f"K = 1 to 1e{powers[-1]} N m/rad, {steps} steps of 0.98 and 1.02 times the limit"
    yield count("limit of the step of RK4", wrong, over, "bounded below, unbounded above")
    yield from _governed(size.pick(0.1, 1.0))


def _stays(stiffness: float, share: float, steps: int) -> bool:
    """Whether RK4 keeps an oscillator below its first amplitude."""
    system = scenes.planar([0.0], inertia=[np.eye(3)], gravity=(0.0, 0.0, 0.0))
    step = share * math.sqrt(8.0 / stiffness)
    path = simulate(
        built(system), [1e-3], [0.0], [0.0, steps * step], step=step, effort=lambda t, x, y: -stiffness * x
    )
    return bool(abs(path.x[-1, 0]) <= 1e-3)


SPRING, DAMPER = 8e5, 4e4
REST = math.sqrt(0.25 + (1 - math.sqrt(0.75) / 2 - 0.5) ** 2 - 3 / 16)
"""Length at which the couplers of the governor hold nothing, m: that of the first state."""


def governor() -> kg.System:
    """A shaft about the vertical, an arm of 1 m with a ball on either side, a slider along the shaft."""
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
    """Spring-dampers between the middle of each arm, at angle phi, and the slider, at height z."""
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


def _governed(seconds: float) -> Iterator[Row]:
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
