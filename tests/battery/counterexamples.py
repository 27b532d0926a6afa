"""A search for states in which the bound on the error fails: X35."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

import kanegen as kg
from kanegen.measure.truth import measure
from kanegen.program.precision import Precision
from kanegen.reference.states import States, random_states
from tests.battery import scenes
from tests.battery.experiments import Row, Size, experiment
from tests.battery.measurement import PRECISIONS, PROMISE, Floats, built, efforts, rounded

TOGETHER = 16
"""Number of states that are tried at once around the worst state."""

COARSE, FINE = 0.0, -12.0
"""Exponents of ten of the largest and the smallest relative change of a number."""


@dataclass(frozen=True)
class Found:
    """A state {x}, {y}, {tau} in one row, and the ratio of its error to its bound."""

    state: Floats
    share: float

    def text(self) -> str:
        """Return the numbers in hexadecimal, without loss."""
        return " ".join(float(number).hex() for number in self.state)


@experiment("X35", "A search for worse states")
def worse_states(size: Size) -> Iterator[Row]:
    """Hill climbing starts at the worst of random states and at the worst state that earlier searches found.

    Random changes of coordinates, speeds and efforts, large and tiny, increase the ratio of the error to
    T(u). That no state exceeds 1 is no proof.
    """
    tries = size.pick(4, 30, nightly=6_000)
    for precision in PRECISIONS:
        for name, system in _scenes().items():
            case = f"{name}, {precision.name}"
            found = climbed(system, precision, tries, WORST.get(case))
            over = f"{(tries + 4) * TOGETHER} states; the worst: {found.text()}"
            yield Row(case, found.share, 1.0, f"error over {PROMISE}", over)


def _scenes() -> dict[str, kg.System]:
    """Return trees that are small enough to print the worst state."""
    return {
        "3 rods": scenes.straight(3),
        "3 hinges": scenes.tree(np.random.default_rng(35), range(3), scenes.flags(3, "theta2")),
        "a body with six freedoms": scenes.tree(np.random.default_rng(35), [0], scenes.flags(1, *_ALL)),
    }


_ALL = ("theta1", "theta2", "theta3", "s1", "s2", "s3")


def climbed(system: kg.System, precision: Precision, tries: int, known: str | None) -> Found:
    """Return the worst state after `tries` rounds, starting also at the `known` one."""
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
    """Return (TOGETHER, 3 n) states with some numbers changed, by many powers of ten."""
    sizes = 10.0 ** rng.uniform(FINE, COARSE, (TOGETHER, 1))
    chosen = rng.random((TOGETHER, len(state))) < rng.uniform(0.1, 1.0, (TOGETHER, 1))
    changed: Floats = state + chosen * sizes * rng.normal(size=chosen.shape) * (np.abs(state) + 0.1)
    return changed


def _worst(system: kg.System, precision: Precision, rows: Floats) -> Found:
    """Return the state with the largest ratio of error to bound; the ratio is 0 where there is no bound."""
    rows = rounded(rows, precision)
    x, y, tau = np.split(rows, 3, axis=1)
    states = States(np.ascontiguousarray(x), np.ascontiguousarray(y), None, None)
    measured = measure(system, built(system, precision), states, tau)["forward_dynamics"]
    shares = measured.normwise / measured.bound
    shares = np.where(np.isnan(shares), np.inf, shares)
    place = int(np.argmax(shares))
    return Found(rows[place], float(shares[place]))


WORST: dict[str, str] = {
    "3 rods, double": (
        "-0x1.f1c372a05d9b9p-2 0x1.aa607df4a79dbp-1 -0x1.1a9b0fdb4e929p+1 0x1.56fccf389280fp-2 "
        "-0x1.a59bef9a06792p-1 -0x1.ff8ff0658719ap+1 -0x1.87918dafc179cp+3 0x1.0035e2a1c3cc3p+0 "
        "-0x1.2af92f958cee4p+1"
    ),
    "3 hinges, double": (
        "0x1.055950ad014c3p+1 -0x1.2587f64cdc01bp+1 0x1.78cd85c09ca07p+0 -0x1.25cfc9857bff2p-1 "
        "-0x1.a97893b803712p+0 0x1.70d3b67d3de30p-3 0x1.bd6aa3f24aa57p+4 -0x1.85133bcec898cp+3 "
        "0x1.0e63255238c6cp+0"
    ),
    "a body with six freedoms, double": (
        "-0x1.2c2f674c94f9ep+1 -0x1.5232b559f097dp-7 0x1.22a86a78b1c3ep+1 0x1.28a5af558ce35p-2 "
        "-0x1.700cec671d6d3p-1 0x1.0b5b2b990b338p-1 0x1.3d351c1aafb7dp+1 -0x1.78a88921b120dp+1 "
        "0x1.6201431ed132bp+1 0x1.5353650e0c1f1p+1 -0x1.6d3498576d2d9p+1 -0x1.1078e734fc2f3p-2 "
        "-0x1.9efd7c98ef754p+1 -0x1.0eef61747a672p-7 0x1.9a7feacd51083p+1 0x1.2187093fc2facp+2 "
        "-0x1.395c721d721fcp+3 0x1.b3b1bcefc3e2dp+2"
    ),
    "3 rods, float": (
        "0x1.79a1380000000p+1 0x1.1d97960000000p+0 0x1.583e300000000p+0 -0x1.521bae0000000p-1 "
        "-0x1.747a120000000p+1 0x1.f5e8f60000000p-1 0x1.660b840000000p+5 0x1.4030f80000000p+1 "
        "0x1.6d40c60000000p+0"
    ),
    "3 hinges, float": (
        "-0x1.04a84c0000000p+0 -0x1.0b09f20000000p-2 0x1.5deb6c0000000p+1 0x1.9e63e00000000p-1 "
        "0x1.41ce5e0000000p-1 0x1.09aa540000000p+1 -0x1.3d1f920000000p+4 -0x1.0225660000000p+0 "
        "0x1.edb22e0000000p+0"
    ),
    "a body with six freedoms, float": (
        "0x1.2decc20000000p+1 -0x1.f5ee700000000p-2 -0x1.6239be0000000p+1 -0x1.17feb60000000p-3 "
        "0x1.0e31260000000p-3 0x1.14ebbe0000000p-1 -0x1.a65c0e0000000p+1 0x1.f0964c0000000p-1 "
        "0x1.5884cc0000000p+0 -0x1.9cdf0c0000000p+0 -0x1.94d8d40000000p-3 -0x1.61038a0000000p+1 "
        "0x1.dbcf9e0000000p+1 -0x1.1d53940000000p-1 -0x1.0e03d60000000p+2 -0x1.dca65c0000000p+0 "
        "0x1.cbf6360000000p+0 0x1.d76aae0000000p+2"
    ),
}
"""The worst states that searches have found, by case; every search starts at them, too.

A state is {x}, {y} and {tau} in one row. Replace a state by that of the report of a nightly run.
"""
