"""Trees whose equations are badly conditioned: X4 to X6, X15 and X18."""

from __future__ import annotations

import warnings
from collections.abc import Iterator

import numpy as np

import kanegen as kg
from kanegen.measure.truth import measure
from kanegen.program.precision import Precision
from kanegen.reference import equations as reference
from kanegen.reference.states import random_states
from tests.battery import scenes
from tests.battery.experiments import Point, Row, Size, count, experiment
from tests.battery.measurement import LINEAR, PRECISIONS, PROMISE, built, forward, linear, points, worst

LOST = 1e-2
"""Relative error from which a result counts as wrong."""

REPORTED = 1e-3
"""Relative estimate of the error from which a result counts as reported to be wrong."""

DIAGNOSED = ("forward_dynamics", "error_estimate", "regularity")


@experiment("X4", "Masses that change by a factor from body to body")
def mass_ratios(size: Size) -> Iterator[Row]:
    """Lighter bodies outward lose no accuracy; heavier bodies outward lose by the scaled condition number."""
    ratios = size.pick(
        [1e-3, 1e-1, 10.0, 1e3], [10.0**k for k in range(-3, 4)] + [3e-2, 0.3, 3.0, 30.0, 300.0]
    )
    for precision in PRECISIONS:
        found = {ratio: _ratio(ratio, 8, precision) for ratio in sorted(ratios)}
        doubled = {
            float(n): _ratio(2.0, n, precision) for n in size.pick([4, 12], [4, 8, 16, 24, 32, 48, 64])
        }
        over = f"8 rods, ratios {min(ratios):g} to {max(ratios):g} a link, and factor 2 over longer chains"
        yield worst(f"any ratio, {precision.name}", [p for ps in found.values() for p in ps], PROMISE, over)
        yield worst(f"factor 2, {precision.name}", [p for ps in doubled.values() for p in ps], PROMISE, over)
        light = [ratio for ratio in ratios if ratio < 1]
        shrinking = [p for r in light for p in _ratio(r, 8, precision, lighter=True)]
        yield worst(f"lighter outward, {precision.name}", shrinking, LINEAR, "8 rods, ratios below 1")
        hard = [(r, 8) for r in ratios if r > 1] + [(2.0, n) for n in size.pick([12], [24, 48])]
        silent = [lost for r, n in hard for lost in _silently_lost(r, n, precision)]
        over = f"{len(silent)} states; `error_estimate` below a thousandth"
        yield count(f"wrong by a hundredth and silent, {precision.name}", silent, over, "0 states")


def _silently_lost(ratio: float, bodies: int, precision: Precision) -> list[bool]:
    """Return, for each state, whether the result is wrong and its error estimate does not report it."""
    system = scenes.planar([ratio**i for i in range(bodies)])
    library, states = built(system, precision, DIAGNOSED), random_states(system, 4, bodies)
    sample = states.rounded(precision)
    with warnings.catch_warnings(action="ignore", category=kg.KanegenWarning):
        found = library.forward_dynamics(sample.x, sample.y)
        estimate = library.error_estimate(sample.x, sample.y)
    reported = ~(np.linalg.norm(estimate, axis=1) < REPORTED * np.linalg.norm(found, axis=1))
    measured = measure(system, library, states, outputs=("forward_dynamics",))["forward_dynamics"]
    lost = np.isfinite(found).all(axis=1) & (measured.normwise > LOST) & ~reported
    return [bool(one) for one in lost]


def _ratio(ratio: float, bodies: int, precision: Precision, lighter: bool = False) -> list[Point]:
    """Measure a chain of rods whose masses are powers of `ratio`."""
    system = scenes.planar([ratio**i for i in range(bodies)])
    measured = forward(system, precision, seed=bodies)
    return points(ratio, measured, linear(measured, bodies, precision) if lighter else None)


@experiment("X5", "Two bodies, one much heavier")
def two_bodies(size: Size) -> Iterator[Row]:
    """A light body on a heavy one must not lose accuracy even by the condition number."""
    powers = size.pick([3, 12], [1, 2, 3, 4, 6, 8, 10, 12])
    for precision in PRECISIONS:
        light: list[Point] = []
        heavy: list[Point] = []
        for power in powers:
            measured = forward(scenes.planar([1.0, 10.0**-power]), precision)
            light += points(10.0**-power, measured, linear(measured, 2, precision))
            heavy += points(10.0**power, forward(scenes.planar([1.0, 10.0**power]), precision))
        over = f"ratios 10^{powers[0]} to 10^{powers[-1]}, 4 states each"
        yield worst(f"light outboard, {precision.name}", light, LINEAR, over)
        yield worst(f"heavy outboard, {precision.name}", heavy, PROMISE, over)


