"""Numbers of a model in balls: they enclose what 320 bits and fractions give, and what files mean."""

from __future__ import annotations

from fractions import Fraction

import pytest

import kanegen as kg
from kanegen.measure.truth.balls import arb, ctx
from kanegen.measure.truth.numbers import ball
from kanegen.model.numbers import number, value_of
from kanegen.program.constants import as_fraction

PARAMETERS = {"m": kg.Parameter("m", 1.7), "l": kg.Parameter("l", 0.3), "alpha": kg.Parameter("alpha", 0.4)}

TEXTS = (
    "1/12",
    "m*l**3/12 - m**-2",
    "-(l - m)/(2*l + 0.1)",
    "cos(alpha)*sin(pi/6) + tan(alpha) - tanh(l)",
    "exp(-l) + log(m) + sqrt(m)",
    "atan2(-l, -m) + abs(-l) + sign(-m)",
    "min(m, l) + 2*max(m, l)",
    "m if m > l and not l >= m else l",
    "m if m < l or l <= 0 else l",
)


@pytest.mark.parametrize("text", TEXTS)
def test_balls_enclose_exact_values(text: str) -> None:
    found = number(kg.parse(text, PARAMETERS), "number")
    with ctx.workprec(200):
        enclosure = ball(found)
        assert enclosure.rad() < 1e-50
        exact = found.exact if isinstance(found, kg.Expression) else Fraction(found)
        fraction = exact if isinstance(exact, Fraction) else as_fraction(exact)
        error = enclosure - arb(fraction.numerator) / arb(fraction.denominator)
        assert abs(error) < arb(1e-50)
    assert float(enclosure.mid()) == value_of(found)


def test_truth_takes_a_fraction_as_it_is_meant() -> None:
    """The C rounds 1/12 once; the truth of the system does not."""
    twelfth = number(kg.parse("1/12"), "number")
    with ctx.workprec(200):
        assert ball(twelfth) * 12 - 1 < arb(1e-50)
        assert not ball(twelfth).overlaps(arb(1 / 12))
