"""A search for states in which the bound fails: X35."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

import kanegen as kg
from kanegen.measure.truth import measure
from kanegen.program.precision import Precision
from kanegen.reference.states import States, random_states
from tests.battery import scenes
from tests.battery.measuring import PRECISIONS, PROMISE, Floats, built, efforts, rounded
from tests.battery.rows import Row, Size, subject
from tests.battery.worst import WORST

TOGETHER = 16
"""States that are tried around the worst one at a time."""

COARSE, FINE = 0.0, -12.0
"""Powers of ten between which the sizes of changes lie, relative to the numbers that are changed."""


@dataclass(frozen=True)
class Found:
    """A state {x}, {y}, {tau} in one row, and its error over its bound."""

    state: Floats
    share: float

    def words(self) -> str:
        """The numbers as C writes them without loss."""
        return " ".join(float(number).hex() for number in self.state)


@subject("X35", "A search for worse states")
def worse_states(size: Size) -> Iterator[Row]:
    """Hill climbing from the worst of random states and from the worst that earlier searches have found.

    The share of T(u) that an error takes is pushed upward by random changes of coordinates, speeds and
    efforts, large and tiny. That no state exceeds it is no proof.
    """
    tries = size.pick(4, 30, nightly=6_000)
    for precision in PRECISIONS:
        for name, system in _scenes().items():
            case = f"{name}, {precision.name}"
            found = climbed(system, precision, tries, WORST.get(case))
            over = f"{(tries + 4) * TOGETHER} states; the worst: {found.words()}"
            yield Row(case, found.share, 1.0, f"error over {PROMISE}", over)


def _scenes() -> dict[str, kg.System]:
    """Small, so that the worst state can be printed."""
    return {
        "3 rods": scenes.straight(3),
        "3 hinges": scenes.tree(np.random.default_rng(35), range(3), scenes.flags(3, "theta2")),
        "a body with six freedoms": scenes.tree(np.random.default_rng(35), [0], scenes.flags(1, *_ALL)),
    }


_ALL = ("theta1", "theta2", "theta3", "s1", "s2", "s3")


def climbed(system: kg.System, precision: Precision, tries: int, known: str | None) -> Found:
    """The worst state after so many rounds."""
    rng = np.random.default_rng(35)
    states = random_states(system, 4 * TOGETHER, 35).rounded(precision)
    tau = efforts(system, states, rng)
    best = _worst(system, precision, np.hstack([states.x, states.y, tau]))
    if known is not None:
        recorded = np.array([[float.fromhex(word) for word in known.split()]])
        best = max(best, _worst(system, precision, recorded), key=_share)
    for _ in range(tries):
        best = max(best, _worst(system, precision, _around(best.state, rng)), key=_share)
    return best


def _share(found: Found) -> float:
    return found.share


def _around(state: Floats, rng: np.random.Generator) -> Floats:
    """(TOGETHER, 3 n) states: some of the numbers changed, by sizes drawn over many powers of ten."""
    sizes = 10.0 ** rng.uniform(FINE, COARSE, (TOGETHER, 1))
    chosen = rng.random((TOGETHER, len(state))) < rng.uniform(0.1, 1.0, (TOGETHER, 1))
    changed: Floats = state + chosen * sizes * rng.normal(size=chosen.shape) * (np.abs(state) + 0.1)
    return changed


def _worst(system: kg.System, precision: Precision, rows: Floats) -> Found:
    """The state whose error takes the largest share; where nothing is promised none is taken."""
    rows = rounded(rows, precision)
    x, y, tau = np.split(rows, 3, axis=1)
    states = States(np.ascontiguousarray(x), np.ascontiguousarray(y), None, None)
    measured = measure(system, built(system, precision), states, tau)["forward_dynamics"]
    shares = measured.normwise / measured.bound
    shares = np.where(np.isnan(shares), np.inf, shares)
    place = int(np.argmax(shares))
    return Found(rows[place], float(shares[place]))
