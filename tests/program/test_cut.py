"""Pieces of a long program together compute what the whole does, bit for bit."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from kanegen.compiler import compile_module
from kanegen.program.cut import cut
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import WORKSPACE, Op, Program
from tests.support.systems import random_system

OUTPUTS = ("mass_matrix", "forcing", "forward_dynamics")


def _whole(seed: int, bodies: int) -> Program:
    rng = np.random.default_rng(seed)
    compiled = compile_module(random_system(rng, bodies), OUTPUTS)
    return compiled.module.functions["evaluate"]


def _inputs(program: Program, seed: int) -> dict[str, list[float]]:
    rng = np.random.default_rng(seed)
    return {array.name: list(rng.uniform(-1.0, 1.0, array.size)) for array in program.inputs}


def _run(pieces: tuple[Program, ...], inputs: dict[str, list[float]], whole: Program) -> dict[str, list[Any]]:
    filled: dict[str, list[Any]] = {o.array.name: [None] * o.array.size for o in whole.outputs}
    sizes = [o.array.size for piece in pieces for o in piece.outputs if o.array.name == WORKSPACE]
    filled[WORKSPACE] = [None] * max(sizes, default=0)
    for piece in pieces:
        values = evaluate(piece, {**inputs, WORKSPACE: list(filled[WORKSPACE])}, math)
        for output in piece.outputs:
            name = output.array.name
            for (place, _), value in zip(output.elements(), values[name], strict=True):
                filled[name][place] = value
    del filled[WORKSPACE]
    return filled


@pytest.mark.parametrize("longest", [7, 100, 1000])
@pytest.mark.parametrize("seed", range(3))
def test_pieces_compute_the_same_bits(seed: int, longest: int) -> None:
    whole = _whole(seed, 5)
    pieces = cut(whole, longest)
    assert len(pieces) > 1
    inputs = _inputs(whole, seed)
    assert _run(pieces, inputs, whole) == evaluate(whole, inputs, math)


def test_every_element_is_filled_once() -> None:
    whole = _whole(0, 5)
    filled = [
        (output.array.name, place)
        for piece in cut(whole, 200)
        for output in piece.outputs
        if output.array.name != WORKSPACE
        for place, _ in output.elements()
    ]
    assert len(filled) == len(set(filled)) == sum(output.array.size for output in whole.outputs)


def test_pieces_keep_to_their_length() -> None:
    whole = _whole(1, 6)
    for piece in cut(whole, 300):
        computed = [i for i in piece.instructions if i.op not in (Op.INPUT, Op.CONSTANT)]
        assert 0 < len(computed) <= 300


def test_pieces_end_with_a_group() -> None:
    whole = _whole(2, 6)
    first, *_ = cut(whole, 400)
    second = cut(whole, 400)[1]
    computed = [i for i in second.instructions if i.op not in (Op.INPUT, Op.CONSTANT)]
    assert next(i.note for i in computed if i.note) not in {i.note for i in first.instructions}


def test_a_place_in_the_workspace_is_used_again() -> None:
    whole = _whole(3, 8)
    pieces = cut(whole, 200)
    written = [k for p in pieces for o in p.outputs if o.array.name == WORKSPACE for k, _ in o.elements()]
    assert len(set(written)) < len(written)


def test_no_piece_overwrites_what_it_reads() -> None:
    for piece in cut(_whole(4, 8), 200):
        read = {i.index for i in piece.instructions if i.array == WORKSPACE}
        written = {k for o in piece.outputs if o.array.name == WORKSPACE for k, _ in o.elements()}
        assert not read & written


def test_the_last_piece_names_what_must_be_positive() -> None:
    whole = _whole(5, 5)
    *earlier, last = cut(whole, 200)
    assert all(not output.exists_if_positive for piece in earlier for output in piece.outputs)
    (pivots,) = [output.exists_if_positive for output in whole.outputs if output.exists_if_positive]
    (named,) = [output.exists_if_positive for output in last.outputs if output.exists_if_positive]
    assert len(named) == len(pivots)


def test_a_short_program_stays_whole() -> None:
    whole = _whole(6, 1)
    assert cut(whole) == (whole,)
