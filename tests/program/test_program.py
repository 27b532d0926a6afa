"""The builder and the split into functions keep values, and `check` finds broken programs."""

from __future__ import annotations

import math
import subprocess
import sys
from dataclasses import replace

import pytest

from kanegen.program.builder import Builder
from kanegen.program.check import InvariantError, check
from kanegen.program.count import operations
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import Array, Instruction, Op, Output, Program
from kanegen.program.split import Signature, hoist, restrict

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
    alone = restrict(
        program,
        {
            "a": Signature(("x",), ("A",)),
            "f": Signature(("x",), ("f",)),
            "evaluate": Signature(("x",), ("A", "f")),
        },
    )
    module = hoist(alone)
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
    assert hoist(restrict(program, {"out": Signature(("x",), ("out",))})).prepare is None


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


def test_programs_know_nothing_of_sympy() -> None:
    modules = (
        "arrange, constants, count, cut, elimination, evaluate, passes, precision, semantics, split, tangent"
    )
    code = f"import sys; from kanegen.program import {modules}; assert 'sympy' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)