ZERO = np.zeros((3, 3))
ROD = np.diag([0.0, 1 / 12, 1 / 12])
PARTS = {
    "massless link that carries a body": ([0.0, 1.0], [ZERO, ROD]),
    "link of 1e-30 kg that carries a body": ([1e-30, 1.0], [1e-30 * ROD, ROD]),
    "point masses": ([1.0, 1.0], [ZERO, ZERO]),
    "slender rods": ([1.0, 1.0], [ROD, ROD]),
    "inertia without mass": ([1.0, 0.0], [ROD, np.eye(3)]),
    "leaf of the size of a rounding": ([1.0, 2.0**-53], [ROD, 2.0**-53 * ROD]),
}
"""Masses (kg) and central inertias (kg m^2) of two links of 1 m."""


@experiment("X6", "Masses and inertias that are zero or nearly so")
def zeros(size: Size) -> Iterator[Row]:
    """Bodies without mass or inertia are computed if [A] is regular, and refused before any code is written
    if not."""
    del size
    for precision in PRECISIONS:
        for name, (mass, inertia) in PARTS.items():
            system = scenes.planar(mass, inertia=inertia)
            found = points(0.0, forward(system, precision, seed=6))
            yield worst(f"{name}, {precision.name}", found, PROMISE, "4 states")
    yield count("massless leaf", [not _refused()], "generation", "an error that names the body")
    yield count("massless at run time", [_finite_when_massless()], "2 states", "NaN and an error")


def _refused() -> bool:
    """Return whether a massless leaf is refused with an error that names its body."""
    try:
        kg.generate(scenes.planar([1.0, 0.0], inertia=[ROD, ZERO]), ("forward_dynamics",))
    except kg.SingularError as error:
        return "body2" in str(error)
    return False


def _finite_when_massless() -> bool:
    """Return whether a leaf whose mass becomes zero as a parameter has finite accelerations or raises no
    error."""
    small = kg.Parameter("m", 1.0)
    system = scenes.planar([1.0, 1.0], mass=(1.0, small), inertia=[ROD, ZERO])
    states = random_states(system, 2)
    with warnings.catch_warnings(action="ignore", category=kg.KanegenWarning):
        library = built(system).with_parameters({"m": 0.0})
        found = library.forward_dynamics(states.x, states.y)
    try:
        library.forward_dynamics(states.x[0], states.y[0])
    except kg.SingularError:
        return bool(np.isfinite(found).any())
    return True


@experiment("X15", "Very different sizes in one tree")
def mixed_scales(size: Size) -> Iterator[Row]:
    """A crane of a kilometre and a thousand tons that holds a gripper of a micrometre and a microgram."""
    del size
    masses, lengths = [1e6, 1e3, 1.0, 1e-4, 1e-9], [1e3, 10.0, 0.1, 1e-3, 1e-6]
    for precision in PRECISIONS:
        found = points(0.0, forward(scenes.planar(masses, lengths), precision, seed=15))
        yield worst(precision.name, found, PROMISE, "5 rods, 4 states")


@experiment("X18", "Efforts that almost balance the tree")
def near_equilibrium(size: Size) -> Iterator[Row]:
    """The efforts are {tau} = -{f} (1 + 10^-k); the error may grow with the cancellation chi and no
    further."""
    system = scenes.tree(np.random.default_rng(18), [0, 1, 1, 2])
    powers = size.pick([0, 4, 8, 16], range(17))
    for precision in PRECISIONS:
        found: list[Point] = []
        for power in powers:
            states = random_states(system, 4, 18).rounded(precision)
            tau = -reference.forcing(system, states.x, states.y) * (1 + 10.0**-power)
            found += points(10.0**-power, forward(system, precision, states, tau))
        over = f"k = 0 to {powers[-1]}, 4 states each; 4 hinges"
        yield worst(precision.name, found, PROMISE, over)
