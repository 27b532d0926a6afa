"""Passes keep values, save operations, respect products with other uses, and can be left out."""

from __future__ import annotations

import random
from collections.abc import Iterator
from itertools import chain, combinations
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.errors import ModelError
from kanegen.options import Variant, chosen_variant
from kanegen.program import passes
from kanegen.program.builder import Builder
from kanegen.program.check import check
from kanegen.program.count import count
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import EVALUATE, Array, Op, Output, Program
from kanegen.program.passes.factor import factor
from kanegen.program.passes.fold import FoldingBuilder, fold
from kanegen.program.passes.prune import prune
from kanegen.recursion.outputs import DERIVATIVES, PRODUCTS, SECOND_DERIVATIVES, available
from tests.support import systems
from tests.support.paths import MODELS

X = Array("x", (4,), "m", "numbers")
SUBSETS = list(
    chain.from_iterable(combinations(passes.PASS_NAMES, n) for n in range(len(passes.PASS_NAMES) + 1))
)


def outputs(*values: int) -> list[Output]:
    return [Output(Array("out", (len(values),), "m", "results"), values)]


def cost(program: Program) -> int:
    return sum(count(prune(program)).values())


@pytest.fixture
def builder() -> Builder:
    return Builder((X,))


@pytest.fixture
def folding() -> FoldingBuilder:
    return FoldingBuilder((X,))


def test_zeros_ones_and_signs_vanish(folding: FoldingBuilder) -> None:
    a, b = folding.input("x", 0), folding.input("x", 1)
    zero, one, minus = (folding.constant(v) for v in (0.0, 1.0, -1.0))
    assert folding.add(a, zero) == a
    assert folding.add(zero, a) == a
    assert folding.subtract(a, zero) == a
    assert folding.multiply(one, a) == a
    assert folding.multiply(a, zero) == zero
    assert folding.subtract(a, a) == zero
    assert folding.divide(a, one) == a
    assert folding.divide(zero, a) == zero
    negated = folding.multiply(a, minus)
    assert folding.negate(negated) == a
    assert folding.subtract(zero, a) == negated
    assert folding.multiply(negated, b) == folding.negate(folding.multiply(a, b))
    assert folding.multiply(negated, folding.negate(b)) == folding.multiply(b, a)
    assert folding.add(a, folding.negate(b)) == folding.subtract(a, b)
    assert folding.subtract(b, a) == folding.negate(folding.subtract(a, b))
    assert folding.divide(negated, b) == folding.negate(folding.divide(a, b))
    assert folding.divide(b, negated) == folding.negate(folding.divide(b, a))
    assert folding.function(Op.SIN, negated) == folding.negate(folding.function(Op.SIN, a))
    assert folding.function(Op.COS, negated) == folding.function(Op.COS, a)


def test_numbers_fold(folding: FoldingBuilder) -> None:
    three, four = folding.constant(3.0), folding.constant(4.0)
    assert folding.add(three, four) == folding.constant(7.0)
    assert folding.subtract(three, four) == folding.constant(-1.0)
    assert folding.multiply(three, four) == folding.constant(12.0)
    assert folding.divide(three, four) == folding.constant(0.75)
    assert folding.function(Op.SQRT, four) == folding.constant(2.0)


def test_overflow_while_folding_is_an_error(folding: FoldingBuilder) -> None:
    large = folding.constant(1e300)
    with pytest.raises(ModelError, match="leaves the range of double precision"):
        folding.multiply(large, large)


def test_fold_computes_nothing_twice(builder: Builder) -> None:
    a, b = builder.input("x", 0), builder.input("x", 1)
    first = builder.name(builder.add(a, b), "first")
    second = builder.name(builder.add(b, a), "second")
    program = builder.program(outputs(builder.multiply(first, second), builder.subtract(first, second)))
    folded = fold(program)
    assert count(program) == {"add": 3, "multiply": 1, "divide": 0, "sqrt": 0, "sincos": 0}
    assert count(folded) == {"add": 1, "multiply": 1, "divide": 0, "sqrt": 0, "sincos": 0}
    assert [i.name for i in folded.instructions if i.name] == ["first"]


def test_prune_keeps_only_what_outputs_need(builder: Builder) -> None:
    a, b = builder.input("x", 0), builder.input("x", 1)
    used = builder.multiply(a, b)
    builder.add(used, a)
    program = prune(builder.program(outputs(used)))
    assert [i.op for i in program.instructions] == [Op.INPUT, Op.INPUT, Op.MULTIPLY]


