"""Passes: each takes a program and returns one with the same values and fewer operations.

`run` applies them in order and reports the operations left after each, so that what a pass saves is seen.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from kanegen.program.check import check
from kanegen.program.count import count
from kanegen.program.ir import Program
from kanegen.program.passes.factor import factor
from kanegen.program.passes.prune import prune

Pass = Callable[[Program], Program]

PASSES: tuple[Pass, ...] = (prune, factor, prune)
"""The order in which they run."""


@dataclass(frozen=True)
class Stage:
    """What a program costs after a pass; `name` is the pass, or "lower" for the beginning."""

    name: str
    operations: dict[str, int]


def run(program: Program, passes: Sequence[Pass] = PASSES) -> tuple[Program, tuple[Stage, ...]]:
    """Apply `passes` in order, checking the invariants after each."""
    stages = [Stage("lower", count(program))]
    for apply in passes:
        program = check(apply(program))
        stages.append(Stage(apply.__name__, count(program)))
    return program, tuple(stages)
