"""Deep expressions and powers: values and slopes of generated code against 60 digits, in linear time."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable, Sequence

import mpmath
import numpy as np
import pytest

import kanegen as kg
from kanegen.model.grammar import MAX_CHARACTERS, MAX_DEPTH, MAX_EXPONENT, MAX_OPERATIONS
from kanegen.reference import expressions
from kanegen.symbolic.expressions import LONGEST_PART
from kanegen.symbolic.printing.formats import FORMATS, render
from tests.support.cases import slow_among, slow_except

X = 0.3
UNIT = 2.0**-53
Real = Callable[[mpmath.mpf], mpmath.mpf]


def sliders(*elements: kg.ForceElement, count: int = 1) -> kg.System:
    """Return bodies on parallel slides without gravity, so that {f} holds the efforts and nothing else."""
    slide = kg.Joint(free=(False, False, False, True, False, False))
    bodies = tuple(kg.Body(f"b{k}", 0, 1.0, np.zeros((3, 3)), joint=slide) for k in range(count))
    return kg.System("slides", bodies, gravity=(0, 0, 0), force_elements=elements)


def forces(elements: Sequence[kg.ForceElement], x: Sequence[float]) -> np.ndarray:
    """Return {f} of bodies on slides, one for each element."""
    library = kg.build(sliders(*elements, count=len(x)), ("forcing",))
    return np.asarray(library.forcing(x, np.zeros(len(x))))


def nested(begin: str, depth: int, end: str = ")") -> str:
    return begin * depth + "x.b0.s1" + end * depth


def repeated(function: Real, depth: int) -> Real:
    def value(x: mpmath.mpf) -> mpmath.mpf:
        for _ in range(depth):
            x = function(x)
        return x

    return value


def balanced(depth: int) -> str:
    """Return a tree of products, whose derivative written out would have exponential length."""
    return "x.b0.s1" if depth == 0 else f"({balanced(depth - 1)} + 1)*(1 - {balanced(depth - 1)})"


DEEP: dict[str, tuple[str, Real]] = {
    "tangents": (nested("tan(", 16), repeated(mpmath.tan, 16)),
    "tangents of small angles": (nested("tan(0.5*", 90), repeated(lambda v: mpmath.tan(v / 2), 90)),
    "roots": (nested("sqrt(1+", 60), repeated(lambda v: mpmath.sqrt(1 + v), 60)),
    "more roots": (nested("sqrt(1+", 90), repeated(lambda v: mpmath.sqrt(1 + v), 90)),
    "sines": (nested("sin(", 150), repeated(mpmath.sin, 150)),
    "as deep as is read": (nested("sin(", MAX_DEPTH - 1), repeated(mpmath.sin, MAX_DEPTH - 1)),
    "fractions": (nested("1/(1+", 80), repeated(lambda v: 1 / (1 + v), 80)),
    "sizes of roots": (nested("abs(sqrt(", 20, "))"), repeated(lambda v: abs(mpmath.sqrt(v)), 20)),
    "products": (balanced(6), repeated(lambda v: (v + 1) * (1 - v), 6)),
}


@pytest.mark.parametrize(
    "name", slow_among(DEEP, "roots", "more roots", "sizes of roots", "tangents of small angles")
)
def test_value_and_slope_of_a_deep_expression(name: str) -> None:
    """Tolerance: four times the running error bound of the reference; the code may order operations anew."""
    text, exact = DEEP[name]
    expression = kg.parse(text)
    variables = {"x.b0.s1": np.float64(X)}
    (value,) = forces([kg.Drive("b0.s1", expression)], [X])
    (slope,) = forces([kg.Potential(expression)], [X])
    with mpmath.workdps(60):
        true_value, true_slope = exact(mpmath.mpf(X)), mpmath.diff(exact, mpmath.mpf(X))
        _, bound = expressions.value(expression, variables)
        assert abs(value - true_value) <= 4 * UNIT * bound
        _, bound = expressions.slope(expression, variables, "x.b0.s1")
        assert abs(-slope - true_slope) <= 4 * UNIT * bound


@pytest.mark.parametrize("name", slow_among(DEEP, "more roots", "tangents of small angles"))
def test_literal_derivation_of_a_deep_expression(name: str) -> None:
    """The literal derivation has the same parts by other numbers; lambdify evaluates them in NumPy."""
    system = sliders(kg.Drive("b0.s1", DEEP[name][0]))
    equations = kg.derive(system)
    literal = equations.lambdify().forcing([X], [0.0])
    np.testing.assert_allclose(literal, forces(system.force_elements, [X]), rtol=1e-12)
    assert kg.generate(system, ("forcing",)).operations


def test_cost_grows_with_the_length_of_an_expression() -> None:
    for depth in (16, 32, 64):
        value = kg.generate(sliders(kg.Drive("b0.s1", nested("tan(", depth))), ("forcing",)).operations
        slope = kg.generate(sliders(kg.Potential(nested("tan(", depth))), ("forcing",)).operations
        assert (value["sincos"], value["divide"]) == (2 * depth, depth)
        # A tangent needs sine, cosine and quotient, its slope a few products and quotients more.
        assert slope["sincos"] == 2 * depth
        assert sum(slope.values()) <= 12 * depth


def test_short_expressions_have_no_parts() -> None:
    terms = " + ".join(["x.b0.s1**2*sin(t)"] * (LONGEST_PART // 4))
    code = kg.generate(sliders(kg.Drive("b0.s1", terms)), ("forcing",)).files["slides.c"]
    assert "ex_1" not in code
    code = kg.generate(sliders(kg.Drive("b0.s1", f"sin({terms})*cos({terms})")), ("forcing",)).files[
        "slides.c"
    ]
    assert "ex_1" in code
    assert "part of the expression of a force element" in code


def test_equal_parts_of_different_elements_are_computed_once() -> None:
    long = nested("sin(", 40)
    one = kg.generate(sliders(kg.Drive("b0.s1", long)), ("forcing",)).operations
    two = kg.generate(
        sliders(kg.Drive("b0.s1", long), kg.Drive("b1.s1", f"2*({long})"), count=2), ("forcing",)
    ).operations
    assert two["sincos"] == one["sincos"]


def test_closed_form_of_a_deep_expression_is_refused() -> None:
    equations = kg.derive(sliders(kg.Drive("b0.s1", nested("sin(", 150))))
    with pytest.raises(kg.OptionError, match="too long to be read without intermediates"):
        equations.closed_form()


@pytest.mark.parametrize("format", FORMATS)
def test_documents_define_the_parts(format: str) -> None:
    text = render(kg.derive(sliders(kg.Drive("b0.s1", nested("sin(", 150)))), format)
    assert "loads on points" in text or format == "python"
    assert max(map(len, text.splitlines())) < 1500


@pytest.mark.parametrize("depth", [1, MAX_DEPTH - 1])
def test_expressions_are_copied_pickled_saved_and_compared_at_every_depth(depth: int) -> None:
    expression = kg.parse(f"k*x.b0.s1 + {nested('abs(', depth - 1)}**-2", [kg.Parameter("k", 2.0)])
    assert pickle.loads(pickle.dumps(expression)) == expression
    assert copy.deepcopy(expression) == expression
    assert hash(copy.copy(expression)) == hash(expression)
    assert kg.parse(str(expression), [kg.Parameter("k", 2.0)]) == expression
    assert repr(expression) == f"parse({str(expression)!r})"


def test_longest_expressions_can_be_read_again_after_they_were_saved() -> None:
    """Printing adds spaces, brackets and digits, which must not exceed what is read."""
    name = "x" * 63
    leaf = f'(1e15*x["{name}.s1"]+sqrt(t))*'
    text = leaf * (MAX_OPERATIONS // 4 // 5)
    expression = kg.parse("+".join([f"({text}1)"] * 4))
    assert len(str(expression)) > len(text)
    assert kg.parse(str(expression)) == expression
    longest = (MAX_OPERATIONS + 1) * len(f'x["{name}.omega1"]') + MAX_OPERATIONS * len("sqrt(()) + ")
    assert longest <= MAX_CHARACTERS


def test_constants_with_too_many_digits_are_refused() -> None:
    for text in ("(1 + 1e-300)**64", "*".join(["1e300"] * 100), "(1e300*(1+1e-300))**64"):
        with pytest.raises(kg.ModelError, match="Write it as one number"):
            kg.generate(sliders(kg.Drive("b0.s1", f"{text}*x.b0.s1")), ("forcing",))


POWERS = [k for k in range(-MAX_EXPONENT, MAX_EXPONENT + 1) if k]
BASES: dict[str, Real] = {
    "{x}": lambda x: x,
    "sqrt({x})": mpmath.sqrt,
    "abs({x})": abs,
    "(2*{x})": lambda x: 2 * x,
    "(1 + sqrt({x}))": lambda x: 1 + mpmath.sqrt(x),
}


@pytest.mark.parametrize("base", slow_except(BASES, *list(BASES)[-1:]))
@pytest.mark.parametrize("kind", ["value", "slope"])
def test_every_power(base: str, kind: str) -> None:
    """x**k and its slope for every exponent, whole and half: by squaring, |k| roundings and a few more."""
    texts = [f"{base.format(x=f'x.b{i}.s1')}**{k}" for i, k in enumerate(POWERS)]
    x = np.linspace(0.7, 1.4, len(POWERS))
    elements = [
        kg.Drive(f"b{i}.s1", text) if kind == "value" else kg.Potential(text) for i, text in enumerate(texts)
    ]
    computed = forces(elements, [*x])
    with mpmath.workdps(60):
        for i, k in enumerate(POWERS):
            power = repeated_power(BASES[base], k)
            at = mpmath.mpf(float(x[i]))
            exact = power(at) if kind == "value" else -mpmath.diff(power, at)
            assert abs(computed[i] - exact) <= (abs(k) + 8) * 2 * UNIT * abs(exact), texts[i]
            variables = {f"x.b{i}.s1": np.float64(x[i])}
            parsed = kg.parse(texts[i])
            reference, bound = (
                expressions.value(parsed, variables)
                if kind == "value"
                else expressions.slope(parsed, variables, f"x.b{i}.s1")
            )
            sign = 1 if kind == "value" else -1
            assert abs(computed[i] - sign * reference) <= 4 * UNIT * bound, texts[i]


@pytest.mark.parametrize("depth", [2, 3])
@pytest.mark.parametrize("kind", ["value", "slope"])
def test_powers_of_roots_of_roots(depth: int, kind: str) -> None:
    """Exponents that are quarters and eighths, the roots of which are multiplied."""
    exponents = [k for k in range(-19, 20, 2)]
    x = np.linspace(0.7, 1.4, len(exponents))
    texts = [f"{'sqrt(' * depth}x.b{i}.s1{')' * depth}**{k}" for i, k in enumerate(exponents)]
    computed = forces(
        [kg.Drive(f"b{i}.s1", t) if kind == "value" else kg.Potential(t) for i, t in enumerate(texts)], [*x]
    )
    with mpmath.workdps(60):
        for found, at, k in zip(computed, map(mpmath.mpf, map(float, x)), exponents, strict=True):
            power = mpmath.mpf(k) / 2**depth
            exact = at**power if kind == "value" else -power * at ** (power - 1)
            assert abs(found - exact) <= 40 * UNIT * abs(exact), (k, depth)


def repeated_power(base: Real, exponent: int) -> Real:
    return lambda x: base(x) ** exponent
