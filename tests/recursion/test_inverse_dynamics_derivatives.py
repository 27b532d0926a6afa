"""Derivatives of inverse dynamics by composite bodies: against tangents in many digits, and their cost."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import mpmath
import numpy as np
import pytest

import kanegen as kg
from benchmarks import models
from kanegen.compiler import compile_candidate, compile_module
from kanegen.lowering.accept import accept
from kanegen.lowering.conditioning import condition
from kanegen.options import STRICT
from kanegen.program.count import count
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import PREPARED, Module
from kanegen.recursion.outputs.derivatives import PARTS
from tests.support import prescribed_trees, random_trees
from tests.support.cases import slow_except
from tests.support.systems import eight_body

NAMES = ("inverse_dynamics_derivatives", "forcing_derivatives")


def modules(system: kg.System, name: str) -> tuple[Module, Module]:
    """Return the programs of an output by composite bodies and by tangents alone."""
    request = accept(system, (name,), STRICT)
    (first, *_) = condition(request)
    tangents = {key: way for key, way in first.methods.items() if key not in PARTS}
    assert len(tangents) == len(first.methods) - 2
    found = (first, replace(first, methods=tangents))
    return tuple(compile_candidate(request, one).module for one in found)  # type: ignore[return-value]


def inputs_of(module: Module, system: kg.System, seed: int) -> dict[str, list[Any]]:
    """Return a random number for every element of every input, and the constants that `prepare` fills."""
    arrays = [array for array in next(iter(module.functions.values())).inputs if array.name != PREPARED]
    flat = {
        array.name: [mpmath.mpf(v) for v in np.random.default_rng([seed, i]).uniform(-1, 1, array.size)]
        for i, array in enumerate(arrays)
    }
    if module.prepare is not None:
        numbers = {"parameters": [mpmath.mpf(p.value) for p in system.parameters]}
        flat |= evaluate(module.prepare, numbers, mpmath, mpmath.mpf)
    return flat


def value(module: Module, system: kg.System, seed: int) -> list[Any]:
    """Return the derivatives in a random state, in the digits of mpmath."""
    (program,) = module.functions.values()
    (found,) = evaluate(program, inputs_of(module, system, seed), mpmath, mpmath.mpf).values()
    return list(found)


def agree(system: kg.System, name: str, seed: int) -> None:
    """Check that both programs compute the same derivatives."""
    with mpmath.workdps(50):
        structured, tangents = (value(one, system, seed) for one in modules(system, name))
        size = max(abs(v) for v in tangents)
        assert size > 0
        error = max(abs(a - b) for a, b in zip(structured, tangents, strict=True))
        assert error < 1e-13 * size  # the rounding of constants, which both have as doubles


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("seed", slow_except(range(24), 0, 3))
def test_random_trees_of_all_kinds(seed: int, name: str) -> None:
    """With force elements, loads on bodies and points, motors, rotors, couplings and parameters."""
    agree(random_trees.everything(seed, bodies=3), name, seed)


@pytest.mark.parametrize("kind", ["slides and hinges", "sequences", "welded", "rates"])
@pytest.mark.parametrize("seed", slow_except(range(4), 2))
def test_prescribed_motion(kind: str, seed: int) -> None:
    agree(prescribed_trees.tree(kind, seed), "inverse_dynamics_derivatives", seed)


def test_six_freedoms_a_body() -> None:
    system = eight_body()
    agree(replace(system, bodies=system.bodies[:2]), "inverse_dynamics_derivatives", 1)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("coordinates", ["angles", "quaternion"])
def test_angular_velocities(coordinates: str, name: str) -> None:
    system = eight_body().with_speeds("angular_velocity").with_coordinates(coordinates)
    agree(replace(system, bodies=system.bodies[:3]), name, 1)


OPERATIONS = {
    "ur5": 1245,
    "panda": 3057,
    "go2": 6599,
    "hyq": 8491,
    "eight_body": 19296,
    "chain20": 21577,
    "talos_reduced": 24546,
}
"""Additions, multiplications and divisions of all derivatives by {x} and {y}, by robot."""


@pytest.mark.parametrize("name", slow_except(OPERATIONS, "ur5", "panda"))
def test_operations(name: str) -> None:
    module = compile_module(models.system(name), ("inverse_dynamics_derivatives",)).module
    counts = count(module.functions["inverse_dynamics_derivatives"])
    assert sum(counts[kind] for kind in ("add", "multiply", "divide")) == OPERATIONS[name]
