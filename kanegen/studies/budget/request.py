"""What is asked for: a budget of error or of time, and how surely it is to be kept."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from kanegen.choices import did_you_mean, require_one
from kanegen.errors import OptionError
from kanegen.measure.timing import OBJECTIVES
from kanegen.studies.budget.confidence import corrected, draws_needed, probability

SAFETY = 4.0
"""The error on the sample by which a candidate is chosen must stay below the budget by this factor."""

SHARE = 0.001
"""Of the domain that may exceed the budget unseen, where no state that is tried may."""

UNITS = {"ns": 1.0, "us": 1e3, "µs": 1e3, "μs": 1e3, "ms": 1e6, "s": 1e9}
"""Of a budget of time, in ns."""


@dataclass(frozen=True)
class Effort:
    """How much is spent on a search.

    Attributes:
        select: States by which candidates are chosen.
        validate: Fresh states by which the chosen one is judged; by default as many as the request needs when
            none exceeds the budget.
        attack: Evaluations of each of the two searches for a counterexample.
        rounds: In which the candidates take turns to be timed.
        seconds: Of each of them in every round.
    """

    select: int = 512
    validate: int | None = None
    attack: int = 512
    rounds: int = 9
    seconds: float = 0.02

    def __post_init__(self) -> None:
        """Check every number.

        Raises:
            OptionError: If one is too small.
        """
        counts = {"select": self.select, "attack": self.attack, "rounds": self.rounds}
        if self.validate is not None:
            counts["validate"] = self.validate
        for name, count in counts.items():
            if isinstance(count, bool) or not isinstance(count, int) or count < 1:
                raise OptionError(f"{name} is {count!r}; it must be a whole number, at least 1.")
        if not 0 < self.seconds < math.inf:
            raise OptionError(f"seconds is {self.seconds!r}; it must be a positive number.")


@dataclass(frozen=True)
class Request:
    """A budget and its terms.

    Attributes:
        error: Budget of the normwise error; None where time has the budget.
        time: Budget of an evaluation (ns); None where the error has it.
        objective: What is timed, one of `OBJECTIVES`.
        quantile: Share of the domain that is to keep the error; 1.0 means that no state that is tried may
            exceed it, and that at most `SHARE` of the domain would.
        confidence: With which this is to be shown.
        attempts: How many candidates may be validated at most, one after the other.
        effort: What is spent on it.
    """

    error: float | None = None
    time: float | None = None
    objective: str = "latency"
    quantile: float = 1.0
    confidence: float = 0.95
    attempts: int = 2
    effort: Effort = Effort()

    def __post_init__(self) -> None:
        """Check everything that can be wrong without a model.

        Raises:
            OptionError: If something is.
        """
        if (self.error is None) == (self.time is None):
            raise OptionError("give a budget of error or a budget of time: one of them, not both.")
        for name, value in (("error", self.error), ("budget of time", self.time)):
            if value is not None and not 0 < value < math.inf:
                raise OptionError(f"{name} is {value!r}; it must be a positive number.")
        require_one("objective", self.objective, OBJECTIVES)
        if self.quantile != 1.0:
            probability(self.quantile, "quantile")
        probability(self.confidence, "confidence")
        if isinstance(self.attempts, bool) or not isinstance(self.attempts, int) or self.attempts < 1:
            raise OptionError(f"attempts is {self.attempts!r}; it must be a whole number, at least 1.")
        if self.draws < self.needed:
            raise OptionError(
                f"validate is {self.draws}, but {self.needed} states are needed to show that at most "
                f"{self.share:g} of the domain exceeds a budget, at {100 * self.confidence:g} % and in "
                f"{self.attempts} attempts."
            )

    @property
    def alpha(self) -> float:
        """Of one attempt."""
        return corrected(1 - self.confidence, self.attempts)

    @property
    def share(self) -> float:
        """Of the domain that may exceed the budget."""
        return SHARE if self.is_strict else 1 - self.quantile

    @property
    def is_strict(self) -> bool:
        """Whether a single state that exceeds the budget is too much."""
        return self.quantile == 1.0

    @property
    def needed(self) -> int:
        """Fresh states of an attempt at least."""
        return draws_needed(self.share, self.alpha)

    @property
    def draws(self) -> int:
        """Fresh states of an attempt."""
        return self.needed if self.effort.validate is None else self.effort.validate


def error_budget(text: float | str) -> float:
    """The number in an option `--error`.

    Raises:
        OptionError: If it is no number.
    """
    try:
        return float(text)
    except ValueError:
        raise OptionError(f"error is {text!r}; it must be a positive number such as 1e-9.") from None


def time_budget(text: str) -> float:
    """Nanoseconds from words such as "200ns" or "1.5 us".

    Raises:
        OptionError: If there is no number, or the unit is missing or unknown.
    """
    match = re.fullmatch(r"\s*([-+]?[\d.]+(?:e[-+]?\d+)?|nan|[-+]?inf)\s*([^\d\s.]*)\s*", text, re.IGNORECASE)
    if match is None:
        raise OptionError(f"budget is {text!r}; write a time such as 200ns or 1.5us.")
    number, unit = match.groups()
    if unit not in UNITS:
        known = did_you_mean(unit, UNITS) if unit else "Write a time such as 200ns or 1.5us."
        raise OptionError(f"budget is {text!r}: {f'unknown unit {unit!r}' if unit else 'no unit'}. {known}")
    try:
        return float(number) * UNITS[unit]
    except ValueError:
        raise OptionError(f"budget is {text!r}: {number!r} is not a number.") from None
