"""The grammar of expressions: accepted and refused texts, printing, and rounding."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kanegen.errors import ModelError
from kanegen.model.expression import Expression
from kanegen.model.grammar import MAX_CHARACTERS, MAX_EXPONENT, parse
from kanegen.model.nodes import COMPARISONS, FUNCTIONS, Constant, Node, Operation, Power, Variable
from kanegen.model.numbers import Parameter
from kanegen.reference.expressions import Dual, Rounded, evaluate

K = Parameter("k", 2.5)
VALUES = {"x.arm.theta1": 0.7, "y.arm.s2": -1.3, "t": 0.2}


def value(text: str) -> float:
    with np.errstate(all="ignore"):  # branches that are not taken
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
        "min(t, k, x.arm.theta1) + max(t, k)*sign(y.arm.s2)": t - k,
        "tanh(x.arm.theta1) + exp(y.arm.s2) + log(k)": math.tanh(x) + math.exp(y) + math.log(k),
        "atan2(y.arm.s2, -x.arm.theta1) - pi": math.atan2(y, -x) - math.pi,
        "k if x.arm.theta1 > 0 else log(-1)": k,
        "1 if t < 0 else 2 if t <= 0.1 else 3": 3.0,
        "1 if 0 < t <= 0.2 and not t > k or log(-1) > 0 else 2": 1.0,
        "1 if t > 1 and log(-1) > 0 else 2": 2.0,
        "(1 if t >= 0.2 else 2)*2": 2.0,
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
        ("1 +", r"'1 \+': nothing after '\+'\.$"),
        ("1 2", "no expression near column 3"),
        (r"'\d'", "no number"),
        ("1; 2", "no expression"),
        ("x", "'x': one element is needed, such as x.arm.theta1"),
        ("z.real", "'z.real': only x and y have elements"),
        ("(1).real", "only x and y have elements"),
        ("x.a.theta1().real", "only x and y have elements"),
        ("x[0]", "only x and y have elements"),
        ("foo(1)", r"there is no function 'foo'\. There are abs, atan2, cos, .* sqrt, tan, tanh\."),
        ("tanhh(1)", r"there is no function 'tanhh'\. There are"),
        ("log10(1)", r"there is no function 'log10'\. There are"),
        ("atan2(1)", "atan2 takes two numbers"),
        ("atan2(1, 2, 3)", "atan2 takes two numbers"),
        ("max(1)", "max takes two numbers or more"),
        ("min(1, key=2)", "min takes two numbers or more"),
        ("exp()", "exp takes one number"),
        ("__import__('os').system('true')", "there is no function"),
        ("sin(1, 2)", "sin takes one number"),
        ("sin(x=1)", "sin takes one number"),
        ("sin(*x)", "only numbers, names"),
        ("2**k", "an exponent is a whole number; for roots there is sqrt"),
        ("2**0.5", "an exponent is a whole number"),
        ("9**9**9", f"an exponent is written as one whole number, at most {MAX_EXPONENT}"),
        ("2**(1/2)", "an exponent is written as one whole number, .* for roots there is sqrt"),
        ("2**~3", "'~3' in expression .* an exponent is a whole number"),
        ("2**-True", "an exponent is a whole number"),
        ("2**100000000", f"a huge power; together exponents reach at most {MAX_EXPONENT}"),
        ("((2**16)**16)**16", "a huge power"),
        ("1 if t else 2", "'t' in expression .* a condition compares numbers by < <= > >="),
        ("1 if t == 2 else 3", "a condition compares numbers"),
        ("1 if True else 3", "a condition compares numbers"),
        ("t < 2", "a condition is no number. Write <number> if <condition> else <number>"),
        ("not t", "a condition is no number"),
        ("t and 2", "a condition is no number"),
        ("max(t < 2, 1)", "'t < 2' in expression .* a condition is no number"),
        ("1 if t < 2", "no expression"),
        ("2**(1 if t < 2 else 3)", "an exponent is a whole number"),
        ("0 < " * 150 + "t", "a condition is no number"),
        ("1 if " + "t < " * 99 + "2 else 0 + t" * 1 + " + t" * 199, "inside each other"),
        ("0 < (1 if 0 < " * 12 + "t" + " < 2 else 0) < 2" * 12, "a condition is no number"),
        ("1 if 0 < (" * 12 + "t" + ") < 2 else 0" * 12, "more than 2000 operations"),
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
        ("x.q^2", r"a power is written with \*\*, as in"),
        ("x.q**2.5", "an exponent is a whole number; for roots there is sqrt"),
        ("x.q**1e300", "a huge power"),
        ("x.q**1e999", "an exponent is a whole number"),
        ("kk*t", "'kk' in expression .*: the name is not known. Write x.<coordinate>, .* or a parameter. "),
        ("kay*t", "Known are 'k'"),
    ],
)
def test_what_is_refused(text: str, message: str) -> None:
    with pytest.raises(ModelError, match=message) as raised:
        parse(text, [K])
    assert len(str(raised.value)) < 400
    assert raised.value.__cause__ is None


def test_a_whole_exponent_may_be_written_with_a_point() -> None:
    assert parse("x.q**3.0 + x.q**-2.0") == parse("x.q**3 + x.q**-2")


def test_negative_numbers_in_expressions_of_operators_read_back_as_written() -> None:
    p = Parameter("p", 1.5)
    for made in (p * -0.5, p**2 * -2.9, p - (-3), p + -1, -3 / p, (p - 1) ** -2, -(-2.5 * p)):
        assert parse(str(made), [p]) == made


@pytest.mark.parametrize("wrong", [None, [], {}, 1j, True, float("nan")])
def test_what_is_no_text(wrong: object) -> None:
    with pytest.raises(ModelError, match="expression: "):
        parse(wrong)


def trees() -> st.SearchStrategy[Node]:
    numbers = st.floats(-9, 9).map(lambda v: Constant(v + 0.0))
    leaves = numbers | st.sampled_from([Constant(K), *(Variable(name) for name in VALUES)])

    def grown(below: st.SearchStrategy[Node]) -> st.SearchStrategy[Node]:
        pairs = st.sampled_from([*"+-*/", *(name for name, count in FUNCTIONS.items() if count == 2)])
        singles = st.sampled_from(["negate", *(name for name, count in FUNCTIONS.items() if count == 1)])
        two = st.builds(lambda s, a, b: Operation(s, (a, b)), pairs, below, below)
        one = st.builds(lambda f, a: Operation(f, (a,)), singles, below)
        power = st.builds(Power, below, st.integers(-3, 3))
        chosen = st.builds(lambda *parts: Operation("if", parts), conditions(below), below, below)
        return two | one | power | chosen

    return st.recursive(leaves, grown, max_leaves=12)


def conditions(numbers: st.SearchStrategy[Node]) -> st.SearchStrategy[Node]:
    compared = st.builds(lambda s, a, b: Operation(s, (a, b)), st.sampled_from(COMPARISONS), numbers, numbers)
    joined = st.builds(
        lambda s, p, q: Operation(s, (p, q)), st.sampled_from(["and", "or"]), compared, compared
    )
    return compared | joined | st.builds(lambda p: Operation("not", (p,)), compared)


def holds(node: Operation, value: Callable[[Node], Any]) -> bool:
    """Return whether a condition holds, by Python's own operators; NaN raises an error."""
    match node.operator:
        case "and":
            return holds(node.operands[0], value) and holds(node.operands[1], value)
        case "or":
            return holds(node.operands[0], value) or holds(node.operands[1], value)
        case "not":
            return not holds(node.operands[0], value)
    a, b = (value(operand) for operand in node.operands)
    return bool(getattr(operator, {"<": "lt", "<=": "le", ">": "gt", ">=": "ge"}[node.operator])(a, b))


