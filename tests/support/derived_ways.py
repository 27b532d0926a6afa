"""An output by two ways, from parts that recursions give and by tangents alone, compared in many digits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import mpmath
import numpy as np

import kanegen as kg
from kanegen.compiler import compile_candidate
from kanegen.lowering.accept import accept
from kanegen.lowering.conditioning import condition
from kanegen.options import STRICT
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import PREPARED, Module
from kanegen.recursion.outputs.derivatives import PARTS


def modules(system: kg.System, name: str) -> tuple[Module, Module]:
    """Return the programs of an output from parts and by tangents alone; it must have parts."""
    request = accept(system, (name,), STRICT)
    (first, *_) = condition(request)
    without = {key: way for key, way in first.methods.items() if key not in PARTS}
    assert len(without) < len(first.methods)
    ways = (first, replace(first, methods=without))
    return tuple(compile_candidate(request, one).module for one in ways)  # type: ignore[return-value]


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


Ways = Callable[[kg.System, str], tuple[Module, Module]]
"""A function that returns the programs of an output by two ways."""


def agree(system: kg.System, name: str, seed: int, within: float, ways: Ways = modules) -> None:
    """Check that both ways give the same numbers and conditions, in 50 digits.

    Args:
        system: The tree.
        name: Name of the output.
        seed: Seed of the state.
        within: Share of the largest number; the constants of both programs are doubles.
        ways: The two ways.
    """
    with mpmath.workdps(50):
        found, conditions = [], set()
        for module in ways(system, name):
            (program,) = module.functions.values()
            (values,) = evaluate(program, inputs_of(module, system, seed), mpmath, mpmath.mpf).values()
            found.append(list(values))
            conditions.add(len(program.outputs[0].exists_if_positive))
        size = max(abs(v) for v in found[1])
        assert size > 0 and len(conditions) == 1
        assert max(abs(a - b) for a, b in zip(*found, strict=True)) < within * size
