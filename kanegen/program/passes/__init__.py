"""Passes: each takes a program and returns one with the same outputs and fewer operations.

A pass is one function in a module of its own, named by its verb; `PASSES` lists them in the order in which
they run. `run` applies them and records the operations left after each, which gives the saving of every pass.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from kanegen.choices import several
from kanegen.program.check import check
from kanegen.program.count import count
from kanegen.program.ir import Program
from kanegen.program.passes.factor import factor
from kanegen.program.passes.fold import fold
from kanegen.program.passes.prune import prune

Pass = Callable[[Program], Program]

ON_ALL_OUTPUTS: tuple[Pass, ...] = (fold, prune)
"""Passes that run on the program of all outputs, so that outputs share equal values."""

ON_EACH_FUNCTION: tuple[Pass, ...] = (factor, fold)
"""Passes that run on every function by itself, so that no function costs more because of others.

Factored sums may be equal, so folding comes a second time.
"""

PASSES = (*ON_ALL_OUTPUTS, *ON_EACH_FUNCTION)
"""All passes in the order in which they run."""

PASS_NAMES = tuple(dict.fromkeys(apply.__name__ for apply in PASSES))
"""Names of the passes, each once."""


@dataclass(frozen=True)
class Stage:
    """The cost of a program after a pass.

    Attributes:
        name: Name of the pass, or "lower" before the first.
        operations: Operations by kind, as `count` returns them.
    """

    name: str
    operations: dict[str, int]


def checked_names(without: Iterable[str] | str = ()) -> tuple[str, ...]:
    """Return names of passes, each once, in the order of `PASS_NAMES`.

    Raises:
        OptionError: If there is no pass of such a name.
    """
    return several("without", "pass", without, PASS_NAMES)


def all_but(without: Iterable[str] | str = (), among: Sequence[Pass] = PASSES) -> tuple[Pass, ...]:
    """Return the passes `among` without those that are named.

    Raises:
        OptionError: If there is no pass of such a name.
    """
    left_out = checked_names(without)
    return tuple(apply for apply in among if apply.__name__ not in left_out)


def run(program: Program, passes: Sequence[Pass] = PASSES) -> tuple[Program, tuple[Stage, ...]]:
    """Apply `passes` in order and verify the invariants after each."""
    stages = [Stage("lower", count(program))]
    for apply in passes:
        program = check(apply(program))
        stages.append(Stage(apply.__name__, count(program)))
    return program, tuple(stages)


def savings(stages: Sequence[Stage]) -> dict[str, int]:
    """Return the number of operations that each pass has saved over all its runs, by name of the pass."""
    saved: Counter[str] = Counter()
    for before, after in pairwise(stages):
        saved[after.name] += sum(before.operations.values()) - sum(after.operations.values())
    return dict(saved)
