"""Identities between outputs that hold for every tree: X24 to X27."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

import kanegen as kg
from kanegen.measure import truth
from kanegen.measure.truth.balls import arb, arb_mat, column, ctx
from kanegen.program.precision import Precision
from kanegen.reference.states import random_states
from kanegen.simulation import simulate
from tests.battery import scenes
from tests.battery.experiments import Point, Row, Size, experiment
from tests.battery.measurement import PRECISIONS, Floats, built, efforts, promise, rounded, worst

MOTION = ("forward_dynamics", "momentum")


def floating(bodies: int) -> kg.System:
    """Return a tree without gravity whose root has six freedoms along the inertial axes."""
    rng = np.random.default_rng(24 + bodies)
    free = np.eye(6, dtype=bool)[rng.integers(0, 3, bodies)]
    free[0] = True
    turned = [np.eye(3), *(scenes.rotation(rng) for _ in range(bodies - 1))]
    below = [k // 2 for k in range(1, bodies + 1)]
    return scenes.tree(rng, below, free, joint_orientation=turned, gravity=(0.0, 0.0, 0.0))


@experiment("X24", "Momentum of a free-floating tree")
def momentum(size: Size) -> Iterator[Row]:
    """The rates of momentum that the accelerations imply, with exact [A] and its exact rate, must vanish.

    The translations of the root are along inertial axes, so their rows of [A]{y} are the linear momentum. Its
    theta1 turns about an inertial axis, so that row is the angular momentum along this axis about the origin
    O of the root, whose rate is -v_O x p.
    """
    sizes = size.pick([3], [1, 3, 7, 15])
    for precision in PRECISIONS:
        found: dict[str, list[Point]] = {"linear": [], "angular": []}
        for bodies in sizes:
            system = floating(bodies)
            states = random_states(system, size.pick(2, 4), 24)
            x, y = (np.round(array * 2.0**12) / 2.0**12 for array in (states.x, states.y))
            x[:, 1] = np.clip(x[:, 1], -1, 1)  # away from gimbal lock, which X7 tries
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
    """Return the rates of linear and angular momentum, relative to the magnitudes that are added up."""
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
    """Return the norm of the vector of sums over the norm of the sums of magnitudes."""
    left = np.linalg.norm([float(sum(parts, arb(0))) for parts in components])
    whole = np.linalg.norm([sum(abs(float(part)) for part in parts) for parts in components])
    return float(left / whole)


def _simulated(size: Size) -> Row:
    """Measure the drift of momentum in a simulation with brakes in every joint but that of the root."""
    system = floating(3)
    states = random_states(system, 1, 24)
    states.x[:, :3] = 0.1
    brake = np.array([0.0 if freedom.body == 1 else 0.3 for freedom in system.freedoms])
    seconds = size.pick(0.5, 5.0)
    path = simulate(
        built(system, outputs=MOTION), states.x[0], 0.3 * states.y[0], [0.0, seconds], "DOP853",
        tolerance=1e-12, effort=lambda t, x, y: -brake * y,
    )  # fmt: skip
    figure = max(one.largest for one in path.momentum_drift())
    over = f"{seconds} s, 3 bodies, brakes in the joints; DOP853, {path.evaluations} evaluations"
    return Row("drift over time, double", figure, 1e-10, "1e-10, tolerance 1e-12", over)


STEPS = 6
"""Number of steps to each side of the central difference."""

BITS = 400
"""Precision of ball arithmetic (bit)."""


def _systems(size: Size) -> list[kg.System]:
    rng = np.random.default_rng(25)
    small = [scenes.mixed(3), scenes.tree(rng, [0, 1, 1, 2, 2])]
    return size.pick(small, [*small, scenes.tree(rng, range(16)), scenes.mixed(8)])


@experiment("X25", "Power is the rate of energy")
def power(size: Size) -> Iterator[Row]:
    """Without gravity, y.tau = y.[A]{ydot} + y.[Adot]{y}/2, with the generated {ydot} and the exact [A].

    The rate of the exact [A] along y is a central difference of order 12 in ball arithmetic.
    """
    for precision in PRECISIONS:
        found: list[Point] = []
        for system in _systems(size):
            free = kg.System(system.name, system.bodies, (0.0, 0.0, 0.0))
            states = random_states(free, 2, 25)
            x, y = (np.round(array * 2.0**12) / 2.0**12 for array in (states.x, states.y))
            tau = rounded(efforts(free, states, np.random.default_rng(25)), precision)
            ydot = built(free, precision).forward_dynamics(x, y, tau).astype(np.float64)
            found += [_residual(free, precision, *state) for state in zip(x, y, tau, ydot, strict=True)]
        yield worst(
            precision.name, found, "T(u) of the powers", f"{len(_systems(size))} trees, 2 states each"
        )


def _residual(
    system: kg.System, precision: Precision, x: Floats, y: Floats, tau: Floats, ydot: Floats
) -> Point:
    exact = truth.truth(system, x, y, tau, unit_roundoff=precision.roundoff)
    with ctx.workprec(BITS):
        speed = column(y)
        change = rate(system, x, y)
        parts = [
            (speed.transpose() * exact.equations.A * column(ydot))[0, 0],
            (speed.transpose() * change * speed)[0, 0] / 2,
            -(speed.transpose() * column(tau))[0, 0],
        ]
        error, scale = abs(float(parts[0] + parts[1] + parts[2])), sum(abs(float(part)) for part in parts)
    return Point(0.0, error / scale, promise(exact, precision))


def rate(system: kg.System, x: Floats, y: Floats) -> arb_mat:
    """Return the (n, n) rate of [A] along `y`, a central difference over STEPS steps of 2^-9 s to each
    side."""
    step = 2.0**-9
    n = len(x)
    total = arb_mat(n, n)
    for k, weight in enumerate(_weights(), start=1):
        ahead, behind = (_matrix(system, x + sign * k * step * y) for sign in (1.0, -1.0))
        total += (ahead - behind) * (weight / arb(step))
    return total


def _weights() -> list[arb]:
    """Return the weights of the central difference of order 2 m: (-1)^(k+1) m!^2 / (k (m-k)! (m+k)!), m =
    STEPS."""
    m = arb(STEPS).gamma() * STEPS
    return [
        (-1) ** (k + 1) * m * m / (arb(STEPS - k + 1).gamma() * arb(STEPS + k + 1).gamma() * k)
        for k in range(1, STEPS + 1)
    ]


def _matrix(system: kg.System, x: Floats) -> arb_mat:
    names = ("mass_matrix",)
    return truth.truth(system, x, np.zeros_like(x), outputs=names, unit_roundoff=2.0**-100).equations.A


@experiment("X26", "Accelerations are linear in the efforts")
def linearity(size: Size) -> Iterator[Row]:
    """Accelerations must satisfy [A] (ydot(tau_1) - ydot(tau_2)) = tau_1 - tau_2, with the exact [A]."""
    for precision in PRECISIONS:
        found: list[Point] = []
        for system in _systems(size):
            states = random_states(system, 4, 26).rounded(precision)
            rng = np.random.default_rng(26)
            tau = [rounded(efforts(system, states, rng), precision) for _ in range(2)]
            library = built(system, precision)
            ydot = [library.forward_dynamics(states.x, states.y, t).astype(np.float64) for t in tau]
            for b in range(4):
                both = [truth.truth(system, states.x[b], states.y[b], t[b]) for t in tau]
                right = both[0]["forward_dynamics"].value - both[1]["forward_dynamics"].value
                error = np.linalg.norm(ydot[0][b] - ydot[1][b] - right)
                sizes = [np.linalg.norm(one["forward_dynamics"].value) for one in both]
                limit = max(promise(one, precision) for one in both)
                found.append(Point(0.0, float(error / sum(sizes)), limit))
        yield worst(precision.name, found, "T(u)", f"{len(_systems(size))} trees, 4 states each")


@experiment("X27", "[A] is symmetric, positive definite, and agrees with inverse dynamics")
def mass_matrix(size: Size) -> Iterator[Row]:
    """[A] is scaled to a diagonal of ones, as in every condition number here."""
    for precision in PRECISIONS:
        odd: list[bool] = []
        least: list[Point] = []
        columns: list[Point] = []
        for heavy in _systems(size):
            system = kg.System(heavy.name, heavy.bodies, (0.0, 0.0, 0.0))
            library = built(system, precision, ("mass_matrix", "inverse_dynamics"))
            states = random_states(system, 8, 27)
            for x, a in zip(states.x, library.mass_matrix(states.x), strict=True):
                scaled = _scaled(a.astype(np.float64))
                eigenvalues = np.linalg.eigvalsh(scaled)
                allowed = 4 * system.number_of_bodies * precision.roundoff
                odd.append(bool((a != a.T).any()))
                least.append(Point(0.0, float(-eigenvalues[0] / eigenvalues[-1]), allowed))
                columns.append(Point(0.0, _distance(library, x, a), 10 * 2 * precision.roundoff))
        over = f"{len(odd)} states of {len(_systems(size))} trees"
        yield Row(f"symmetric, {precision.name}", float(sum(odd)), 0.0, "same bits", over)
        yield worst(f"- least over largest eigenvalue, {precision.name}", least, "4 N u", over)
        yield worst(
            f"columns of inverse dynamics, {precision.name}", columns, "10 eps in the norm of [A]", over
        )


def _scaled(a: Floats) -> Floats:
    root = np.sqrt(np.diag(a))
    scaled: Floats = a / np.outer(root, root)
    return scaled


def _distance(library: kg.Library, x: Floats, a: NDArray[np.floating]) -> float:
    """Return the distance of [A] from inverse dynamics of unit accelerations, at rest and without gravity."""
    rows = [library.inverse_dynamics(x, np.zeros(len(x)), unit).astype(np.float64) for unit in np.eye(len(x))]
    root = np.sqrt(np.diag(a).astype(np.float64))
    scale = np.outer(root, root)
    return float(np.linalg.norm((np.array(rows).T - a) / scale) / np.linalg.norm(a / scale))
