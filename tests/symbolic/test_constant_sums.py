"""Sums of constants are written without the terms that cancel in them, and are otherwise left as they are."""

from __future__ import annotations

import pytest
from sympy import Rational, Symbol, expand

from kanegen.symbolic.definitions import Definitions

m, d, x = (Symbol(name, real=True) for name in "mdx")


@pytest.fixture
def definitions() -> Definitions:
    return Definitions(["m", "d"])


def test_a_common_term_cancels_exactly(definitions) -> None:
    h = definitions.define("h", m * d)
    square = definitions.define("square", h * d)
    xx, yy = definitions.define("xx", square + 3), definitions.define("yy", square + m + 1)
    assert definitions.define("difference", xx - yy) == Symbol("difference", real=True)
    assert definitions.listed()[-1].value == 2 - m
    assert definitions.define("same", xx - square - 3) == 0


def test_coefficients_cancel_exactly(definitions) -> None:
    """m (r^2 - 2 r d + d^2) with d near r; in floating point, nothing would remain of 1e-12."""
    r, far = Rational(1000), Rational(1000) + Rational(1, 10**6)
    about_point = definitions.define("about_point", m * r**2 + 1)
    shifted = definitions.define("shifted", about_point - 2 * r * far * m + m * far**2)
    value = definitions.listed()[-1].value
    assert shifted != value
    assert expand(value - (1 + m * (r - far) ** 2)) == 0
    assert value.coeff(m) == Rational(1, 10**12)


def test_other_sums_stay_as_they_are(definitions) -> None:
    a = definitions.define("a", m + d)
    cases = [a + m, a - 2 * m, a * d - d * m, a + x - m]
    for i, value in enumerate(cases):
        definitions.define(f"b_{i}", value)
    assert [one.value for one in definitions.listed()[1:]] == cases
