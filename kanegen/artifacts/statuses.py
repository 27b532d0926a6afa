"""Meanings of the statuses of generated functions, as texts for facades in other languages."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from kanegen.c.source import Source


@dataclass(frozen=True)
class Requirement:
    """What must be positive for the results of a function to exist.

    Attributes:
        function: Name of the function.
        first: First row that is meant, from 0; None for freedoms.
        quantity: Name of the quantity.
        failure: Clause on the state where it is not positive.
        loss: Clause on the state where most digits are lost.
    """

    function: str
    first: int | None
    quantity: str
    failure: str
    loss: str


def requirements(source: Source) -> Iterator[Requirement]:
    """Yield what must be positive for each function; of several about rows those with later rows first."""
    named = [(one.name, one) for one in source.functions]
    named += [(one.name, one.step) for one in source.rollouts]
    for name, function in named:
        for one in sorted(function.row_conditions, key=lambda one: -one.first):
            loss = f"{one.loss}; a higher precision helps"
            yield Requirement(name, one.first, one.quantity, one.failure, loss)
        if function.may_fail:
            remedy = next((condition.remedy for condition in function.conditions), "")
            yield Requirement(name, None, function.quantity, function.failure, remedy)
