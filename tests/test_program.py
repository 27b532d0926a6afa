"""Builder, passes and split keep values; the invariants are checked."""

from __future__ import annotations

import math
import random
from dataclasses import replace

import pytest

from kanegen.errors import ModelError
from kanegen.program import passes
from kanegen.program.builder import Builder
from kanegen.program.check import InvariantError, check
from kanegen.program.count import count, operations
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import Array, Instruction, Op, Output, Program
from kanegen.program.passes.factor import factor
from kanegen.program.passes.prune import prune
from kanegen.program.split import Signature, split

X = Array("x", (4,), "m", "numbers")
P = Array("parameters", (3,), "m", "more numbers")


def outputs(*values: int, name: str = "out") -> list[Output]:
    return [Output(Array(name, (len(values),), "m", "results"), values)]


def run(program: Program, **inputs: list[float]) -> list[float]:
    results = evaluate(program, inputs, math)
    return [value for values in results.values() for value in values]


@pytest.fixture
def builder() -> Builder:
    return Builder((X,))


def test_zeros_ones_and_signs_vanish(builder: Builder) -> None:
    a, b = builder.input("x", 0), builder.input("x", 1)
    zero, one, minus = (builder.constant(v) for v in (0.0, 1.0, -1.0))
    assert builder.add(a, zero) == a
    assert builder.add(zero, a) == a
    assert builder.subtract(a, zero) == a
    assert builder.multiply(one, a) == a
    assert builder.multiply(a, zero) == zero
    assert builder.subtract(a, a) == zero
    assert builder.divide(a, one) == a
    assert builder.divide(zero, a) == zero
    negated = builder.multiply(a, minus)
    assert builder.negate(negated) == a
    assert builder.subtract(zero, a) == negated
    assert builder.multiply(negated, b) == builder.negate(builder.multiply(a, b))
    assert builder.multiply(negated, builder.negate(b)) == builder.multiply(b, a)
    assert builder.add(a, builder.negate(b)) == builder.subtract(a, b)
    assert builder.subtract(b, a) == builder.negate(builder.subtract(a, b))
    assert builder.divide(negated, b) == builder.negate(builder.divide(a, b))
    assert builder.divide(b, negated) == builder.negate(builder.divide(b, a))
    assert builder.function(Op.SIN, negated) == builder.negate(builder.function(Op.SIN, a))
    assert builder.function(Op.COS, negated) == builder.function(Op.COS, a)


def test_numbers_fold(builder: Builder) -> None:
    three, four = builder.constant(3.0), builder.constant(4.0)
    assert builder.add(three, four) == builder.constant(7.0)
    assert builder.subtract(three, four) == builder.constant(-1.0)
    assert builder.multiply(three, four) == builder.constant(12.0)
    assert builder.divide(three, four) == builder.constant(0.75)
    assert builder.function(Op.SQRT, four) == builder.constant(2.0)


def test_overflow_while_folding_is_an_error(builder: Builder) -> None:
    large = builder.constant(1e300)
    with pytest.raises(ModelError, match="leaves the range of double precision"):
        builder.multiply(large, large)


def random_program(seed: int, array: Array = X, length: int = 200) -> Program:
    """A program over `array` whose values stay of order one; every kind of instruction but division."""
    rng = random.Random(seed)
    builder = Builder((array,))
    values = [builder.input(array.name, i, f"{array.name}_{i}") for i in range(array.size)]
    values += [builder.constant(v) for v in (0.0, 1.0, -1.0, 0.5)]
    for i in range(length):
        a, b = rng.choice(values), rng.choice(values)
        match rng.choice(["add", "subtract", "multiply", "multiply", "negate", "sin", "cos"]):
            case "add":
                value = builder.multiply(builder.constant(0.5), builder.add(a, b))
            case "subtract":
                value = builder.subtract(a, b)
            case "multiply":
                value = builder.multiply(a, b)
            case "negate":
                value = builder.negate(a)
            case "sin":
                value = builder.function(Op.SIN, a)
            case _:
                value = builder.function(Op.COS, a)
        values.append(builder.name(value, f"v_{i}"))
    return builder.program(outputs(*rng.sample(values, 12)))


@pytest.mark.parametrize("seed", range(30))
def test_passes_keep_values(seed: int) -> None:
    program = check(random_program(seed))
    smaller, stages = passes.run(program)
    state = [0.3, -1.1, 0.7, 2.0]
    assert run(smaller, x=state) == pytest.approx(run(program, x=state), rel=1e-12, abs=1e-12)
    totals = [sum(stage.operations.values()) for stage in stages]
    assert totals[-1] <= totals[0]
    assert [stage.name for stage in stages] == ["lower", "prune", "factor", "prune"]


