"""A row of the table of calls, and how rows are measured."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from kanegen.measure.timing import Times

ROUNDS = 15
"""Rounds of a measurement; in each one the C alone and the program have a turn."""

SECONDS = 0.02
"""Length of a turn (s)."""


@dataclass(frozen=True)
class Row:
    """A call of one function of one model, through another program and without it.

    Attributes:
        target: Name of the program, as users write it: "CasADi".
        call: What is called, in a few words: "external, forward_dynamics of panda_arm".
        alone: Nanoseconds of a call of the C function from C, in every round.
        through: Nanoseconds of a call through the program, in the same rounds.
        versions: Versions on which the times depend: "casadi 3.8.2".
    """

    target: str
    call: str
    alone: Times
    through: Times
    versions: str

    @property
    def beyond(self) -> float:
        """Median over the rounds of what a call takes beyond the C (ns)."""
        rounds = zip(self.through.rounds, self.alone.rounds, strict=True)
        return Times(tuple(through - alone for through, alone in rounds)).median


def in_turns(
    alone: Callable[[], float], through: Callable[[], float], rounds: int = ROUNDS
) -> tuple[Times, Times]:
    """Measure two calls in turns.

    Args:
        alone: Runs one turn of the C alone and returns nanoseconds of a call.
        through: Runs one turn of the calls through a program and returns nanoseconds of a call.
        rounds: Number of rounds; a round before them does not count.

    Example:
        Row("CasADi", "external, forward_dynamics of panda_arm", *in_turns(in_c, through), "casadi 3.8.2")
    """
    found = [(alone(), through()) for _ in range(rounds + 1)][1:]
    first, second = zip(*found, strict=True)
    return Times(first), Times(second)


def turn_of(call: Callable[[], object], seconds: float = SECONDS) -> float:
    """Repeat a call of Python for some time and return nanoseconds of one, with those of the loop itself.

    Example:
        turn_of(lambda: function(x, y, tau))
    """
    count = 1
    while True:
        start = time.perf_counter_ns()
        for _ in range(count):
            call()
        taken = time.perf_counter_ns() - start
        if taken >= 1e9 * seconds:
            return taken / count
        count *= 2
