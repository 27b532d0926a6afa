"""Errors of generated code against certified truth, as rows."""

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
from tests.battery.rows import Point, Row

Floats = NDArray[np.float64]
PRECISIONS = (DOUBLE, FLOAT)
FORWARD = ("forward_dynamics",)
FLAGS = ("-O0", "-ffp-contract=off")

PROMISE = "T(u)"
LINEAR = "16 N u chi"


@functools.lru_cache(maxsize=64)
def built(system: kg.System, precision: Precision = DOUBLE, outputs: tuple[str, ...] = FORWARD) -> Library:
    """A library, built fast; X32 shows that no bit depends on the level of optimisation."""
    return kg.build(system, outputs, precision=precision.name, flags=FLAGS)


def efforts(system: kg.System, states: States, rng: np.random.Generator) -> Floats:
    """(B, n) generalized forces, of the size of the diagonal of [A]."""
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
    """Forward dynamics in the given or in random states."""
    sample = random_states(system, count, seed) if states is None else states
    return measure(system, built(system, precision), sample, tau)["forward_dynamics"]


def linear(measured: Measurement, bodies: int, precision: Precision) -> Floats:
    """(B,) what a solution would lose that no condition number enlarges."""
    return np.array([bound(precision.roundoff, bodies, chi, 0.0) for chi in measured.chi])


def promise(exact: Truth, precision: Precision) -> float:
    """T(u), the bound on forward dynamics in one state."""
    state = conditioning(exact)
    bodies = exact.system.number_of_bodies
    return bound(precision.roundoff, bodies, state.chi, state.kappa_s, state.formation)


def rounded(values: Floats, precision: Precision) -> Floats:
    """The nearest numbers that the precision has, as doubles."""
    return values.astype(precision.dtype).astype(np.float64)


def worst(
    case: str,
    points: Iterable[Point],
    rule: str,
    over: str,
    cause: str = "",
) -> Row:
    """The row of the point that comes nearest to its limit; where nothing is promised nothing counts."""
    curve = tuple(points)
    inside = [point for point in curve if math.isfinite(point.limit)]
    outside = len(curve) - len(inside)
    where = f"{over}; {outside} of {len(curve)} states beyond the promise" if outside else over
    top = max(inside, key=_share, default=Point(0.0, math.inf, 0.0))
    return Row(case, top.figure, top.limit, rule, where, cause, curve)


def _share(point: Point) -> float:
    """Of the limit; whatever is no number takes all of it."""
    if point.figure == 0:
        return 0.0
    share = point.figure / point.limit if point.limit > 0 else math.inf
    return math.inf if math.isnan(share) else share


def points(at: float, measured: Measurement, limit: Floats | None = None) -> list[Point]:
    """Every state of a measurement at one place of a curve."""
    limits = measured.bound if limit is None else limit
    pairs = zip(measured.normwise.tolist(), limits.tolist(), strict=True)
    return [Point(at, error, allowed) for error, allowed in pairs]


def bits(values: NDArray[np.floating]) -> bytes:
    """What must be equal where not a bit may differ; all NaN are one."""
    return np.where(np.isnan(values), np.nan, values).astype(values.dtype).tobytes()