PYTHONS: dict[str, Callable[..., Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "negate": operator.neg,
    "abs": abs,
    "min": min,
    "max": max,
    "sign": lambda a: (a > 0) - (a < 0),
}
"""Python's own functions for operations on numbers of any kind."""


def pythons(node: Node) -> float:
    """Return the value of an expression, computed with Python's own floats."""
    if isinstance(node, Constant):
        return node.value.value if isinstance(node.value, Parameter) else node.value
    if isinstance(node, Variable):
        return VALUES[node.name]
    if isinstance(node, Power):
        return float(pythons(node.base) ** node.exponent)
    if node.operator == "if":
        condition, then, otherwise = node.operands
        return pythons(then) if holds(condition, pythons) else pythons(otherwise)
    operands = [pythons(operand) for operand in node.operands]
    return float((PYTHONS.get(node.operator) or getattr(math, node.operator))(*operands))


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


def in_many_digits(name: str, operands: list[mpmath.mpf]) -> mpmath.mpf:
    """Return the result of an operation in numbers of mpmath; what is no real number raises an error."""
    if name in PYTHONS:
        return PYTHONS[name](*operands)
    if name == "pi":
        return +mpmath.pi
    if name == "exp" and abs(operands[0]) > 1e6:
        raise ZeroDivisionError("too large for a double")
    found = getattr(mpmath, name)(*operands)
    if not isinstance(found, mpmath.mpf):
        raise ZeroDivisionError("no real number")
    return found


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
            if at.operator == "if":
                condition, then, otherwise = at.operands
                return walk(then) if holds(condition, walk) else walk(otherwise)
            return in_many_digits(at.operator, [walk(operand) for operand in at.operands])

        return walk(node)

    with mpmath.workdps(60):
        try:
            ends = [exactly(mpmath.mpf(side) * mpmath.mpf("1e-20")) for side in (-1, 0, 1)]
        except ZeroDivisionError:
            return
        if not all(isinstance(end, mpmath.mpf) and mpmath.isfinite(end) for end in ends):
            return
        left, right = ((b - a) / mpmath.mpf("1e-20") for a, b in pairwise(ends))
        expected = (left + right) / 2
        if abs(right - left) > 1e-9 * (abs(left) + abs(right)) or abs(expected) > 1e15 * (1 + abs(ends[1])):
            return  # a kink or a jump; there a slope is a matter of definition
    with np.errstate(all="ignore"):
        steady = {
            n: Dual(Rounded(np.float64(v), 0.0), Rounded(1.0 * (n == name), 0.0)) for n, v in VALUES.items()
        }
        zero = Rounded(0.0, 0.0)
        slope = evaluate(Expression(node), steady, lambda v: Dual(Rounded(np.float64(v), 0.0), zero)).slope
    if np.isfinite(slope.error) and slope.error < 1e6:
        assert abs(float(slope.value) - float(expected)) <= 1e-14 * (1 + slope.error)
