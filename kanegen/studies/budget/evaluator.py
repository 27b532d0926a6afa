"""What a search needs to know about candidates, from whoever can measure them.

The protocol of the search is in `selection`; it knows neither C nor bodies. Who measures is told which sample
to draw, so that it is plain which states were used for what.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

from kanegen.measure.timing import Times
from kanegen.model.arrays import Floats

SELECT = "select"
VALIDATE = "validate"


class Named(Protocol):
    """A candidate: anything that is hashable and has a label."""

    @property
    def label(self) -> str:
        """Its choices in a few words."""

    def __hash__(self) -> int:
        """As equality has it."""


C = TypeVar("C", bound=Named)


@dataclass(frozen=True)
class Draw:
    """A sample: what it is for, which one of its kind it is, and how many states it has."""

    purpose: str
    number: int
    count: int


@dataclass(frozen=True)
class Attack:
    """A search for a state with a large error.

    Attributes:
        error: The largest that was found; infinite where a result was not finite.
        evaluations: How many states were tried.
        where: The worst of them, in the words of a certificate.
        cause: What to exclude from the domain to be rid of it, a sentence.
    """

    error: float
    evaluations: int
    where: Mapping[str, object]
    cause: str


class Laboratory(Protocol[C]):
    """Builds candidates, draws states and measures."""

    @property
    def field(self) -> Sequence[C]:
        """The candidates; the others are compared with the first one, the default if it may be chosen."""

    def floor(self, candidate: C) -> float:
        """An error that it cannot stay below, known without building it; 0 where nothing is known."""

    def is_costlier(self, candidate: C) -> bool:
        """Whether it can only be slower than the first one, known without building it."""

    def build(self, candidates: Sequence[C]) -> tuple[Mapping[C, Hashable], Mapping[C, str]]:
        """What each is as a program, equal where they are the same one; and why the others cannot be had."""

    def errors(self, candidate: C, draw: Draw) -> Floats:
        """(count,) errors in the states of a sample; infinite where a result is not finite."""

    def times(self, candidates: Sequence[C]) -> Mapping[C, Times]:
        """Times of all in the same rounds."""

    def attack(self, candidate: C, draw: Draw, number: int) -> Attack:
        """Search for a large error, from the worst states of a sample and from singular ones.

        Args:
            candidate: Whose.
            draw: A sample that has been drawn for it.
            number: Of the search.
        """
