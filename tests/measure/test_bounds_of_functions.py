"""Proven bounds and running errors of functions in expressions hold, also next to kinks and jumps.

Exact values are those of the expression for the very doubles of a state, in 60 digits of mpmath.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable

import mpmath
import numpy as np
import pytest

import kanegen as kg
from kanegen.measure.bounds import read_domain
from kanegen.options import Variant
from kanegen.program.precision import precision_named
from tests.support.cases import slow_except
from tests.support.slide import slide

BOX = {"x": {"q": [-1.0, 1.0], "p": [0.5, 1.5]}, "y": {"q": [-2.0, 2.0], "p": [-1.0, 1.0]}}

Number = mpmath.mpf

TENTH = mpmath.mpf(0.1)
"""The double 0.1, exactly."""


def sign(v: Number) -> Number:
    return mpmath.mpf((v > 0) - (v < 0))


EXACT: dict[str, Callable[..., Number]] = {
    "tanh(3*x.q*y.q)": lambda q, p, v, w: mpmath.tanh(3 * q * v),
    "exp(x.q*x.p - y.q)": lambda q, p, v, w: mpmath.exp(q * p - v),
    "log(x.p + x.q*x.q)": lambda q, p, v, w: mpmath.log(p + q * q),
    "atan2(x.q*x.q - y.q, x.p)": lambda q, p, v, w: mpmath.atan2(q * q - v, p),
    "atan2(3 + x.q*y.q, x.q)": lambda q, p, v, w: mpmath.atan2(3 + q * v, q),
    "max(x.q*x.q, y.p*y.p)": lambda q, p, v, w: max(q * q, w * w),
    "min(x.q*x.p, y.q*y.p, 0.1)": lambda q, p, v, w: min(q * p, v * w, TENTH),
    "abs(x.q*x.p - y.q*y.p)": lambda q, p, v, w: abs(q * p - v * w),
    "5*sign(0.1*x.q - x.p*y.q)": lambda q, p, v, w: 5 * sign(TENTH * q - p * v),
    "x.p if x.q*x.q > 0.1*x.p else 3*y.q": lambda q, p, v, w: p if q * q > TENTH * p else 3 * v,
    "x.p if x.q > 0 else 3*y.q": lambda q, p, v, w: p if q > 0 else 3 * v,
}
"""The same expressions as functions of mpmath's numbers."""

SMOOTH = [text for text in EXACT if "sign" not in text and "if x.q*" not in text]


def states(precision: str, seed: int = 0) -> np.ndarray:
    """Return (B, 4) states of the box, many where two products in the expressions nearly agree."""
    rng = np.random.default_rng(seed)
    q, v, w = rng.uniform(-1, 1, 300), rng.uniform(-2, 2, 300), rng.uniform(-1, 1, 300)
    p = rng.uniform(0.5, 1.5, 300)
    near = [
        np.stack([q, p, q * p / w, w], axis=1),
        np.stack([q, p, 0.1 * q / p, w], axis=1),
        np.stack([np.sqrt(0.1 * p), p, v, w], axis=1),
        np.stack([q, p, v, q], axis=1),
        np.stack([0 * q, p, 0 * v, 0 * w], axis=1),
    ]
    found = np.concatenate([np.stack([q, p, v, w], axis=1), *near])
    low, high = np.array([-1.0, 0.5, -2.0, -1.0]), np.array([1.0, 1.5, 2.0, 1.0])
    found = found[((found >= low) & (found <= high)).all(axis=1)]
    return found.astype(precision_named(precision).dtype).astype(np.float64)


@pytest.mark.parametrize("precision", slow_except(("double", "float"), "double"))
@pytest.mark.parametrize("text", EXACT)
def test_no_state_exceeds_the_proven_bound(text: str, precision: str) -> None:
    system = slide(text)
    library = kg.build(system, ("forcing",), tier=Variant(precision=precision))
    bounds = kg.bound(library, read_domain(BOX, system))
    limit, sample = float(bounds["forcing"][0]), states(precision)
    kind = precision_named(precision).dtype
    found = library.forcing(sample[:, :2].astype(kind), sample[:, 2:].astype(kind))[:, 0].astype(np.float64)
    with mpmath.workdps(60):
        exact = [EXACT[text](*map(mpmath.mpf, row)) for row in sample.tolist()]
        errors = [float(abs(mpmath.mpf(f) - e)) for f, e in zip(found.tolist(), exact, strict=True)]
    assert max(errors) <= limit
    if text in SMOOTH:  # a bound of a jump is as large as the jump
        assert limit < 400 * 2.0 ** -precision_named(precision).significand_bits


def test_reasons_without_a_bound() -> None:
    for text, reason in {
        "sqrt(x.q)": r"x\[0\] \('q'\), whose root is taken, may be 0 or negative in the box",
        "log(x.q)": r"x\[0\] \('q'\), whose logarithm is taken, may be 0 or negative in the box",
        "exp(1000*x.q)": "may leave the range of double precision in the box",
        "atan2(x.q, y.q)": "the point whose angle is fe_1_4 .*may be the origin in the box",
    }.items():
        system = slide(text)
        bounds = kg.bound(kg.build(system, ("forcing",)), read_domain(BOX, system))
        assert math.isinf(bounds["forcing"][0])
        assert re.search(reason, bounds.unbounded["forcing"])
