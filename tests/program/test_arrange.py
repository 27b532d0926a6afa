"""A long program that is reordered computes the same bits."""

from __future__ import annotations

import math

import numpy as np

from kanegen.compiler import compile_module
from kanegen.lowering.definitions import lower_definitions
from kanegen.program.arrange import arrange
from kanegen.program.check import check
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import Program
from kanegen.program.passes import run
from kanegen.recursion import derive, methods
from kanegen.recursion.outputs import input_arrays, output_array
from tests.support.systems import eight_body

OUTPUTS = ("mass_matrix", "forcing")


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


def test_values_are_used_sooner() -> None:
    program = _program()
    assert _lifetimes(arrange(program)) < 0.7 * _lifetimes(program)


def test_a_short_program_keeps_its_order() -> None:
    module = compile_module(eight_body(loads=False), ("forcing",)).module
    (program,) = module.functions.values()
    assert arrange(program) is program


def _lifetimes(program: Program) -> int:
    """Total number of instructions between the values of [A]'s columns and their last uses."""
    last = {j: i for i, x in enumerate(program.instructions) for j in x.operands}
    return sum(i - j for j, i in last.items() if program.instructions[j].name.startswith(("F_", "M_")))
