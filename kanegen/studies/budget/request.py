"""The request of a user: a budget of error or of time, and the confidence with which it is to be kept.

An error of {ydot} is relative to one of three yardsticks. The terms of {ydot} are the accelerations that
loads, gravity, speeds and {tau} would each cause by themselves; the sum of their norms is the yardstick
"terms". The yardstick "solution" is the norm of {ydot}. The first over the second is the cancellation chi, so
an error relative to the solution is chi times the error relative to the terms. Near an equilibrium chi has no
limit, and neither has the error relative to the solution of any program that rounds. The yardstick "units" is
the unit of every entry of {ydot}: 1 rad/s^2 or 1 m/s^2.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from kanegen.choices import did_you_mean, require_one
from kanegen.errors import OptionError
from kanegen.measure.timing import OBJECTIVES
from kanegen.studies.budget.confidence import alpha_of_attempt, probability, states_needed

SAFETY = 4.0
"""Factor by which the error in the sample for selection must stay below the budget."""

SHARE = 0.001
"""Share of the domain that may exceed a budget of which no tried state may exceed it."""

TERMS, SOLUTION, UNITS_OF_ENTRIES = "terms", "solution", "units"

METRICS = {
    TERMS: "norm of the error of {ydot}, relative to the sum of the norms of the accelerations that loads, "
    "gravity, speeds and {tau} would each cause by themselves, after unit scaling, against certified truth",
    SOLUTION: "norm of the error of {ydot}, relative to the norm of {ydot}, after unit scaling, against "
    "certified truth",
    UNITS_OF_ENTRIES: "largest error of an entry of {ydot}, in rad/s^2 and m/s^2, against certified truth",
}
"""The yardsticks of an error, by name, each with the definition of the error."""

UNITS = {"ns": 1.0, "us": 1e3, "µs": 1e3, "μs": 1e3, "ms": 1e6, "s": 1e9}
"""Units of a budget of time, in ns."""


@dataclass(frozen=True)
class Effort:
    """The effort of a selection.

    Attributes:
        select: Number of states by which a candidate is chosen.
        validate: Number of fresh states by which the chosen candidate is validated; None for
            `Request.least_fresh_states`.
        search: Number of states that each of the two searches for a counterexample tries.
        rounds: Number of rounds in which the candidates take turns to be timed.
        seconds: Duration of the timing of one candidate in one round (s).
    """

    select: int = 512
    validate: int | None = None
    search: int = 512
    rounds: int = 9
    seconds: float = 0.02

    def __post_init__(self) -> None:
        """Check every number.

        Raises:
            OptionError: If a number is too small.
        """
        counts = {"select": self.select, "search": self.search, "rounds": self.rounds}
        if self.validate is not None:
            counts["validate"] = self.validate
        for name, count in counts.items():
            if isinstance(count, bool) or not isinstance(count, int) or count < 1:
                raise OptionError(f"{name} is {count!r}; it must be a whole number, at least 1.")
        if not 0 < self.seconds < math.inf:
            raise OptionError(f"seconds is {self.seconds!r}; it must be a positive number.")


@dataclass(frozen=True)
class Request:
    """A budget and the conditions under which it is kept.

    Attributes:
        error: Budget of the error of {ydot}; None under a budget of time.
        time: Budget of the time of one evaluation (ns); None under a budget of error.
        objective: The time that is measured, one of `OBJECTIVES`.
        relative_to: The yardstick of the error, one of `METRICS`.
        quantile: Share of the domain in which the error must keep the budget. 1.0 means that no tried state
            may exceed it, and that at most a share `SHARE` of the domain exceeds it.
        confidence: Confidence with which this is to be shown.
        attempts: Largest number of candidates that are validated one after the other.
        effort: The effort of the selection.
    """

    error: float | None = None
    time: float | None = None
    objective: str = "latency"
    relative_to: str = TERMS
    quantile: float = 1.0
    confidence: float = 0.95
    attempts: int = 2
    effort: Effort = Effort()

    def __post_init__(self) -> None:
        """Check everything that does not depend on the model.

        Raises:
            OptionError: If a value is out of range, or the values contradict each other.
        """
        if (self.error is None) == (self.time is None):
            raise OptionError("give a budget of error or a budget of time: one of them, not both.")
        for name, value in (("error", self.error), ("budget of time", self.time)):
            if value is not None and not 0 < value < math.inf:
                raise OptionError(f"{name} is {value!r}; it must be a positive number.")
        require_one("objective", self.objective, OBJECTIVES)
        require_one("relative_to", self.relative_to, METRICS)
        if self.quantile != 1.0:
            probability(self.quantile, "quantile")
        probability(self.confidence, "confidence")
        if isinstance(self.attempts, bool) or not isinstance(self.attempts, int) or self.attempts < 1:
            raise OptionError(f"attempts is {self.attempts!r}; it must be a whole number, at least 1.")
        if self.fresh_states < self.least_fresh_states:
            raise OptionError(
                f"validate is {self.fresh_states}, but {self.least_fresh_states} states are needed to show "
                f"that at most {self.share:g} of the domain exceeds a budget, at "
                f"{100 * self.confidence:g} % and in {self.attempts} attempts."
            )

    @property
    def alpha(self) -> float:
        """Probability of a wrong claim that one attempt may have."""
        return alpha_of_attempt(1 - self.confidence, self.attempts)

    @property
    def share(self) -> float:
        """Share of the domain that may exceed the budget."""
        return SHARE if self.is_strict else 1 - self.quantile

    @property
    def is_strict(self) -> bool:
        """Whether no tried state may exceed the budget."""
        return self.quantile == 1.0

    @property
    def least_fresh_states(self) -> int:
        """Smallest number of fresh states that can show that the budget is kept with the confidence."""
        return states_needed(self.share, self.alpha)

    @property
    def fresh_states(self) -> int:
        """Number of fresh states of each attempt."""
        return self.least_fresh_states if self.effort.validate is None else self.effort.validate


def error_budget(text: float | str) -> float:
    """Return the number in the text of the option `--error`.

    Raises:
        OptionError: If the text is no number.
    """
    try:
        return float(text)
    except ValueError:
        raise OptionError(f"error is {text!r}; it must be a positive number such as 1e-9.") from None


def time_budget(text: str) -> float:
    """Return the nanoseconds of a text such as "200ns" or "1.5 us".

    Raises:
        OptionError: If the text has no number, or its unit is missing or unknown.
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