def test_factor_saves_a_multiplication(builder: Builder) -> None:
    a, b, c = (builder.input("x", i) for i in range(3))
    total = builder.subtract(builder.multiply(a, b), builder.multiply(c, a))
    program = builder.program(outputs(builder.name(total, "total", "a note")))
    factored = factor(program)
    assert count(program) == {"add": 1, "multiply": 2, "divide": 0, "sqrt": 0, "sincos": 0}
    assert count(factored) == {"add": 1, "multiply": 1, "divide": 0, "sqrt": 0, "sincos": 0}
    assert exact(factored) == exact(program)
    assert [(i.op, i.note) for i in factored.instructions if i.name == "total"] == [(Op.MULTIPLY, "a note")]


def test_factor_leaves_products_that_others_use(builder: Builder) -> None:
    a, b, c = (builder.input("x", i) for i in range(3))
    product = builder.multiply(a, b)
    program = builder.program(outputs(builder.add(product, builder.multiply(a, c)), product))
    assert factor(program) == program


def test_equal_sums_after_factoring_are_shared(builder: Builder) -> None:
    a, b, c, d = (builder.input("x", i) for i in range(4))
    sums = [builder.add(builder.multiply(f, b), builder.multiply(f, c)) for f in (a, d)]
    program, stages = passes.run(builder.program(outputs(*sums)))
    assert count(program) == {"add": 1, "multiply": 2, "divide": 0, "sqrt": 0, "sincos": 0}
    assert passes.savings(stages) == {"fold": 1, "prune": 0, "factor": 2}


FIELD = sympy.GF(2**61 - 1, symmetric=False)
"""A finite field, in which nothing is rounded: a pass keeps a value exactly, or the test fails."""


class FieldFunctions:
    """Replacements of sine and cosine in the field: an odd function, and an even one that is 1 at 0."""

    @staticmethod
    def sin(a: Any) -> Any:
        return a / (1 + a * a)

    @staticmethod
    def cos(a: Any) -> Any:
        return 1 / (1 + a * a)


def residue(number: float) -> Any:
    numerator, denominator = number.as_integer_ratio()
    return FIELD(numerator) / FIELD(denominator)


def exact(program: Program) -> list[Any]:
    state = [FIELD(n) for n in (314159265358979, 271828182845904, 141421356237309, 577215664901532)]
    return evaluate(check(program), {"x": state}, FieldFunctions, residue)["out"]


def random_program(seed: int, length: int = 200) -> Program:
    """A program of all operations but the square root, with many zeros, ones, signs and repetitions."""
    rng = random.Random(seed)
    builder = Builder((X,))
    inputs = [builder.input("x", i, f"x_{i}") for i in range(4)]
    numbers = [builder.constant(v) for v in (0.0, 1.0, -1.0, 0.5)]
    values = list(inputs)
    for i in range(length):
        a, b = rng.choice(values), rng.choice([*values[-20:], *inputs, *numbers])
        angle = builder.multiply(rng.choice(inputs), rng.choice(numbers[:3]))
        operation = rng.choice("+ - * * neg / sin cos factors".split())
        match operation:
            case "+":
                value = builder.add(a, b)
            case "-":
                value = builder.subtract(a, b)
            case "*":
                value = builder.multiply(a, b)
            case "neg":
                value = builder.negate(a)
            case "/":
                value = builder.divide(a, rng.choice(inputs))
            case "factors":
                value = builder.subtract(builder.multiply(a, b), builder.multiply(rng.choice(inputs), a))
            case _:
                value = builder.function(Op(operation), angle)
        values.append(builder.name(value, f"v_{i}"))
    return check(builder.program(outputs(*rng.sample(values, 12))))


@pytest.mark.parametrize("seed", range(30))
def test_any_subset_of_passes_keeps_every_value_exactly(seed: int) -> None:
    program = random_program(seed)
    for without in SUBSETS:
        assert exact(passes.run(program, passes.all_but(without))[0]) == exact(program), without


@pytest.mark.parametrize("seed", range(30))
def test_no_pass_adds_operations(seed: int) -> None:
    program = random_program(seed)
    costs = {}
    for without in SUBSETS:
        result, stages = passes.run(program, passes.all_but(without))
        costs[frozenset(without)] = cost(result)
        totals = [sum(stage.operations.values()) for stage in stages]
        assert totals == sorted(totals, reverse=True), without
        assert sum(passes.savings(stages).values()) == totals[0] - totals[-1]
    for without, left in costs.items():
        assert all(left <= costs[without | {name}] for name in passes.PASS_NAMES), set(without)


