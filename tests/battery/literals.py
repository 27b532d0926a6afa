"""Numbers of the model in the text of the C: X30."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kanegen.program.precision import DOUBLE, Precision
from tests.battery import scenes
from tests.battery.measuring import PRECISIONS, Floats, built
from tests.battery.rows import Row, Size, count, subject


@subject("X30", "Numbers in the C")
def literals(size: Size) -> Iterator[Row]:
    """The mass of a body that slides on the ground is its entry of [A]: it must come back whole.

    In single precision a double must be rounded once: next to the midpoint of two floats a second rounding,
    of the decimals, would show.
    """
    for precision in PRECISIONS:
        masses = _masses(precision, size.pick(32, 512))
        system = scenes.planar(
            masses.tolist(),
            connection=[0] * len(masses),
            free=scenes.flags(len(masses), "s1"),
            inertia=np.zeros((len(masses), 3, 3)),
        )
        found = np.diag(built(system, precision, ("mass_matrix",)).mass_matrix(np.zeros(len(masses))))
        over = f"{len(masses)} masses from {masses.min():.0e} to {masses.max():.0e} kg"
        yield count(precision.name, found != masses.astype(precision.dtype), over, "same bits")


def _masses(precision: Precision, amount: int) -> Floats:
    """Random numbers of every size, ends of the range, and doubles next to the middle of two floats."""
    rng = np.random.default_rng(30)
    info = np.finfo(precision.dtype)
    exponents = rng.uniform(info.minexp + 1, info.maxexp - 1, amount)
    ends = [float(info.max), float(info.tiny), 1 / 3, 0.1]
    middle = 1.0 + rng.integers(0, 2**20, amount) * 2.0**-23 + 2.0**-24
    beside = [middle, np.nextafter(middle, 2.0), np.nextafter(middle, 0.0)] if precision is not DOUBLE else []
    masses: Floats = np.concatenate([2.0**exponents, ends, *beside])
    return masses
