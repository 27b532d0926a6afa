"""Other units, distances from the origin, and speeds: X13, X14, X16 and X17."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

import kanegen as kg
from kanegen.program.precision import DOUBLE, Precision
from kanegen.reference.states import States, random_states
from tests.battery import scenes
from tests.battery.experiments import Point, Row, Size, count, experiment
from tests.battery.measurement import (
    PRECISIONS,
    PROMISE,
    Floats,
    bits,
    built,
    efforts,
    forward,
    points,
    rounded,
    worst,
)


def rescaled(system: kg.System, mass: float, length: float, time: float) -> kg.System:
    """Return the same system in units of mass, length and time that are smaller by these factors."""
    arrays = system.values()
    arrays = replace(
        arrays,
        mass=arrays.mass * mass,
        inertia=arrays.inertia * mass * length * length,
        mass_center=arrays.mass_center * length,
        joint_position=arrays.joint_position * length,
        locked=arrays.locked * [1, 1, 1, length, length, length],
        gravity=arrays.gravity * length / time / time,
    )
    return kg.System.from_arrays(**arrays.rows())


def _arm(system: kg.System, length: float) -> Floats:
    """Return (n,) factors of the coordinates: 1 for angles, `length` for translations."""
    return np.array([1.0 if freedom.is_angle else length for freedom in system.freedoms])


Units = tuple[int, int, int]
"""The exponents of two by which the units of mass, length and time are smaller."""

OUTPUTS = ("mass_matrix", "forcing", "forward_dynamics")


def _results(
    system: kg.System, units: Units, states: States, tau: Floats, precision: Precision
) -> dict[str, NDArray[np.floating]]:
    """Compute every output in other units; {tau} and the states are in the units of `system`."""
    mass, length, time = (2.0**unit for unit in units)
    arm = _arm(system, length)
    x, y = states.x * arm, states.y * arm / time
    effort = tau * (mass * length / time / time) * (length / arm)
    library = built(rescaled(system, mass, length, time), precision, OUTPUTS)
    found = (library.mass_matrix(x), library.forcing(x, y), library.forward_dynamics(x, y, effort))
    return dict(zip(OUTPUTS, found, strict=True))


def _exponents(system: kg.System, units: Units) -> dict[str, NDArray[np.int64]]:
    """Return the exponents of two by which the numbers of each output are larger in other units."""
    mass, length, time = units
    arm = np.array([0 if freedom.is_angle else length for freedom in system.freedoms])
    lever = length - arm
    return {
        "mass_matrix": mass + lever[:, None] + lever,
        "forcing": mass + length - 2 * time + lever,
        "forward_dynamics": arm - 2 * time,
    }


def tried_units(precision: Precision) -> dict[str, list[Units]]:
    """Return the units that are tried: in double, masses of 1e-300 to 1e300 kg, lengths and times of 1e+-150.

    In float the exponents are an eighth, less the range that states, [A] and {f} need above 2^-126.
    """
    mass, length = (996, 498) if precision is DOUBLE else (112, 50)
    return {
        "mass": [(k, 0, 0) for k in (-mass, -7, 9, mass)],
        "length": [(0, k, 0) for k in (-length, -5, 3, length)],
        "time": [(0, 0, k) for k in (-length, -5, 3, length)],
    }


@experiment("X13", "Units changed by powers of two")
def powers_of_two(size: Size) -> Iterator[Row]:
    """A tolerance that has a unit, a flushed subnormal number or a missing factor would change bits."""
    system = scenes.mixed(size.pick(3, 6))
    states = random_states(system, 16, 13)
    tau = efforts(system, states, np.random.default_rng(13))
    for precision in PRECISIONS:
        sample, effort = states.rounded(precision), rounded(tau, precision)
        right = _results(system, (0, 0, 0), sample, effort, precision)
        for quantity, window in tried_units(precision).items():
            chosen = size.pick([window[0], window[-1]], window)
            different = []
            for units in chosen:
                found, larger = _results(system, units, sample, effort, precision), _exponents(system, units)
                different += [
                    bits(found[name]) != bits(np.ldexp(right[name], larger[name])) for name in OUTPUTS
                ]
            factors = ", ".join(f"2^{sum(units)}" for units in chosen)
            over = f"factors {factors}; [A], {{f}} and accelerations in 16 states each"
            yield count(f"{quantity}, {precision.name}", different, over, "same bits")


@experiment("X14", "Units changed by powers of ten")
def powers_of_ten(size: Size) -> Iterator[Row]:
    """Millimetres, grams, milliseconds: each is compared with its own exact results, since numbers are
    rounded anew."""
    system = scenes.mixed(3)
    changes = {"mm": (1.0, 1e3, 1.0), "g": (1e3, 1.0, 1.0), "ms": (1.0, 1.0, 1e3), "km, t": (1e-3, 1e-3, 1.0)}
    for precision in PRECISIONS:
        found: list[Point] = []
        for mass, length, time in changes.values():
            states = random_states(system, size.pick(4, 32), 14)
            arm = _arm(system, length)
            other = States(states.x * arm, states.y * arm / time, None, None)
            found += points(1.0, forward(rescaled(system, mass, length, time), precision, other))
        yield worst(precision.name, found, PROMISE, f"{'; '.join(changes)}; {len(found)} states")


@experiment("X16", "Far from the origin")
def far_away(size: Size) -> Iterator[Row]:
    """The place of the tree must not change a bit, neither by its joint on the ground nor by its
    translations."""
    distances = [10.0**k for k in size.pick([3, 12], range(3, 13))]
    free = scenes.flags(3, "theta3")
    free[0] = True
    rng = np.random.default_rng(16)
    system = scenes.tree(rng, [0, 1, 2], free)
    states = random_states(system, 16, 16)
    for precision in PRECISIONS:
        right = bits(built(system, precision).forward_dynamics(states.x, states.y))
        moved, slid = [], []
        for distance in distances:
            arrays = system.values()
            arrays.joint_position[0] = distance * rng.uniform(-1, 1, 3)
            library = built(kg.System.from_arrays(**arrays.rows()), precision)
            moved.append(bits(library.forward_dynamics(states.x, states.y)) != right)
            x = states.x.copy()
            x[:, -3:] = distance * rng.uniform(-1, 1, (16, 3))
            slid.append(bits(built(system, precision).forward_dynamics(x, states.y)) != right)
        over = f"10^3 to 10^12 m, {len(distances)} distances, 16 states each"
        yield count(f"held elsewhere, {precision.name}", moved, over, "same bits")
        yield count(f"slid away, {precision.name}", slid, over, "same bits")


@experiment("X17", "Speeds from none to the largest")
def speeds(size: Size) -> Iterator[Row]:
    """Without speeds there are no centrifugal forces; a result that overflows must not be finite."""
    system = scenes.mixed(4, gravity=(0.0, 0.0, 0.0))
    for precision in PRECISIONS:
        most, least = (100, -300) if precision is DOUBLE else (12, -35)
        library = built(system, precision)
        x, y = random_states(system, 8, 17).x, random_states(system, 8, 18).y
        slow = [library.forward_dynamics(x, y * factor) for factor in (0.0, 10.0**least)]
        moving = [np.any(found != 0.0) for found in slow]
        yield count(f"none, {precision.name}", moving, f"8 states, factors 0 and 1e{least}", "exactly 0")
        found: list[Point] = []
        for power in size.pick([0, most // 2, most], range(0, most + 1, 4)):
            states = States(x, y * 10.0**power, None, None)
            found += points(10.0**power, forward(system, precision, states))
        yield worst(f"large, {precision.name}", found, PROMISE, f"factors 1 to 1e{most}, 8 states each")
        beyond = 10.0 ** (200 if precision is DOUBLE else 30)
        with warnings.catch_warnings(action="ignore", category=kg.KanegenWarning):
            wild = library.forward_dynamics(x, y * beyond)
        over = f"8 states, factor {beyond:.0e}: every result has overflowed"
        yield count(
            f"beyond, {precision.name}", [np.isfinite(row).any() for row in wild], over, "no finite result"
        )