def trees() -> Iterator[kg.System]:
    yield kg.load(MODELS / "gantry_crane.toml")
    for seed in range(2):
        rng = np.random.default_rng(seed)
        yield systems.random_system(rng, bodies=int(rng.integers(1, 4)))


def numbers(array: Array) -> list[Any]:
    rng = random.Random(array.name)
    return [mpmath.mpf(rng.uniform(-1, 1)) for _ in range(array.size)]


def values(system: kg.System, without: tuple[str, ...], left_out: tuple[str, ...]) -> dict[str, list[Any]]:
    """Outputs in one state to 40 digits, except those that consist of rounding errors."""
    outputs = [name for name in available(system) if name not in ("error_estimate", "error_bound", *left_out)]
    module = compile_module(system, outputs, variant=Variant(without=without)).module
    program = module.functions[EVALUATE]
    inputs = {array.name: numbers(array) for array in program.inputs}
    if module.prepare:
        parameters = {"parameters": [mpmath.mpf(p.value) for p in system.parameters]}
        inputs |= evaluate(module.prepare, parameters, mpmath, mpmath.mpf)
    return evaluate(program, inputs, mpmath, mpmath.mpf)


CRANE, LARGER_TREE, TREE = trees()


@pytest.mark.parametrize(
    "system",
    [CRANE, *(pytest.param(tree, marks=pytest.mark.slow) for tree in (TREE, LARGER_TREE))],
    ids=lambda system: f"{system.name}{len(system.freedoms)}",
)
@pytest.mark.parametrize(
    "left_out",
    [(*DERIVATIVES, *PRODUCTS, *SECOND_DERIVATIVES), pytest.param((), marks=pytest.mark.slow)],
    ids=["no derivatives", "every output"],
)
def test_the_equations_do_not_depend_on_the_passes(system: kg.System, left_out: tuple[str, ...]) -> None:
    """Values differ by the rounding of folded numbers only; the comparison computes with 40 digits."""
    with mpmath.workdps(40):
        standard = values(system, (), left_out)
        for without in SUBSETS[1:]:
            for name, entries in values(system, without, left_out).items():
                scale = max(abs(entry) for entry in standard[name])
                worst = max(abs(a - b) for a, b in zip(entries, standard[name], strict=True))
                assert worst <= 1e-12 * scale, (name, without)


def test_every_pass_saves_something_in_some_model() -> None:
    stages = compile_module(kg.load(MODELS / "gantry_crane.toml")).stages
    assert all(passes.savings(stages)[name] > 0 for name in passes.PASS_NAMES)


@pytest.mark.parametrize("without", [(name,) for name in passes.PASS_NAMES] + [passes.PASS_NAMES])
def test_c_without_passes_computes_the_same(without: tuple[str, ...]) -> None:
    system = kg.load(MODELS / "gantry_crane.toml")
    standard, library = kg.build(system), kg.build(system, without=without)
    x, y = np.random.default_rng(5).uniform(-1, 1, (2, 20, len(system.freedoms)))
    np.testing.assert_allclose(library.mass_matrix(x), standard.mass_matrix(x), rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(library.forcing(x, y), standard.forcing(x, y), rtol=1e-12, atol=1e-9)
    assert sum(library.source.operations.values()) >= sum(standard.source.operations.values())


def test_passes_are_left_out_by_name() -> None:
    system = kg.load(MODELS / "double_pendulum.toml")
    compiled = compile_module(system, variant=chosen_variant(without=["factor", "factor"]))
    assert [stage.name for stage in compiled.stages] == ["lower", "fold", "prune", "fold"]
    assert kg.generate(system, without="factor").operations == compiled.operations
    assert passes.all_but(()) == passes.PASSES


def test_unknown_passes_are_refused() -> None:
    system = kg.load(MODELS / "double_pendulum.toml")
    with pytest.raises(kg.OptionError, match=r"^unknown pass 'factr'\. Did you mean 'factor'\?$"):
        kg.generate(system, without=("factr",))
    with pytest.raises(kg.OptionError, match="expected names, got 3"):
        kg.generate(system, without=3)  # type: ignore[arg-type]
