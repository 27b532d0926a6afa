"""Workers that share a program compute what the whole does, bit for bit, in any order between barriers."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from kanegen.compiler import compile_module
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import WORKSPACE, Op, Program
from kanegen.program.share import Shared, most_live, share
from tests.support.handmade import F, Listing, X
from tests.support.systems import random_system

OUTPUTS = ("mass_matrix", "forcing", "forward_dynamics")


@cache
def _whole(seed: int) -> Program:
    system = random_system(np.random.default_rng(seed), 4)
    return compile_module(system, OUTPUTS).module.functions["evaluate"]


@cache
def _shared(seed: int, workers: int) -> Shared:
    return share(_whole(seed), workers)


def _results(found: Shared, inputs: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Evaluate all programs as often as values can pass from worker to worker."""
    workspace = np.zeros(found.workspace)
    filled: dict[str, np.ndarray] = {}
    for _ in range(len(found.programs) * len(found.barriers[0])):
        for program in found.programs:
            with np.errstate(all="ignore"):
                values = evaluate(program, {**inputs, WORKSPACE: workspace}, np)
            for output in program.outputs:
                name, places = output.array.name, [place for place, _ in output.elements()]
                array = filled.setdefault(name, np.zeros(output.array.size))
                array[places] = values[name]
        workspace = filled.get(WORKSPACE, workspace).copy()
    return filled


CASES = [(seed, workers) for seed in range(2) for workers in (2, 3)]


@pytest.mark.parametrize(("seed", "workers"), CASES)
def test_workers_compute_the_same_bits(seed: int, workers: int) -> None:
    whole, found = _whole(seed), _shared(seed, workers)
    rng = np.random.default_rng(seed)
    inputs = {array.name: rng.uniform(-1.0, 1.0, array.size) for array in whole.inputs}
    results = _results(found, inputs)
    for name, values in evaluate(whole, inputs, np).items():
        assert (results[name] == np.array(values)).all()


@pytest.mark.parametrize(("seed", "workers"), CASES)
def test_a_barrier_separates_every_value_from_its_readers(seed: int, workers: int) -> None:
    found = _shared(seed, workers)
    assert len({len(places) for places in found.barriers}) == 1
    written: dict[int, int] = {}
    for program, barriers in zip(found.programs, found.barriers, strict=True):
        assert list(barriers) == sorted(barriers)
        for output in program.outputs:
            if output.array.name == WORKSPACE:
                for slot, value in output.elements():
                    assert slot not in written
                    written[slot] = _phase(value, barriers)
    for program, barriers in zip(found.programs, found.barriers, strict=True):
        for place, instruction in enumerate(program.instructions):
            if instruction.array == WORKSPACE:
                assert written[instruction.index] < _phase(place, barriers)


def _phase(place: int, barriers: tuple[int, ...]) -> int:
    """Return how many barriers stand before an instruction."""
    return sum(barrier <= place for barrier in barriers)


@pytest.mark.parametrize(("seed", "workers"), CASES)
def test_every_element_is_filled_once_and_the_last_worker_tests(seed: int, workers: int) -> None:
    whole, found = _whole(seed), _shared(seed, workers)
    filled = sorted(
        (output.array.name, place)
        for program in found.programs
        for output in program.outputs
        for place, _ in output.elements()
        if output.array.name != WORKSPACE
    )
    assert filled == sorted((o.array.name, place) for o in whole.outputs for place, _ in o.elements())
    tests = [sum(len(o.exists_if_positive) for o in program.outputs) for program in found.programs]
    assert tests == [0] * (workers - 1) + [sum(len(o.exists_if_positive) for o in whole.outputs)]


def test_limbs_are_shared() -> None:
    """Two chains that meet at the end: two workers need half the time and one value."""
    code = Listing()
    ends = []
    for limb in range(2):
        value = code.read("x", limb)
        for k in range(400):
            value = code(Op.ADD, value, value, note=f"limb {limb}" if k == 0 else "")
        ends.append(value)
    total = code(Op.ADD, *ends, note="the end")
    found = share(code.program([X], {F: [total, ends[0]]}), 2)
    assert found.workspace == 1
    assert (found.work, found.time) == (801, 400 + 60 + 1 + 2 * 60)
    assert [len(places) for places in found.barriers] == [2, 2]


def test_live_values_are_counted() -> None:
    """At the second sum the first sum and both inputs are live, and then what the last sum needs."""
    code = Listing()
    x = [code.read("x", 0), code.read("x", 1)]
    first = code(Op.ADD, *x)
    second = code(Op.MULTIPLY, *x)
    last = code(Op.ADD, first, second)
    assert most_live(code.program([X], {F: [last, last]})) == 4
