"""The parts of a long program together compute what the whole program does, bit for bit."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
import pytest

from kanegen.compiler import compile_module
from kanegen.program import split
from kanegen.program.cut import cut
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import WORKSPACE, Op, Program
from tests.support.systems import random_system

OUTPUTS = ("mass_matrix", "forcing", "forward_dynamics")


@cache
def _whole(seed: int, bodies: int) -> Program:
    rng = np.random.default_rng(seed)
    compiled = compile_module(random_system(rng, bodies), OUTPUTS)
    return compiled.module.functions["evaluate"]


def _inputs(program: Program, seed: int) -> dict[str, list[float]]:
    rng = np.random.default_rng(seed)
    return {array.name: list(rng.uniform(-1.0, 1.0, array.size)) for array in program.inputs}


def _run(parts: tuple[Program, ...], inputs: dict[str, list[float]], whole: Program) -> dict[str, list[Any]]:
    filled: dict[str, list[Any]] = {o.array.name: [None] * o.array.size for o in whole.outputs}
    sizes = [o.array.size for part in parts for o in part.outputs if o.array.name == WORKSPACE]
    filled[WORKSPACE] = [None] * max(sizes, default=0)
    for part in parts:
        values = evaluate(part, {**inputs, WORKSPACE: list(filled[WORKSPACE])}, math)
        for output in part.outputs:
            name = output.array.name
            for (place, _), value in zip(output.elements(), values[name], strict=True):
                filled[name][place] = value
    del filled[WORKSPACE]
    return filled


@pytest.mark.parametrize("longest", [7, 100, 1000])
@pytest.mark.parametrize("seed", range(3))
def test_parts_compute_the_same_bits(seed: int, longest: int) -> None:
    whole = _whole(seed, 5)
    parts = cut(whole, longest)
    assert len(parts) > 1
    inputs = _inputs(whole, seed)
    assert _run(parts, inputs, whole) == evaluate(whole, inputs, math)


def test_every_element_is_filled_once() -> None:
    whole = _whole(0, 5)
    filled = [
        (output.array.name, place)
        for part in cut(whole, 200)
        for output in part.outputs
        if output.array.name != WORKSPACE
        for place, _ in output.elements()
    ]
    assert len(filled) == len(set(filled)) == sum(output.array.size for output in whole.outputs)


def test_no_part_is_longer_than_allowed() -> None:
    whole = _whole(1, 6)
    for part in cut(whole, 300):
        computed = [i for i in part.instructions if i.op not in (Op.INPUT, Op.CONSTANT)]
        assert 0 < len(computed) <= 300


def test_parts_end_with_a_group_of_quantities(monkeypatch) -> None:
    monkeypatch.setattr(split, "arrange", lambda program: program)
    whole = _whole(4, 6)
    first, *_ = cut(whole, 400)
    second = cut(whole, 400)[1]
    computed = [i for i in second.instructions if i.op not in (Op.INPUT, Op.CONSTANT)]
    assert next(i.note for i in computed if i.note) not in {i.note for i in first.instructions}


def test_slots_of_the_workspace_are_used_again() -> None:
    whole = _whole(3, 8)
    parts = cut(whole, 200)
    written = [k for p in parts for o in p.outputs if o.array.name == WORKSPACE for k, _ in o.elements()]
    assert len(set(written)) < len(written)


def test_no_part_overwrites_what_it_reads() -> None:
    for part in cut(_whole(4, 8), 200):
        read = {i.index for i in part.instructions if i.array == WORKSPACE}
        written = {k for o in part.outputs if o.array.name == WORKSPACE for k, _ in o.elements()}
        assert not read & written


def test_the_last_part_holds_the_conditions() -> None:
    whole = _whole(5, 5)
    *earlier, last = cut(whole, 200)
    assert all(not output.exists_if_positive for part in earlier for output in part.outputs)
    (pivots,) = [output.exists_if_positive for output in whole.outputs if output.exists_if_positive]
    (conditions,) = [output.exists_if_positive for output in last.outputs if output.exists_if_positive]
    assert len(conditions) == len(pivots)


def test_a_short_program_stays_whole() -> None:
    whole = _whole(6, 1)
    assert cut(whole) == (whole,)
