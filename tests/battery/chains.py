"""Long chains and wide trees: X1 to X3."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kanegen.measure.truth import Measurement, bound
from kanegen.program.precision import Precision
from kanegen.reference.states import States, random_states
from tests.battery import scenes
from tests.battery.experiments import Point, Row, Size, experiment
from tests.battery.measurement import (
    LINEAR,
    PRECISIONS,
    PROMISE,
    Floats,
    efforts,
    forward,
    linear,
    points,
    worst,
)


@experiment("X1", "Straight chain")
def straight_chain(size: Size) -> Iterator[Row]:
    """The condition number of [A] grows like N^4, but recursion over the bodies loses no accuracy by it."""
    lengths = size.pick([1, 8, 32], [1, 2, 4, 8, 16, 32, 64, 128, 256])
    for precision in PRECISIONS:
        found: list[Point] = []
        for bodies in lengths:
            system, rng = scenes.straight(bodies), np.random.default_rng(bodies)
            states = States(np.zeros((4, bodies)), rng.normal(size=(4, bodies)), None, None)
            measured = forward(system, precision, states, rng.normal(size=(4, bodies)))
            found += points(bodies, measured, linear(measured, bodies, precision))
        over = f"{len(lengths)} lengths N = 1 to {lengths[-1]}, 4 random speeds and efforts each"
        yield worst(precision.name, found, LINEAR, over)


@experiment("X2", "Random chains of hinges on random axes")
def random_chains(size: Size) -> Iterator[Row]:
    """Orientations, arms and inertias are random, too."""
    lengths = size.pick([3, 12], [2, 3, 4, 6, 8, 12, 16, 20, 24, 32, 64])
    for precision in PRECISIONS:
        found = [point for n in lengths for point in _chain(n, precision)]
        over = f"{len(lengths)} chains of {lengths[0]} to {lengths[-1]} bodies, 4 states each"
        yield worst(precision.name, found, PROMISE, over)


def _chain(bodies: int, precision: Precision) -> list[Point]:
    system = scenes.tree(np.random.default_rng(bodies), range(bodies))
    return points(bodies, forward(system, precision, seed=bodies))


@experiment("X3", "Trees: binary, star, caterpillar, roots with six freedoms")
def trees(size: Size) -> Iterator[Row]:
    """The limit of the star is that of two bodies, however many leaves it has."""
    sizes = size.pick([8], [7, 31])
    for precision in PRECISIONS:
        for shape, connect in scenes.SHAPES.items():
            found: list[Point] = []
            for bodies in sizes:
                rng = np.random.default_rng(bodies)
                free = np.eye(6, dtype=bool)[rng.integers(0, 3, bodies)]
                free[0] = True
                system = scenes.tree(rng, connect(bodies), free)
                states = random_states(system, 4, bodies)
                states.x[:, 1] = rng.uniform(-1, 1, 4)  # away from gimbal lock, which is X7
                measured = forward(system, precision, states, efforts(system, states, rng))
                found += points(
                    bodies, measured, _limit_of_two_bodies(measured, precision) if shape == "star" else None
                )
            rule = PROMISE + (" with N = 2" if shape == "star" else "")
            over = f"{' , '.join(map(str, sizes))} bodies, 4 states each".replace(" ,", ",")
            yield worst(f"{shape}, {precision.name}", found, rule, over)


def _limit_of_two_bodies(measured: Measurement, precision: Precision) -> Floats:
    """Return (B,) T(u) for two bodies, the root and one leaf."""
    rows = zip(measured.chi, measured.kappa_s, measured.formation, strict=True)
    return np.array([bound(precision.roundoff, 2, *row) for row in rows])