def test_prune_keeps_only_what_outputs_need(builder: Builder) -> None:
    a, b = builder.input("x", 0), builder.input("x", 1)
    used = builder.multiply(a, b)
    builder.add(used, a)
    program = prune(builder.program(outputs(used)))
    assert [i.op for i in program.instructions] == [Op.INPUT, Op.INPUT, Op.MULTIPLY]


def test_factor_saves_a_multiplication(builder: Builder) -> None:
    a, b, c = (builder.input("x", i) for i in range(3))
    total = builder.subtract(builder.multiply(a, b), builder.multiply(c, a))
    program = builder.program(outputs(total))
    factored = prune(factor(program))
    assert count(program) == {"add": 1, "multiply": 2, "divide": 0, "sqrt": 0, "sincos": 0}
    assert count(factored) == {"add": 1, "multiply": 1, "divide": 0, "sqrt": 0, "sincos": 0}
    assert run(factored, x=[3.0, 5.0, 2.0, 0.0]) == [9.0]


def test_factor_leaves_products_that_others_use(builder: Builder) -> None:
    a, b, c = (builder.input("x", i) for i in range(3))
    product = builder.multiply(a, b)
    program = builder.program(outputs(builder.add(product, builder.multiply(a, c)), product))
    assert count(prune(factor(program))) == count(program)


def test_parameter_only_work_moves_to_prepare() -> None:
    builder = Builder((P, X))
    m, length, g = (builder.input("parameters", i, f"p_{i}") for i in range(3))
    x = builder.input("x", 0, "x_0")
    inertia = builder.name(builder.multiply(m, builder.multiply(length, length)), "I_1")
    weight = builder.negate(builder.multiply(m, g))
    first = builder.multiply(inertia, builder.function(Op.COS, x))
    second = builder.add(builder.multiply(weight, x), builder.constant(2.0))
    arrays = [Output(Array(n, (1,), "", ""), (v,)) for n, v in (("A", first), ("f", second))]
    program = builder.program(arrays)
    module = split(
        program,
        {
            "a": Signature(("x",), ("A",)),
            "f": Signature(("x",), ("f",)),
            "evaluate": Signature(("x",), ("A", "f")),
        },
        "parameters",
    )
    assert module.prepare is not None
    parameters, state = [2.0, 3.0, 9.81], [0.4, 0.0, 0.0, 0.0]
    prepared = evaluate(module.prepare, {"parameters": parameters}, math)["prepared"]
    assert len(prepared) == 2
    for name, function in module.functions.items():
        assert [array.name for array in function.inputs] == ["prepared", "x"]
        whole = evaluate(program, {"parameters": parameters, "x": state}, math)
        part = evaluate(function, {"prepared": prepared, "x": state}, math)
        assert part == {key: whole[key] for key in part}, name
    assert operations(module) == {
        "add": 1, "multiply": 2, "divide": 0, "sqrt": 0, "sincos": 1, "prepare": 3
    }  # fmt: skip


def test_without_parameters_there_is_no_prepare(builder: Builder) -> None:
    program = builder.program(outputs(builder.input("x", 0)))
    assert split(program, {"out": Signature(("x",), ("out",))}, "parameters").prepare is None


BROKEN = {
    "operand not defined": lambda p: replace(p, instructions=(Instruction(Op.NEGATE, (1,)), *p.instructions)),
    "wrong number of operands": lambda p: replace(
        p, instructions=(*p.instructions, Instruction(Op.ADD, (0,)))
    ),
    "is not finite": lambda p: replace(
        p, instructions=(*p.instructions, Instruction(Op.CONSTANT, number=math.nan))
    ),
    "no element 9": lambda p: replace(
        p, instructions=(*p.instructions, Instruction(Op.INPUT, array="x", index=9))
    ),
    "assigned twice": lambda p: replace(p, instructions=p.instructions + p.instructions),
    "wrong size": lambda p: replace(p, outputs=(Output(X, (0,)),), inputs=(P,), instructions=()),
    "undefined value": lambda p: replace(p, outputs=tuple(outputs(7))),
    "not unique": lambda p: replace(p, inputs=(X, X)),
}


@pytest.mark.parametrize("message", BROKEN)
def test_check_finds_broken_programs(message: str, builder: Builder) -> None:
    value = builder.name(builder.function(Op.SIN, builder.input("x", 0)), "s")
    program = check(builder.program(outputs(value)))
    with pytest.raises(InvariantError, match=message):
        check(BROKEN[message](program))
