"""A long program that is reordered computes the same bits."""

from __future__ import annotations

import math
from functools import cache, reduce

import numpy as np
import pytest

from kanegen.compiler import compile_module
from kanegen.lowering.definitions import lower_definitions
from kanegen.program import split
from kanegen.program.arrange import GAIN, SEEN, arrange
from kanegen.program.builder import Builder
from kanegen.program.check import check
from kanegen.program.cut import cut
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import Array, Output, Program
from kanegen.program.machine import instructions
from kanegen.program.orders import by_rows, depth_first, longest_chain_first
from kanegen.program.passes import run
from kanegen.recursion import derive, methods
from kanegen.recursion.outputs import input_arrays, output_array
from tests.support.systems import chain, eight_body

OUTPUTS = ("mass_matrix", "forcing")


@cache
def _program() -> Program:
    """[A] and {f} of the eight-body tree as the derivation orders them."""
    system = eight_body(loads=False)
    way = methods(system, OUTPUTS)[0]
    form = derive(system, way)
    arrays = {output_array(system, name, form.methods): form.outputs[name] for name in way}
    program, _ = run(lower_definitions(input_arrays(system), form.definitions, arrays))
    return program


def test_the_same_instructions_give_the_same_bits() -> None:
    program = _program()
    arranged = check(arrange(program))
    assert arranged != program
    rng = np.random.default_rng(0)
    inputs = {array.name: list(rng.uniform(-1.0, 1.0, array.size)) for array in program.inputs}
    assert evaluate(arranged, inputs, math) == evaluate(program, inputs, math)
    ops = [sorted(i.op for i in p.instructions) for p in (program, arranged)]
    assert ops[0] == ops[1]


@pytest.mark.parametrize("order", [by_rows, depth_first, longest_chain_first])
def test_every_order_has_the_same_values_and_operations(order) -> None:
    program = _program()
    other = check(order(program))
    rng = np.random.default_rng(1)
    inputs = {array.name: list(rng.uniform(-1.0, 1.0, array.size)) for array in program.inputs}
    assert evaluate(other, inputs, math) == evaluate(program, inputs, math)
    assert len(other.instructions) <= len(program.instructions)


def test_values_are_used_sooner() -> None:
    program = _program()
    assert _lifetimes(arrange(program)) < 0.7 * _lifetimes(program)
    assert instructions(cut(arrange(program))) <= GAIN * instructions(cut(program))


def test_an_order_that_gains_little_is_not_taken() -> None:
    found = arrange(_program())
    assert arrange(found) is found


def test_programs_that_wait_for_divisions_follow_the_longest_chain(monkeypatch) -> None:
    monkeypatch.setattr(split, "arrange", lambda program: program)
    (program,) = compile_module(chain(3), ("forward_dynamics",)).module.functions.values()
    assert len(program.instructions) > SEEN
    assert len(cut(program)) == 1
    assert arrange(program) == longest_chain_first(program) != program


def test_instructions_of_a_program_that_needs_more_registers_than_there_are() -> None:
    """20 products are computed before they are added: 5 of them are stored, and read from memory."""
    builder = Builder((Array("x", (20,), "1", "factors"),))
    x = [builder.input("x", k) for k in range(20)]
    products = [builder.multiply(one, x[0]) for one in x]
    total = reduce(builder.add, products)
    program = builder.program([Output(Array("sum", (), "1", "sum"), (total,))])
    assert instructions((program,)) == 20 + 19 + 5 + 5 + 1
    assert instructions((depth_first(program),)) == 20 + 19 + 1


def test_a_short_program_keeps_its_order() -> None:
    module = compile_module(chain(1), ("forcing",)).module
    (program,) = module.functions.values()
    assert len(program.instructions) <= SEEN
    assert arrange(program) is program


def _lifetimes(program: Program) -> int:
    """Total number of instructions between the values of [A]'s columns and their last uses."""
    last = {j: i for i, x in enumerate(program.instructions) for j in x.operands}
    return sum(i - j for j, i in last.items() if program.instructions[j].name.startswith(("F_", "M_")))
