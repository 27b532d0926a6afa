"""Which variant to take and what it loses, in words, measured from the default.

Times are compared by the ratios of shared rounds, with the confidence interval of `measure.timing`, so that
every statement about speed says how sure it is. An error that grows by no more than `FLAT` loses no digit.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kanegen.errors import counted
from kanegen.measure.timing import CONFIDENCE, OBJECTIVES, Speedup, Times, speedup
from kanegen.options import STRICT
from kanegen.studies.tradeoff.outcome import Study, VariantResult
from kanegen.studies.tradeoff.pareto_front import FLAT
from kanegen.studies.tradeoff.tables import REFORMULATED, TITLES
from kanegen.studies.tradeoff.variants import Candidate

INTERVALS = (
    f"Numbers in parentheses hold the median ratio of the times with {100 * CONFIDENCE:.0f} % confidence."
)
"""The line that says what the intervals of a recommendation are."""

NOISE = 0.1
"""Spread of the rounds of one program, relative to their median, beyond which a machine counts as noisy."""


@dataclass(frozen=True)
class Recommendation:
    """The variants of a study that matter to somebody who has the default variant, for one objective.

    Attributes:
        study: The study.
        objective: The way to call the library, one of `measure.timing.OBJECTIVES`.
    """

    study: Study
    objective: str

    def lines(self) -> list[str]:
        """Return the recommendation, a sentence or more in each line; none where the default is not timed."""
        if self._default is None or not math.isfinite(self._error(self._default)):
            return []
        lines = [self._as_accurate(), self._less_accurate(), self._more_accurate()]
        lines += [*self._useless_precisions(), self._other_coordinates(), self._noise()]
        return [line for line in lines if line]

    @cached_property
    def _timed(self) -> list[VariantResult]:
        """The different programs that are timed and whose error is finite."""
        return [
            result
            for result in self.study.results
            if result.times is not None and result.same_as is None and math.isfinite(self._error(result))
        ]

    @cached_property
    def _comparable(self) -> list[VariantResult]:
        """Those of the programs that take the coordinates and speeds of the model."""
        return [result for result in self._timed if not result.candidate.changes_system]

    @cached_property
    def _default(self) -> VariantResult | None:
        """The program of the default variant; None if the study has none."""
        default = next((one for one in self.study.results if one.candidate == Candidate(STRICT)), None)
        if default is None or default.times is None:
            return None
        return next((one for one in self._timed if one.label == default.same_as), default)

    @cached_property
    def _best(self) -> VariantResult:
        """The fastest program that is as accurate as the default."""
        return self._fastest(one for one in self._comparable if self._digits_lost(one) == 0)

    def _as_accurate(self) -> str:
        """Return which variant is the fastest of those that lose no digit."""
        best = self._best
        if best is self._default:
            return "Keep the default: nothing that is as accurate is faster."
        gain = self._gain(best)
        if not gain.is_real:
            return (
                f"Keep the default: the fastest variant that is as accurate, {best.label}, is "
                f"{_times_as_fast(gain)}, which may be chance."
            )
        return f"Take {best.label}: {_times_as_fast(gain)} as the default, no digit lost."

    def _less_accurate(self) -> str:
        """Return what digits buy: the fastest variant of all against the fastest that loses none."""
        fastest = self._fastest(self._comparable)
        gain = speedup(self._times(self._best), self._times(fastest))
        if fastest is self._best or not gain.is_real:
            return "Nothing is gained by losing digits."
        lost, whole = _in_words(self._digits_lost(fastest)), self._gain(fastest)
        return (
            f"For more speed take {fastest.label}: {_times_as_fast(whole)} as the default, {lost} lost; "
            f"that is {_times_as_fast(gain)} as the fastest that loses none."
        )

    def _more_accurate(self) -> str:
        """Return the least price of at least one digit more."""
        better = [one for one in self._comparable if self._digits(one) <= -1]
        if not better:
            return "No variant is a digit more accurate."
        cheapest = self._fastest(better)
        price = speedup(self._times(cheapest), self._times(self._best))
        gained = _in_words(-self._digits(cheapest))
        return f"{gained} more: {cheapest.label}, {_figure(price)} times the time of {self._best.label}."

    def _useless_precisions(self) -> list[str]:
        """Return a line for each precision that makes no variant faster or more accurate than the best."""
        lines = []
        for precision in dict.fromkeys(one.candidate.variant.precision for one in self._comparable):
            own = [one for one in self._comparable if one.candidate.variant.precision == precision]
            fastest = self._fastest(own)
            if self._best in own or any(self._digits(one) <= -1 for one in own):
                continue
            gain = speedup(self._times(self._best), self._times(fastest))
            if not gain.is_real:
                lost = _in_words(self._digits_lost(fastest))
                lines.append(
                    f"Nothing is gained by {precision}: its fastest variant, {fastest.label}, is "
                    f"{_times_as_fast(gain)} as {self._best.label}, {lost} lost."
                )
        return lines

    def _other_coordinates(self) -> str:
        """Return the fastest variant with other coordinates or speeds, which computes other numbers."""
        others = [one for one in self._timed if one.candidate.changes_system]
        if not others:
            return ""
        fastest = self._fastest(others)
        return (
            f"Apart from these, {REFORMULATED}: {fastest.label} is {_times_as_fast(self._gain(fastest))} "
            f"as the default, {_in_words(self._digits_lost(fastest))} lost."
        )

    def _noise(self) -> str:
        """Return a warning where the rounds of one program differ so much that ratios mean little."""
        if len(self._times(self._best).rounds) < 2:
            return "There was one round of timing, which cannot tell how sure these ratios are."
        spreads = [self._times(one).largest / self._times(one).median - 1 for one in self._timed]
        spread = float(np.median(spreads))
        if spread <= NOISE:
            return ""
        return (
            f"This machine is noisy: the slowest round of a program takes {100 * spread:.0f} % longer than "
            "the median. Repeat the study on a machine that does nothing else, or with more rounds."
        )

    def _error(self, result: VariantResult) -> float:
        """Return the error by which variants are ranked."""
        return result.errors[self.objective].quantile(self.study.share)

    def _times(self, result: VariantResult) -> Times:
        """Return the times of a timed variant."""
        assert result.times is not None
        return result.times[self.objective]

    def _fastest(self, results: Iterable[VariantResult]) -> VariantResult:
        """Return the variant of the least median time, the default where it is as fast."""
        return min(results, key=lambda one: (self._times(one).median, one is not self._default))

    def _gain(self, result: VariantResult) -> Speedup:
        """Return how many times as fast as the default a variant is."""
        assert self._default is not None
        return speedup(self._times(self._default), self._times(result))

    def _digits(self, result: VariantResult) -> float:
        """Return the decimal digits by which a variant is less accurate than the default."""
        assert self._default is not None
        least = np.finfo(np.float64).tiny
        return math.log10(max(self._error(result), least) / max(self._error(self._default), least))

    def _digits_lost(self, result: VariantResult) -> float:
        """Return the digits that a variant loses; 0 where the error grows by no more than `FLAT`."""
        digits = self._digits(result)
        return digits if digits > math.log10(FLAT) else 0.0


def _in_words(digits: float) -> str:
    """Return a number of decimal digits in words."""
    if digits == 0:
        return "no digit"
    return f"{digits:.1f} digits" if digits < 0.95 else counted(round(digits), "digit")


def _times_as_fast(gain: Speedup) -> str:
    """Return a speedup in words, with its interval where there are rounds enough."""
    return f"{_figure(gain)} times as fast"


def _figure(gain: Speedup) -> str:
    """Return the median of a speedup and its confidence interval."""
    if not (gain.low > 0 and math.isfinite(gain.high)):
        return f"{gain.median:.3g}"
    return f"{gain.median:.3g} ({gain.low:.3g} to {gain.high:.3g})"


def recommendations(study: Study, objectives: Sequence[str] = OBJECTIVES) -> list[str]:
    """Return what to take and what it loses, for each objective, a statement in each line."""
    lines: list[str] = []
    for objective in objectives:
        found = Recommendation(study, objective).lines()
        lines += [f"{TITLES[objective].capitalize()}: {line}" for line in found]
    return [*lines, INTERVALS] if lines else []
