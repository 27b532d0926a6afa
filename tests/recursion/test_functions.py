"""Functions in expressions of force elements: their values, their derivatives, and both at kinks.

Expected values are computed with Python's `math` and written out by hand.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import kanegen as kg
from kanegen.errors import KanegenWarning
from kanegen.options import Variant
from tests.support.cases import slow_except
from tests.support.slide import slide

OUTPUTS = ("forcing", "forcing_derivatives")
PRECISIONS = ("double", "float", "long double", "double-double")
X, Y = -0.02, 0.003


CASES = {
    "-0.4*tanh(y.q/0.01)": -0.4 * math.tanh(0.3),
    "-0.4*sign(y.q)": -0.4,
    "-0.4*exp(-(y.q/0.01)**2)": -0.4 * math.exp(-0.09),
    "10000*max(0, -x.q)": 200.0,
    "min(x.q, y.q, 1)*pi": -0.02 * math.pi,
    "log(-x.q)": math.log(0.02),
    "atan2(y.q, x.q)": math.atan2(0.003, -0.02),
    "abs(x.q)": 0.02,
    "3 if x.q < 0 and y.q > 0 else log(x.q)": 3.0,
    "log(x.q) if not x.q <= 0 else 5 if x.q > y.q or x.q >= -0.02 else 7": 5.0,
}


@pytest.mark.parametrize("text", slow_except(CASES, *list(CASES)[::3]))
def test_values_in_every_precision_for_one_state_and_in_batches(text: str) -> None:
    system = slide(text)
    for precision in PRECISIONS:
        library = kg.build(system, OUTPUTS, tier=Variant(precision=precision))
        unit = 2.0**-24 if precision == "float" else 2.0**-53
        # Quotients and powers round, and so do x and y in single precision; none is far above 1.
        limit = 16 * unit * max(1.0, abs(CASES[text]))
        assert library.forcing([X, 0.0], [Y, 0.0])[0] == pytest.approx(CASES[text], abs=limit)
        batch = library.forcing(np.tile([X, 0.0], (9, 1)), np.tile([Y, 0.0], (9, 1)))
        assert (batch == library.forcing([X, 0.0], [Y, 0.0])).all()


@pytest.mark.parametrize("text", CASES)
def test_the_literal_derivation_has_the_same_values(text: str) -> None:
    found = kg.derive(slide(text)).lambdify().forcing([X, 0.0], [Y, 0.0])
    assert found[0] == pytest.approx(CASES[text], rel=1e-14)


def derivatives(system: kg.System, x: list[float], y: list[float]) -> np.ndarray:
    """Return the derivatives of the first force by x.q, x.p, y.q and y.p."""
    return kg.build(system, OUTPUTS).forcing_derivatives(x, y)[0, :4]


@pytest.mark.parametrize(
    ("text", "x", "y", "expected"),
    [
        ("tanh(3*x.q)", 0.1, 0.0, 3 / math.cosh(0.3) ** 2),
        ("tanh(x.q)", 20.0, 0.0, 4 * math.exp(-40.0)),  # 1 - tanh^2 by difference is 0
        ("tanh(x.q)", 400.0, 0.0, 0.0),
        ("exp(-2*x.q)", 0.1, 0.0, -2 * math.exp(-0.2)),
        ("log(x.q)", 0.1, 0.0, 10.0),
        ("atan2(x.q, 2)", 0.5, 0.0, 2 / 4.25),
        ("atan2(2, x.q)", 0.5, 0.0, -2 / 4.25),
        ("max(0, -3*x.q)", -0.1, 0.0, -3.0),
        ("max(0, -3*x.q)", 0.1, 0.0, 0.0),
        ("min(x.q**2, x.q)", 0.3, 0.0, 0.6),
        ("abs(x.q)", -0.3, 0.0, -1.0),
        ("sign(x.q)*x.q", -0.3, 0.0, -1.0),
        ("x.q*log(x.q) if x.q > 0 else 7*x.q", -0.3, 0.0, 7.0),
        ("x.q*log(x.q) if x.q > 0 else 7*x.q", 0.3, 0.0, math.log(0.3) + 1),
        ("sin(x.q) if y.q > 0 else cos(x.q)", 0.3, 1.0, math.cos(0.3)),
        # At kinks: the sign of 0 is 0, the first of equal numbers counts, and jumps have no derivative.
        ("abs(x.q)", 0.0, 0.0, 0.0),
        ("sign(x.q)", 0.0, 0.0, 0.0),
        ("x.q*sign(x.q)", 0.0, 0.0, 0.0),
        ("max(0, -3*x.q)", 0.0, 0.0, 0.0),
        ("max(-3*x.q, 0)", 0.0, 0.0, -3.0),
        ("min(5*x.q, x.q)", 0.0, 0.0, 5.0),
        ("x.q if x.q > 0 else 2*x.q", 0.0, 0.0, 2.0),
        ("x.q if x.q >= 0 else 2*x.q", 0.0, 0.0, 1.0),
        # Removable singularities.
        ("abs(x.q)**3", 0.0, 0.0, 0.0),
        ("sqrt(x.q**2)", 0.0, 0.0, 0.0),
        ("sqrt(x.q**2 + x.p**2)*x.q", 0.0, 0.0, 0.0),
        ("sqrt(abs(x.q))*abs(x.q)", 0.0, 0.0, 0.0),
        ("sqrt(x.q**2 + x.p**2)**3", 0.0, 0.0, 0.0),
        ("x.q*sqrt(abs(x.q))", 0.0, 0.0, 0.0),
        ("-x.q*(3 + sqrt(abs(x.q) + abs(x.p)))", 0.0, 0.0, -3.0),
        ("sqrt(abs(x.q))", -4.0, 0.0, -0.25),
    ],
)
def test_derivatives(text: str, x: float, y: float, expected: float) -> None:
    found = derivatives(slide(text), [x, 0.0], [y, 0.0])
    assert found[0] == pytest.approx(expected, rel=1e-13, abs=1e-300)
    assert not found[1:].any()


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("x.q*sqrt(abs(x.q))", 0.0),
        ("-x.q*(3 + sqrt(abs(x.q) + abs(x.p)))", -3.0),
        ("abs(x.q)", 0.0),
        ("sqrt(abs(x.q))", math.nan),
        ("3*sqrt(abs(2*x.q) + x.p**2)", math.nan),
        ("-2*sign(x.q)*sqrt(abs(x.q))", math.nan),
        ("(x.p + 2)*sqrt(abs(x.q))*sign(x.q)", math.nan),
        ("sign(x.q)*x.q*sqrt(abs(x.q))", 0.0),
        ("sqrt(tanh(abs(x.q)))", math.nan),
        ("sqrt(min(abs(x.q), 2))", math.nan),
        ("x.q*sqrt(tanh(abs(x.q)))", 0.0),
    ],
)
def test_products_with_derivatives_at_kinks_are_those_of_derivatives(text: str, expected: float) -> None:
    outputs = ("forcing_jvp", "forcing_vjp", "forcing_derivatives")
    library = kg.build(slide(text), outputs).with_on_status("ignore")
    rest = [0.0, 0.0]
    along = library.forcing_jvp(rest, rest, np.eye(library.forcing_derivatives(rest, rest).shape[1])[0])
    found = (
        along[0],
        library.forcing_vjp(rest, rest, [1.0, 0.0])[0],
        library.forcing_derivatives(rest, rest)[0, 0],
    )
    assert found == pytest.approx((expected,) * 3, nan_ok=True)


@pytest.mark.parametrize(
    ("text", "x", "expected"),
    [
        ("sqrt(1 + x.q**2)", (0.0, 0.0), [[1, 0], [0, 0]]),
        ("sqrt(x.q**2 + x.p**2)", (0.0, -2.0), [[0.5, 0], [0, 0]]),
        ("sqrt(x.q**2 + x.p**2)**3", (0.0, 2.0), [[6, 0], [0, 12]]),
        ("sqrt(abs(x.q))*x.p", (4.0, 0.0), [[0, 0.25], [0.25, 0]]),
        ("x.p*(2 + sqrt(abs(x.q)))", (-4.0, 0.0), [[0, -0.25], [-0.25, 0]]),
        ("sqrt(abs(x.q) + x.p**2)", (4.0, 0.0), [[-1 / 32, 0], [0, 0.5]]),
    ],
)
def test_second_derivatives_of_roots_where_a_slope_is_zero(
    text: str, x: tuple[float, float], expected: list[list[float]]
) -> None:
    """A slope of 0 is no reason to leave out the slopes of the slope, but at a root that is 0."""
    library = kg.build(slide(text), ("forcing_hvp",))
    found = [library.forcing_hvp(x, [0.0, 0.0], [1.0, 0.0], row)[:2] for row in np.eye(4)[:2]]
    np.testing.assert_allclose(found, expected, rtol=1e-14, atol=1e-15)
    potential = replace(slide(text), force_elements=(kg.Potential(kg.parse(text)),))
    outputs = ("forcing_derivatives", "forcing_vjp")
    library = kg.build(potential, outputs)
    np.testing.assert_allclose(
        library.forcing_derivatives(x, [0.0, 0.0])[:, :2], -np.array(expected), rtol=1e-14, atol=1e-15
    )
    rows = [library.forcing_vjp(x, [0.0, 0.0], row)[:2] for row in np.eye(2)]
    np.testing.assert_allclose(rows, -np.array(expected), rtol=1e-14, atol=1e-15)


def test_quadratic_drag_has_the_derivative_zero_at_rest() -> None:
    assert derivatives(slide("-0.4*abs(y.q)*y.q"), [0.0, 0.0], [0.0, 0.0]).tolist() == [0.0, 0.0, 0.0, 0.0]
    assert derivatives(slide("-0.4*abs(y.q)*y.q"), [0.0, 0.0], [-2.0, 0.0])[2] == pytest.approx(-1.6)


@pytest.mark.parametrize(
    "text",
    [
        *("sqrt(x.q)", "log(x.q)", "1/x.q", "x.q/abs(x.q)", "log(abs(x.q))", "sqrt(abs(x.q))"),
        *("3*sqrt(abs(2*x.q) + x.p**2)", "cos(x.q)*sqrt(abs(x.q))", "sign(x.p + 1)*sqrt(3*abs(x.q))"),
    ],
)
def test_derivatives_without_limit_have_a_status(text: str) -> None:
    with pytest.warns(KanegenWarning, match="A force element may be undefined in this state"):
        found = derivatives(slide(text), [0.0, 0.0], [0.0, 0.0])
    assert not np.isfinite(found[0])


@pytest.mark.parametrize(
    ("energy", "at", "expected"),
    [
        ("3*abs(x.q)**3", 0.0, 0.0),
        ("3*abs(x.q)**3", -0.5, 9 * 0.25),
        ("abs(x.q)", 0.0, 0.0),
        ("abs(x.q)*sqrt(abs(x.q))", 0.0, 0.0),
        ("sqrt(x.q**2 + x.p**2)", 0.0, 0.0),
        ("sqrt(sqrt(abs(x.q)))", 0.0, 0.0),
        ("sqrt(sqrt(abs(x.q)))", -16.0, 1 / 32),
        ("sqrt(x.q**2 + x.p**2)**3", 0.0, 0.0),
        ("sqrt(x.q**2 + x.p**2)", -2.0, 1.0),
        ("50*max(0, -x.q)**2", -0.1, 10.0),
        ("50*max(0, -x.q)**2", 0.0, 0.0),
        ("2*tanh(x.q)", 20.0, -8 * math.exp(-40.0)),
        ("x.q*log(x.q) if x.q > 0 else 7*x.q", -0.5, -7.0),
        ("x.q*log(x.q) if x.q > 0 else 7*x.q", 0.5, -math.log(0.5) - 1),
        ("2*sign(x.q)*x.q", 0.0, 0.0),
        ("exp(-x.q) + atan2(x.q, 1)", 0.0, 0.0),
    ],
)
def test_forces_of_potentials(energy: str, at: float, expected: float) -> None:
    system = slide(energy=energy)
    found = kg.build(system, OUTPUTS).forcing([at, 0.0], [0.0, 0.0])
    assert found[0] == pytest.approx(expected, rel=1e-13, abs=1e-300)
    assert found[1] == 0.0


def test_a_long_potential_with_a_branch_that_is_undefined() -> None:
    """A branch that is not taken has no part in the derivative, also where the expression has many parts."""
    branch = " + ".join(f"log({k} + x.q)*x.q**2" for k in range(12))
    system = slide(
        energy=f"({branch} if x.q > 1 else x.q**3 + max(log(2 + x.q), sqrt(x.q - 2) if x.q > 2 else 0))"
    )
    found = kg.build(system, OUTPUTS).forcing([-0.5, 0.0], [0.0, 0.0])
    assert found[0] == pytest.approx(-3 * 0.25 - 1 / 1.5, rel=1e-14)


@pytest.mark.parametrize(
    "text", ["log(x.q)", "sqrt(x.q)", "exp(-1e5*x.q)", "max(0, log(x.q))", "1 if log(x.q) > 0 else 2"]
)
def test_what_is_undefined_has_a_status(text: str) -> None:
    library = kg.build(slide(text), OUTPUTS)
    with pytest.warns(KanegenWarning, match="A force element may be undefined in this state: drive: "):
        found = library.forcing([X, 0.0], [Y, 0.0])
    assert not np.isfinite(found[0])
    assert found[1] == 0.0


@pytest.mark.parametrize("precision", slow_except(("double", "float"), "double"))
@pytest.mark.parametrize(
    ("text", "u", "expected"),
    [
        ("sqrt(x.q)**2", -1.0, -1.0),
        ("sqrt(x.q)*sqrt(x.q)", -1.0, -1.0),
        ("x.q/x.q", 0.0, 1.0),
        ("0/x.q", 0.0, 0.0),
        ("log(x.q) - log(x.q)", -1.0, 0.0),
        ("sqrt(x.q) - sqrt(x.q)", -1.0, 0.0),
        ("0*log(x.q)", -1.0, 0.0),
        ("min(3, 1/x.q)", 0.0, 3.0),
        ("tanh(1/x.q)", 0.0, 1.0),
        ("sign(1/x.q)", 0.0, 1.0),
        ("sign(1/x.q)", -0.0, -1.0),
        ("1/(1/x.q)", 0.0, 0.0),
        ("exp(-1/x.q)", 0.0, 0.0),
        ("1 if 1/x.q > 0 else 2", 0.0, 1.0),
        ("1 if log(x.q) < 0 else 2", 0.0, 1.0),
        ("x.q if x.q >= 0 else log(-1 - x.q**2)", 0.5, 0.5),
        ("x.q if x.q >= 0 else log(-1 - x.q**2)", -1.0, None),
        ("min(3, sqrt(x.q))", -1.0, None),
        ("sign(log(x.q))", -1.0, None),
        ("1/x.q", 0.0, None),
    ],
)
@pytest.mark.filterwarnings("error")
def test_what_simplifies_and_what_is_infinite_inside_counts_as_documented(
    text: str, u: float, expected: float | None, precision: str
) -> None:
    """docs/model-files.md says which expressions stay finite where a part of them has no finite value."""
    library = kg.build(slide(text), ("forcing",), precision=precision, flags="-O0")
    if expected is None:
        with pytest.warns(KanegenWarning, match="may be undefined in this state"):
            assert not np.isfinite(library.forcing([u, 0.0], [0.0, 0.0])[0])
    else:
        assert library.forcing([u, 0.0], [0.0, 0.0])[0] == expected


def test_operations_are_counted() -> None:
    found = kg.generate(slide("max(0, x.q) + tanh(y.q) + exp(y.q)*abs(x.q)"), ("forcing",)).operations
    assert found == {
        "add": 2,
        "multiply": 1,
        "divide": 0,
        "sqrt": 0,
        "sincos": 0,
        "compare": 1,
        "function": 2,
        "prepare": 0,
    }
    assert "compare" not in kg.generate(slide("x.q"), ("forcing",)).operations


def test_powers_by_exp_and_log_stay_as_they_are() -> None:
    """SymPy would make a power with an exponent of 53 bits, which takes 52 square roots."""
    found = kg.generate(slide("exp(1.7*log(x.q))"), ("forcing",)).operations
    assert (found["function"], found["sqrt"], found["multiply"]) == (2, 0, 1)


@pytest.mark.parametrize(
    "text", ["log(0)", "log(-1)*x.q", "exp(1e300)", "exp(exp(exp(exp(5))))", "1/log(1)", "exp(800)"]
)
def test_constants_without_a_finite_value_are_refused(text: str) -> None:
    with pytest.raises(
        kg.ModelError, match=r"has no value in any state|leaves the range of double precision"
    ):
        kg.generate(slide(text), ("forcing",))


def test_constants_fold() -> None:
    text = (
        "exp(-1e300) + atan2(0, 0) + sign(-2) + (x.q if sqrt(2) > 1.4 else 3) + max(1, 2) + tanh(0) + log(1)"
    )
    source = kg.generate(slide(text), ("forcing",))
    assert (source.operations["add"], source.operations.get("function", 0)) == (1, 0)
    assert kg.build(slide(text), ("forcing",)).forcing([0.25, 0.0], [0.0, 0.0])[0] == 1.25
