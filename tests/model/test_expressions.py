"""The grammar of expressions: accepted and refused texts, printing, and rounding."""

from __future__ import annotations

import math
from collections.abc import Callable

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kanegen.errors import ModelError
from kanegen.model.force_elements.expression import (
    FUNCTIONS,
    Constant,
    Expression,
    Node,
    Operation,
    Power,
    Variable,
)
from kanegen.model.force_elements.grammar import MAX_CHARACTERS, MAX_EXPONENT, parse
from kanegen.model.numbers import Parameter
from kanegen.reference.expressions import Dual, Rounded, evaluate

K = Parameter("k", 2.5)
VALUES = {"x.arm.theta1": 0.7, "y.arm.s2": -1.3, "t": 0.2}


def value(text: str) -> float:
    return float(evaluate(parse(text, [K]), VALUES, float))


def test_the_operations() -> None:
    x, y, t, k = 0.7, -1.3, 0.2, 2.5
    for text, expected in {
        "1 + 2*3 - 4/8": 6.5,
        "-2**2": -4.0,
        "(-2)**2": 4.0,
        "2**-3": 0.125,
        "- (x.arm.theta1 - 1)": 0.3,
        "k*x.arm.theta1**3/(1 + t)": k * x**3 / (1 + t),
        "k - x.arm.theta1 - t": k - x - t,
        "k / x.arm.theta1 / t": k / x / t,
        "k - (x.arm.theta1 - t)": k - (x - t),
        'x["arm.theta1"] * abs(y.arm.s2)': x * abs(y),
        "sin(k) + cos(t)*tan(t) + sqrt(k)": math.sin(k) + math.sin(t) + math.sqrt(k),
        "  1e-3  ": 1e-3,
        "+3": 3.0,
    }.items():
        assert value(text) == pytest.approx(expected, rel=1e-15)


def test_plain_numbers_and_expressions_pass() -> None:
    assert parse(3) == parse("3.0") == parse(3.0)
    assert parse(parse("x.a.s1")) == parse("x.a.s1")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "no expression"),
        ("1 +", "no expression"),
        ("1 2", "no expression near column 3"),
        (r"'\d'", "no number"),
        ("1; 2", "no expression"),
        ("x", "'x': one element is needed, such as x.arm.theta1"),
        ("z.real", "'z.real': only x and y have elements"),
        ("(1).real", "only x and y have elements"),
        ("x.a.theta1().real", "only x and y have elements"),
        ("x[0]", "only x and y have elements"),
        ("foo(1)", r"there is no function 'foo'\. .*There are abs, cos, sin, sqrt, tan\."),
        ("exp(1)", "there is no function 'exp'"),
        ("__import__('os').system('true')", "there is no function"),
        ("sin(1, 2)", "sin takes one number"),
        ("sin(x=1)", "sin takes one number"),
        ("sin(*x)", "only numbers, names"),
        ("2**k", "an exponent is a whole number; for roots there is sqrt"),
        ("2**0.5", "an exponent is a whole number"),
        ("2**~3", "'~3' in expression .* an exponent is a whole number"),
        ("2**-True", "an exponent is a whole number"),
        ("2**100000000", f"a huge power; together exponents reach at most {MAX_EXPONENT}"),
        ("((2**16)**16)**16", "a huge power"),
        ("1 if t else 2", "only numbers, names"),
        ("t < 2", "only numbers, names"),
        ("[1, 2]", "only numbers, names"),
        ("lambda: 1", "only numbers, names"),
        ("7 // 2", "only numbers, names"),
        ("7 % 2", "only numbers, names"),
        ("7 @ 2", "only numbers, names"),
        ("~7", "only numbers, names"),
        ("(a := 1)", "only numbers, names"),
        ("'text'", "no number"),
        ("2j", "no number"),
        ("True", "no number"),
        ("...", "is not a number"),
        ("1e999", "is not finite"),
        ("9" * 400, "is not finite"),
        ("(" * 200_000 + ")" * 200_000, f"400000 characters; at most {MAX_CHARACTERS} are read"),
        ("(" * 5000 + ")" * 5000, "no expression"),
        ("*".join(["(" + "+".join(["t"] * 99) + ")"] * 21), "more than 2000 operations"),
        ("-" * 3000 + "1", "nested too deeply|inside each other"),
        ("(" * 1500 + "1" + ")" * 1500, "no expression"),
        ("1" + "+1" * 300, "more than 200 operations inside each other"),
        ("x" + ".a" * 1900, "nested too deeply"),
        ("x" + ".a" * 1900 + "()", "nested too deeply"),
        ("\0", "no expression"),
    ],
)
def test_what_is_refused(text: str, message: str) -> None:
    with pytest.raises(ModelError, match=message) as raised:
        parse(text, [K])
    assert len(str(raised.value)) < 400
    assert raised.value.__cause__ is None


