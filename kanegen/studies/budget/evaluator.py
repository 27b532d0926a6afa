"""The interface between the selection of a variant and the evaluator that measures candidates.

The selection (`budget.selection`) knows neither C nor bodies; it calls an `Evaluator`. Each measurement names
the sample of states to use, so the code of the selection shows the purpose of every sample.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

from kanegen.measure.timing import Times
from kanegen.model.arrays import Floats

SELECT = "select"
"""Purpose of the sample by which a candidate is chosen."""

VALIDATE = "validate"
"""Purpose of the fresh samples by which a chosen candidate is validated."""


class Labelled(Protocol):
    """A candidate: any hashable object with a label."""

    @property
    def label(self) -> str:
        """The choices of the candidate in a few words."""

    def __hash__(self) -> int:
        """Return a hash that agrees with equality."""


C = TypeVar("C", bound=Labelled)


@dataclass(frozen=True)
class SampleSpec:
    """The specification of a random sample.

    Attributes:
        purpose: Purpose of the sample, `SELECT` or `VALIDATE`.
        number: Number of the sample among those of its purpose.
        count: Number of states.
    """

    purpose: str
    number: int
    count: int


@dataclass(frozen=True)
class SearchResult:
    """The outcome of a search for the state with the largest error.

    Attributes:
        error: The largest error that was found; infinite where a result was not finite.
        evaluations: Number of states that were tried.
        state: The state of this error, in the form of `sampling.state_table`.
        explanation: A sentence on why this state is hard and how to exclude it from the domain.
    """

    error: float
    evaluations: int
    state: Mapping[str, object]
    explanation: str


class Evaluator(Protocol[C]):
    """Builds candidates and measures their errors and times."""

    @property
    def candidates(self) -> Sequence[C]:
        """The candidates; the others are compared with the first, the default variant if it is allowed."""

    def least_error(self, candidate: C) -> float:
        """Return a lower limit on the error of a candidate, known without building it; 0 if none is known."""

    def is_costlier(self, candidate: C) -> bool:
        """Return whether a candidate is surely slower than the first one, known without building it."""

    def build(self, candidates: Sequence[C]) -> tuple[Mapping[C, Hashable], Mapping[C, str]]:
        """Build candidates.

        Returns:
            The program of each candidate that can be built, equal for candidates with the same machine code;
            and for each other candidate the reason.
        """

    def errors(self, candidate: C, sample: SampleSpec) -> Floats:
        """Return the (count,) errors in the states of a sample; infinite where a result is not finite."""

    def times(self, candidates: Sequence[C]) -> Mapping[C, Times]:
        """Return the times of candidates, measured in the same rounds."""

    def search(self, candidate: C, sample: SampleSpec, number: int) -> SearchResult:
        """Search for a state with a large error.

        Args:
            candidate: The candidate whose error is searched.
            sample: Sample from whose worst states the search begins.
            number: Number of the search of this candidate; the first one also tries hard states.
        """
