"""Passes: each takes a program and returns one with the same values and fewer operations.

`run` applies them in order and reports the operations left after each, so that what a pass saves is seen.
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

SHARED: tuple[Pass, ...] = (fold, prune)
"""Those that run on all outputs together, so that these share what is equal."""

OWN: tuple[Pass, ...] = (factor, fold)
"""Those that run on every function by itself, so that none costs more because of another.

Sums that have been factored may be equal, so folding comes twice.
"""

PASSES = (*SHARED, *OWN)
"""The order in which they run."""

NAMES = tuple(dict.fromkeys(apply.__name__ for apply in PASSES))


@dataclass(frozen=True)
class Stage:
    """What a program costs after a pass; `name` is the pass, or "lower" for the beginning."""

    name: str
    operations: dict[str, int]


def names(without: Iterable[str] | str = ()) -> tuple[str, ...]:
    """Names of passes checked, each once, in the order of `NAMES`.

    Raises:
        OptionError: If there is no pass of such a name.
    """
    return several("without", "pass", without, NAMES)


def all_but(without: Iterable[str] | str = (), among: Sequence[Pass] = PASSES) -> tuple[Pass, ...]:
    """The passes `among` these less those of some names.

    Raises:
        OptionError: If there is no pass of such a name.
    """
    left_out = names(without)
    return tuple(apply for apply in among if apply.__name__ not in left_out)


def run(program: Program, passes: Sequence[Pass] = PASSES) -> tuple[Program, tuple[Stage, ...]]:
    """Apply `passes` in order, checking the invariants after each."""
    stages = [Stage("lower", count(program))]
    for apply in passes:
        program = check(apply(program))
        stages.append(Stage(apply.__name__, count(program)))
    return program, tuple(stages)


def savings(stages: Sequence[Stage]) -> dict[str, int]:
    """By pass how many operations it has taken out, in all its turns."""
    saved: Counter[str] = Counter()
    for before, after in pairwise(stages):
        saved[after.name] += sum(before.operations.values()) - sum(after.operations.values())
    return dict(saved)
