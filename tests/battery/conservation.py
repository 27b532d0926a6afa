"""What no effort inside a tree can change: X24."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import kanegen as kg
from kanegen.library.simulation import simulate
from kanegen.measure import truth
from kanegen.measure.truth.balls import arb, column, ctx
from kanegen.reference.states import random_states
from tests.battery import scenes
from tests.battery.identities import BITS, rate
from tests.battery.measuring import PRECISIONS, Floats, built, efforts, rounded, worst
from tests.battery.rows import Point, Row, Size, subject

OUTPUTS = ("forward_dynamics", "momentum")


def floating(bodies: int) -> kg.System:
    """A tree whose root has six freedoms along the inertial axes, without gravity."""
    rng = np.random.default_rng(24 + bodies)
    free = np.eye(6, dtype=bool)[rng.integers(0, 3, bodies)]
    free[0] = True
    turned = [np.eye(3), *(scenes.rotation(rng) for _ in range(bodies - 1))]
    below = [k // 2 for k in range(1, bodies + 1)]
    return scenes.tree(rng, below, free, joint_orientation=turned, gravity=(0.0, 0.0, 0.0))


@subject("X24", "Momentum of a tree that nothing holds")
def momentum(size: Size) -> Iterator[Row]:
    """The rates of momentum that the accelerations imply, [A] and its rate being exact: all must cancel.

    The root's translations are along inertial axes, so their rows of [A]{y} are the linear momentum; theta1
    turns about an inertial axis, so its row is the angular momentum about the root's origin O along it, and
    that changes by -v_O x p.
    """
    sizes = size.pick([3], [1, 3, 7, 15])
    for precision in PRECISIONS:
        found: dict[str, list[Point]] = {"linear": [], "angular": []}
        for bodies in sizes:
            system = floating(bodies)
            states = random_states(system, size.pick(2, 4), 24)
            x, y = (np.round(array * 2.0**12) / 2.0**12 for array in (states.x, states.y))
            x[:, 1] = np.clip(x[:, 1], -1, 1)  # away from gimbal lock, which is X7
            tau = rounded(efforts(system, states, np.random.default_rng(24)), precision)
            tau[:, [i for i, freedom in enumerate(system.freedoms) if freedom.body == 1]] = 0.0
            ydot = built(system, precision).forward_dynamics(x, y, tau).astype(np.float64)
            for state in zip(x, y, ydot, strict=True):
                for name, residual in _residuals(system, *state).items():
                    found[name].append(Point(bodies, residual, 100 * bodies * precision.roundoff))
        over = f"{', '.join(map(str, sizes))} bodies, efforts between them; {len(found['linear'])} states"
        for name, curve in found.items():
            yield worst(f"rate of {name} momentum, {precision.name}", curve, "100 N u", over)
    yield _simulated(size)


def _residuals(system: kg.System, x: Floats, y: Floats, ydot: Floats) -> dict[str, float]:
    """What does not cancel in the rates, relative to what is added up."""
    exact = truth.truth(system, x, y, outputs=("mass_matrix",))
    places = [i for i, freedom in enumerate(system.freedoms) if freedom.body == 1]
    angle, slides = places[0], places[3:]
    with ctx.workprec(BITS):
        gained = exact.equations.A * column(ydot)
        turned = rate(system, x, y) * column(y)
        carried = exact.equations.A * column(y)
        linear = [[gained[i, 0], turned[i, 0]] for i in slides]
        (_, two, three), speed = slides, y
        lever = [arb(speed[two]) * carried[three, 0], -arb(speed[three]) * carried[two, 0]]
        angular = [[gained[angle, 0], turned[angle, 0], *lever]]
        return {"linear": _share(linear), "angular": _share(angular)}


def _share(components: list[list[arb]]) -> float:
    """Length of the vector of sums over that of the sums of magnitudes."""
    left = np.linalg.norm([float(sum(parts, arb(0))) for parts in components])
    whole = np.linalg.norm([sum(abs(float(part)) for part in parts) for parts in components])
    return float(left / whole)


def _simulated(size: Size) -> Row:
    """Momentum over a second or ten, with efforts that brake every joint but the root's."""
    system = floating(3)
    states = random_states(system, 1, 24)
    states.x[:, :3] = 0.1
    brake = np.array([0.0 if freedom.body == 1 else 0.3 for freedom in system.freedoms])
    seconds = size.pick(0.5, 5.0)
    path = simulate(
        built(system, outputs=OUTPUTS), states.x[0], 0.3 * states.y[0], [0.0, seconds], "DOP853",
        tolerance=1e-12, effort=lambda t, x, y: -brake * y,
    )  # fmt: skip
    figure = max(one.largest for one in path.momentum_drift())
    over = f"{seconds} s, 3 bodies, brakes in the joints; DOP853, {path.evaluations} evaluations"
    return Row("drift over time, double", figure, 1e-10, "1e-10, tolerance 1e-12", over)
