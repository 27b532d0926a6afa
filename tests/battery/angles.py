"""Angles that are huge, tiny, or next to where sine and cosine turn: X11 and X12."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np

import kanegen as kg
from kanegen.measure.truth import truth
from kanegen.measure.truth.errors import bits_lost
from kanegen.program.precision import Precision
from kanegen.reference.states import random_states
from tests.battery import scenes
from tests.battery.measuring import PRECISIONS, PROMISE, Floats, built, forward, points, worst
from tests.battery.rows import Point, Row, Size, count, subject


@subject("X11", "Large angles")
def large_angles(size: Size) -> Iterator[Row]:
    """Angles are exact numbers, however large: nothing is lost to their reduction."""
    powers = size.pick([0, 4, 7, 16], list(range(17)))
    system = scenes.tree(np.random.default_rng(11), [0, 1, 1, 3])
    for precision in PRECISIONS:
        found: list[Point] = []
        for power in powers:
            states = random_states(system, 8, power)
            states.x[:] *= 10.0**power
            found += points(10.0**power, forward(system, precision, states))
        over = f"4 hinges, angles up to 10^0 ... 10^{powers[-1]} rad, 8 states each"
        yield worst(precision.name, found, PROMISE, over)


def special(precision: Precision, multiples: int) -> Floats:
    """Zeros, the smallest numbers, and neighbours of multiples of pi/4."""
    kind = precision.dtype.type
    info = np.finfo(precision.dtype)
    tiny = [info.smallest_subnormal, info.tiny, 1e-30, info.eps, info.eps / 2]
    near = np.array([kind(k * np.pi / 4) for k in range(1, multiples)], precision.dtype)
    around = [near, np.nextafter(near, kind(0)), np.nextafter(near, kind(np.inf))]
    positive = np.concatenate([np.array(tiny, precision.dtype), *around])
    angles: Floats = np.concatenate([[0.0], positive, -positive]).astype(np.float64)
    return angles


@subject("X12", "Sine and cosine where they are zero, one or equal")
def sine_and_cosine(size: Size) -> Iterator[Row]:
    """A mass of 1 kg at 1 m, weight 1 N: its {f} is a sine or a cosine and nothing else."""
    multiples = size.pick(40, 300)
    for precision, (name, gravity) in product(PRECISIONS, WEIGHTS.items()):
        system = scenes.planar([1.0], mass_center=[[1.0, 0.0, 0.0]], gravity=gravity)
        library = built(system, precision, ("forcing",))
        x = special(precision, multiples)[:, None]
        right = np.array([_exact(system, row, precision) for row in x])
        single = np.array([library.forcing(row, [0.0]) for row in x])
        for way, found in (("state", single), ("batch", library.forcing(x, np.zeros_like(x)))):
            lost = 2.0 ** bits_lost(found, right) - 1
            curve = [Point(abs(float(at)), float(e), 1.0) for at, e in zip(x[:, 0], lost[:, 0], strict=True)]
            over = f"{len(x)} angles: 0, the least, next to k pi/4 up to k = {multiples}"
            yield worst(f"{name}, {way}, {precision.name}", curve, "1 float from the nearest", over)
            if name == "sine":
                odd = [
                    a != b for a, b in zip(found[1:][: len(x) // 2], -found[1 + len(x) // 2 :], strict=True)
                ]
                yield count(f"odd function, {way}, {precision.name}", odd, over, "same bits")


WEIGHTS = {"sine": (1.0, 0.0, 0.0), "cosine": (0.0, 1.0, 0.0)}


def _exact(system: kg.System, x: Floats, precision: Precision) -> Floats:
    return truth(system, x, [0.0], outputs=("forcing",), unit_roundoff=precision.roundoff)["forcing"].value
