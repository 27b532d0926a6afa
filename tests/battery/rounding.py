"""The same program with every operation rounded another way: X36."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import kanegen as kg
from kanegen.measure.truth import truth
from kanegen.program.precision import DOUBLE, FLOAT, Precision
from kanegen.reference.states import random_states
from tests.battery import scenes
from tests.battery.drivers import printed
from tests.battery.measuring import PRECISIONS, PROMISE, Floats, efforts, promise, rounded, worst
from tests.battery.rows import Point, Row, Size, subject

MODES = ("nearest", "upward", "downward", "toward zero")
FLAGS = ("-O0", "-ffp-contract=off", "-frounding-math")


@subject("X36", "Other rounding modes")
def rounding_modes(size: Size) -> Iterator[Row]:
    """A directed rounding errs by up to 2 u, twice the nearest one, and the errors of all modes differ.

    So results that lie within 3 T(u) of each other in all four are no accident of the roundings: what an
    instability amplifies would spread further. Sine and cosine are those of the C library, as kanegen's own
    take rounding to nearest for granted.
    """
    # In single precision the promise ends at chains that are not much longer.
    chains = {DOUBLE: scenes.straight(size.pick(8, 64)), FLOAT: scenes.straight(8)}
    trees = {
        "tree of hinges": scenes.tree(np.random.default_rng(36), [k // 2 for k in range(1, 9)]),
        "heavier outward": scenes.planar([10.0**i for i in range(4)]),
    }
    for precision in PRECISIONS:
        for name, system in {"straight chain": chains[precision], **trees}.items():
            found = _spread(system, precision, size.pick(4, 64))
            over = f"{len(found)} states; {', '.join(MODES)}"
            yield worst(f"{name}, {precision.name}", found, f"3 {PROMISE}", over)


def _spread(system: kg.System, precision: Precision, amount: int) -> list[Point]:
    """The largest distance of a mode from the exact result and from the nearest one, per state."""
    states = random_states(system, amount, 36).rounded(precision)
    tau = rounded(efforts(system, states, np.random.default_rng(36)), precision)
    lines = printed("rounding.c", system, precision, states, tau, FLAGS, "libm").splitlines()
    modes = np.array([[float.fromhex(word) for word in line.split()] for line in lines])
    found: Floats = modes.reshape(len(MODES), amount, -1)
    result = []
    for b, (x, y, t) in enumerate(zip(states.x, states.y, tau, strict=True)):
        exact = truth(system, x, y, t, unit_roundoff=precision.roundoff)
        scale = exact.units.of("forward_dynamics")
        whole = np.linalg.norm(exact["forward_dynamics"].value * scale)
        spread = max(np.linalg.norm((found[0, b] - found[m, b]) * scale) for m in range(1, len(MODES)))
        result.append(Point(0.0, float(spread / whole), 3 * promise(exact, precision)))
    return result
