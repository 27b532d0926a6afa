"""Errors of generated code against certified truth, as points and rows."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

import kanegen as kg
from kanegen.library import Library
from kanegen.measure.truth import Measurement, Truth, bound, conditioning, measure
from kanegen.program.precision import DOUBLE, FLOAT, Precision
from kanegen.reference import equations as reference
from kanegen.reference.states import States, random_states
from tests.battery.experiments import Point, Row

Floats = NDArray[np.float64]
PRECISIONS = (DOUBLE, FLOAT)
FORWARD = ("forward_dynamics",)
FLAGS = ("-O0", "-ffp-contract=off")

PROMISE = "T(u)"
"""The rule of a limit that is the bound on the error."""

LINEAR = "16 N u chi"
"""The rule of a limit without a condition number."""


@functools.lru_cache(maxsize=64)
def built(system: kg.System, precision: Precision = DOUBLE, outputs: tuple[str, ...] = FORWARD) -> Library:
    """Build a library without optimisation, which X32 shows to change no bit."""
    return kg.build(system, outputs, precision=precision.name, flags=FLAGS)


def efforts(system: kg.System, states: States, rng: np.random.Generator) -> Floats:
    """Return (B, n) random generalized forces, up to 10 times the diagonal of [A]."""
    diagonal = np.diagonal(reference.mass_matrix(system, states.x), axis1=1, axis2=2)
    tau: Floats = rng.uniform(-10.0, 10.0, states.x.shape) * diagonal
    return tau


def forward(
    system: kg.System,
    precision: Precision,
    states: States | None = None,
    tau: Floats | None = None,
    seed: int = 0,
    count: int = 4,
) -> Measurement:
    """Measure the errors of forward dynamics in some states, by default random ones."""
    sample = random_states(system, count, seed) if states is None else states
    return measure(system, built(system, precision), sample, tau)["forward_dynamics"]


def linear(measured: Measurement, bodies: int, precision: Precision) -> Floats:
    """Return the (B,) limits 16 N u chi of a solution whose error no condition number enlarges."""
    return np.array([bound(precision.roundoff, bodies, chi, 0.0) for chi in measured.chi])


def promise(exact: Truth, precision: Precision) -> float:
    """Return T(u), the bound on the error of forward dynamics in one state."""
    state = conditioning(exact)
    bodies = exact.system.number_of_bodies
    return bound(precision.roundoff, bodies, state.chi, state.kappa_s, state.formation)


def rounded(values: Floats, precision: Precision) -> Floats:
    """Round to the precision and return doubles."""
    return values.astype(precision.dtype).astype(np.float64)


def worst(
    case: str,
    points: Iterable[Point],
    rule: str,
    over: str,
    cause: str = "",
) -> Row:
    """Return the row of the point nearest to its limit; points without a bound do not count."""
    curve = tuple(points)
    inside = [point for point in curve if math.isfinite(point.limit)]
    outside = len(curve) - len(inside)
    where = f"{over}; {outside} of {len(curve)} states without a bound" if outside else over
    top = max(inside, key=_share, default=Point(0.0, math.inf, 0.0))
    return Row(case, top.figure, top.limit, rule, where, cause, curve)


def _share(point: Point) -> float:
    """Return the ratio of figure to limit; infinity for NaN."""
    if point.figure == 0:
        return 0.0
    share = point.figure / point.limit if point.limit > 0 else math.inf
    return math.inf if math.isnan(share) else share


def points(at: float, measured: Measurement, limit: Floats | None = None) -> list[Point]:
    """Return one point for each state of a measurement, all at one place of the horizontal axis."""
    limits = measured.bound if limit is None else limit
    pairs = zip(measured.normwise.tolist(), limits.tolist(), strict=True)
    return [Point(at, error, allowed) for error, allowed in pairs]


def bits(values: NDArray[np.floating]) -> bytes:
    """Return the bytes of values; all NaN have the same."""
    return np.where(np.isnan(values), np.nan, values).astype(values.dtype).tobytes()
