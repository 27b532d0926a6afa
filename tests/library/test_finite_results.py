"""The test of a function for finite results, which reads each value that can be infinite or NaN once."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import kanegen as kg
from kanegen.c import ModelDescription, render, usage
from kanegen.c.c99 import C99
from kanegen.compiler import compile_module
from kanegen.library import load
from kanegen.library.native.status import NOT_FINITE, StatusReport
from kanegen.options import Variant
from kanegen.program.ir import Array, Module, Op, Program
from tests.support import systems
from tests.support.c_compilers import WARNINGS, C, run
from tests.support.cases import slow_except
from tests.support.handmade import Listing
from tests.support.paths import MODELS

QUICK = "-O1 -ffp-contract=off"
N = 24
"""Freedoms of the program made by hand."""

MATRIX = Array("A", (N, N), "SI", "a symmetric matrix with many zeros", of_freedoms=True)
VECTOR = Array("f", (N,), "SI", "a vector, some of whose elements are constant", of_freedoms=True)
BAD = (np.nan, np.inf, -np.inf)


def sparse(rng: np.random.Generator) -> Program:
    """Return a program that doubles coordinates and stores them at random places, or nowhere."""
    k = Listing()
    x = [k.read("x", i) for i in range(N)]
    doubled = [k(Op.ADD, value, value) for value in x]
    zero, one = k.number(0.0), k.number(1.0)
    entries = np.full((N, N), zero)
    for value in (*doubled, one):
        for _ in range(rng.integers(0, 4)):
            row, column = rng.integers(0, N, 2)
            entries[row, column] = entries[column, row] = value
    f = [rng.choice([value, zero, one]) for value in doubled]
    inputs = [Array("x", (N,), "SI", "coordinates")]
    return k.program(inputs, {MATRIX: map(int, entries.ravel()), VECTOR: map(int, f)})


@pytest.mark.parametrize("longest", [7, 1000])
@pytest.mark.parametrize("storage", ["", "float"])
@pytest.mark.parametrize("seed", slow_except((1, 2), 1))
def test_every_value_is_tested(seed: int, storage: str, longest: int) -> None:
    """One number at a time, in functions of one and of several parts, with repeated and constant elements."""
    program = sparse(np.random.default_rng(seed))
    names = tuple(f"q{i}" for i in range(N))
    model = ModelDescription("sparse", names, ("rad",) * N, names, ("rad",) * N, ("body",), (False,))
    target, variant = C99(longest_part=longest), Variant(storage=storage)
    made = render(model, Module(None, {"mass_matrix": program}), {}, variant, target=target)
    assert ("sparse_mass_matrix_4(" in made.files["sparse.c"]) == (longest == 7)
    found: list[StatusReport] = []
    library = load(made, flags=QUICK, on_status=found.append)
    stored = {value for output in program.outputs for value in output.values}
    seen = 0
    for place in range(N):
        for bad in BAD:
            found.clear()
            x = np.ones(N, np.float32 if storage else np.float64)
            x[place] = bad
            library.mass_matrix(x)
            assert [one.kind for one in found] == [NOT_FINITE] * (N + place in stored), (place, bad)
            seen += len(found)
    assert 0 < seen < N * len(BAD)
    found.clear()
    library.mass_matrix(np.ones_like(x))
    assert not found


@pytest.mark.parametrize("name", slow_except(("eight_body", "six_revolute_arm"), "six_revolute_arm"))
def test_every_input_in_turn(name: str) -> None:
    """The status is that of NumPy over all elements of all outputs, whichever input is not finite."""
    found: list[StatusReport] = []
    system = kg.load(MODELS / f"{name}.toml")
    library = kg.build(system, functions="evaluate", flags=QUICK, on_status=found.append)
    rng = np.random.default_rng(3)
    shapes = {"x": (library.n,), "y": (library.n,)}
    if all(body.loads for body in system.bodies):
        shapes |= dict.fromkeys(["force", "torque"], (len(system.bodies), 3))
    states = {argument: rng.uniform(-1.0, 1.0, shape) for argument, shape in shapes.items()}
    statuses = []
    for argument, state in states.items():
        for place in np.ndindex(state.shape):
            changed = state.copy()
            changed[place] = BAD[len(statuses) % len(BAD)]
            found.clear()
            results = library.evaluate(**{**states, argument: changed})
            is_finite = all(np.isfinite(result).all() for result in results)
            assert [one.kind for one in found] == [NOT_FINITE] * (not is_finite), (argument, place)
            statuses.append(is_finite)
    assert not all(statuses)
    found.clear()
    library.evaluate(**states)
    assert not found


def test_most_of_a_sparse_matrix_is_not_read() -> None:
    """The eight bodies' [A] has 460 different values, and less than half of its 2304 elements are read."""
    compiled = compile_module(kg.load(MODELS / "eight_body.toml"), ["mass_matrix"])
    program = compiled.module.functions["mass_matrix"]
    (output,) = program.outputs
    runs = usage.variable_runs((program,), output.array)
    variable = {value for value in output.values if program.instructions[value].op is not Op.CONSTANT}
    read = [place for run in runs for place in range(run.start, run.stop)]
    assert variable <= {output.values[place] for place in read}
    assert len(variable) <= len(read) == len(set(read)) < output.array.size / 2


def test_constant_results_need_no_test(tmp_path: Path) -> None:
    """The [A] of one hinge is a number: no function that tests, and no warning of one that is not used."""
    made = kg.generate(systems.chain(1), functions=["mass_matrix"], artifacts=())
    assert "all_finite" not in made.files["chain.c"]
    assert "    return 0;\n" in made.files["chain.c"]
    made.write(tmp_path)
    for compiler in C.values():
        run(*compiler, "-std=c99", "-O2", *WARNINGS, "-c", "chain.c", folder=tmp_path)
    library = kg.build(systems.chain(1), functions=["mass_matrix"], flags=QUICK, on_status="raise")
    assert library.mass_matrix([np.nan]).shape == (1, 1)