@pytest.mark.parametrize("wrong", [None, [], {}, 1j, True, float("nan")])
def test_what_is_no_text(wrong: object) -> None:
    with pytest.raises(ModelError, match="expression: "):
        parse(wrong)


def trees() -> st.SearchStrategy[Node]:
    numbers = st.floats(-9, 9).map(lambda v: Constant(v + 0.0))
    leaves = numbers | st.sampled_from([Constant(K), *(Variable(name) for name in VALUES)])

    def grown(below: st.SearchStrategy[Node]) -> st.SearchStrategy[Node]:
        two = st.builds(lambda s, a, b: Operation(s, (a, b)), st.sampled_from("+-*/"), below, below)
        one = st.builds(lambda f, a: Operation(f, (a,)), st.sampled_from([*FUNCTIONS, "negate"]), below)
        power = st.builds(Power, below, st.integers(-3, 3))
        return two | one | power

    return st.recursive(leaves, grown, max_leaves=12)


def pythons(node: Node) -> float:
    """Return the value of an expression, computed with Python's own floats."""
    if isinstance(node, Constant):
        return node.value.value if isinstance(node.value, Parameter) else node.value
    if isinstance(node, Variable):
        return VALUES[node.name]
    if isinstance(node, Power):
        return float(pythons(node.base) ** node.exponent)
    operands = [pythons(operand) for operand in node.operands]
    operations: dict[str, Callable[..., float]] = {
        "+": lambda a, b: a + b,
        "-": lambda a, b: a - b,
        "*": lambda a, b: a * b,
        "/": lambda a, b: a / b,
        "negate": lambda a: -a,
        "abs": abs,
    }
    return float((operations.get(node.operator) or getattr(math, node.operator))(*operands))


@given(trees())
def test_printing_and_reading_give_the_same_value(node: Node) -> None:
    """Reading printed text gives an equal value; -2.0 is read as the negative of 2.0."""
    expression = Expression(node)
    again = parse(str(expression), [K])
    assert str(parse(str(again), [K])) == str(again)
    with np.errstate(all="ignore"):
        try:
            expected = pythons(node)
        except (ValueError, ZeroDivisionError, OverflowError):
            return
        bits = evaluate(expression, {n: np.float64(v) for n, v in VALUES.items()}, np.float64)
        assert bits == evaluate(again, {n: np.float64(v) for n, v in VALUES.items()}, np.float64)
        error = evaluate(
            expression,
            {n: Rounded(np.float64(v), 0.0) for n, v in VALUES.items()},
            lambda v: Rounded(np.float64(v), 0.0),
        ).error
    if math.isfinite(error):
        assert abs(bits - expected) <= 8 * 2.0**-53 * error + 1e-300


@given(trees(), st.sampled_from(sorted(VALUES)))
def test_slopes_are_those_of_high_precision_differences(node: Node, name: str) -> None:
    def exactly(moved: mpmath.mpf) -> mpmath.mpf:
        def walk(at: Node) -> mpmath.mpf:
            if isinstance(at, Constant):
                return mpmath.mpf(at.value.value if isinstance(at.value, Parameter) else at.value)
            if isinstance(at, Variable):
                return mpmath.mpf(VALUES[at.name]) + moved * (at.name == name)
            if isinstance(at, Power):
                return walk(at.base) ** at.exponent
            operands = [walk(operand) for operand in at.operands]
            match at.operator:
                case "+":
                    return operands[0] + operands[1]
                case "-":
                    return operands[0] - operands[1]
                case "*":
                    return operands[0] * operands[1]
                case "/":
                    return operands[0] / operands[1]
                case "negate":
                    return -operands[0]
                case "abs":
                    return abs(operands[0])
            return getattr(mpmath, at.operator)(operands[0])

        return walk(node)

    with mpmath.workdps(60):
        try:
            ends = [exactly(mpmath.mpf(side) * mpmath.mpf("1e-20")) for side in (-1, 1)]
        except ZeroDivisionError:
            return
        if not all(isinstance(end, mpmath.mpf) and mpmath.isfinite(end) for end in ends):
            return
        expected = (ends[1] - ends[0]) / mpmath.mpf("2e-20")
    with np.errstate(all="ignore"):
        steady = {
            n: Dual(Rounded(np.float64(v), 0.0), Rounded(1.0 * (n == name), 0.0)) for n, v in VALUES.items()
        }
        zero = Rounded(0.0, 0.0)
        slope = evaluate(Expression(node), steady, lambda v: Dual(Rounded(np.float64(v), 0.0), zero)).slope
    if np.isfinite(slope.error) and slope.error < 1e6:
        assert abs(float(slope.value) - float(expected)) <= 1e-14 * (1 + slope.error)
