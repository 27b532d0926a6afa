"""The laboratory in which the variants of a model are built, judged by certified truth, and timed."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from kanegen.c.formats import formats
from kanegen.compiler import Progress, quiet
from kanegen.errors import OptionError
from kanegen.library import Library
from kanegen.library.native import compilers
from kanegen.measure.timing import Rounds, Times
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.options import STRICT
from kanegen.studies.bench.states import plain
from kanegen.studies.budget.counterexample import attacked
from kanegen.studies.budget.evaluator import Attack, Draw
from kanegen.studies.budget.region import Region
from kanegen.studies.budget.request import Request
from kanegen.studies.budget.sampling import drawn, sample_from_table, stream
from kanegen.studies.tradeoff.compilation import CompiledVariant, compile_variants
from kanegen.studies.tradeoff.domain import Domain
from kanegen.studies.tradeoff.judge import Judge
from kanegen.studies.tradeoff.samples import Sample
from kanegen.studies.tradeoff.times import timed
from kanegen.studies.tradeoff.variants import Candidate, candidates

TIMED_STATES = 256
"""Independent states that are computed in turn while the clock runs."""

ROUNDED_RESULT = 8.0
"""A rounded result errs by a roundoff over this in at least one of the states of a sample."""


def field_of(
    keep: Callable[[Candidate], bool] = lambda candidate: True, among: Iterable[Candidate] | None = None
) -> tuple[Candidate, ...]:
    """The default variant and those of the study, with the speeds of the model, as far as they are kept.

    Args:
        keep: Which may be chosen.
        among: Instead of those of the study.

    Raises:
        OptionError: If none is left.
    """
    known = candidates()[0] if among is None else among
    own = [Candidate(STRICT), *(candidate for candidate in known if not candidate.changes_system)]
    kept = tuple(candidate for candidate in dict.fromkeys(own) if keep(candidate))
    if not kept:
        raise OptionError("no variant is left to choose from: ask for less, such as another precision.")
    return kept


def is_reproducible(candidate: Candidate) -> bool:
    """Whether it has the same bits from every compiler and on every machine."""
    variant = candidate.variant
    return variant.semantics == STRICT.semantics and variant.machine == STRICT.machine


class Workbench:
    """A `Laboratory` of `Candidate` for the forward dynamics of one system.

    Args:
        region: The states that count.
        request: What is asked for.
        field: Who may be chosen; the others are compared with the first.
        seed: Of all samples.
        progress: Told the name of each stage.

    Raises:
        BuildError: If there is no C compiler.
    """

    def __init__(
        self,
        region: Region,
        request: Request,
        field: Sequence[Candidate],
        seed: int = 0,
        progress: Progress = quiet,
    ) -> None:
        compilers.find()
        self.region = region
        self.field = field
        self.judge = Judge(region.system)
        self._request = request
        self._seed = seed
        self._progress = progress
        self._samples: dict[Draw, Sample] = {}
        self._built: dict[Candidate, CompiledVariant] = {}
        self._refutations: list[Attack] = []

    def floor(self, candidate: Candidate) -> float:
        """What the rounding of the result alone brings."""
        held = formats(candidate.variant)
        return max(held.arithmetic.roundoff, held.storage.roundoff) / ROUNDED_RESULT

    def sample(self, draw: Draw) -> Sample:
        """The states of a draw, in which truth is known once for all candidates."""
        if draw not in self._samples:
            rng = stream(self._seed, draw.purpose, draw.number)
            self._progress(f"exact results in {draw.count} states to {draw.purpose}")
            self._samples[draw] = drawn(self.region, self.judge, draw.count, rng)
            self.judge.truths(self._samples[draw])
        return self._samples[draw]

    def is_costlier(self, candidate: Candidate) -> bool:
        """Whether its arithmetic has more digits than that of the first candidate."""
        first = formats(self.field[0].variant).arithmetic.roundoff
        return formats(candidate.variant).arithmetic.roundoff < first

    def build(
        self, candidates: Sequence[Candidate]
    ) -> tuple[Mapping[Candidate, Hashable], Mapping[Candidate, str]]:
        """Compiled for this machine."""
        built, refused = compile_variants(self.region.system, candidates, self._progress)
        self._built |= {one.candidate: one for one in built}
        reasons = {refusal.label: refusal.reason for refusal in refused}
        missing = (c for c in candidates if c not in self._built)
        return {one.candidate: one.fingerprint for one in built}, {c: reasons[c.label] for c in missing}

    def library(self, candidate: Candidate) -> Library:
        """What was built."""
        return self._built[candidate].library

    def errors(self, candidate: Candidate, draw: Draw) -> Floats:
        """(count,) errors; see `normwise_errors`."""
        return self._error(self.library(candidate), self.sample(draw))

    def times(self, candidates: Sequence[Candidate]) -> dict[Candidate, Times]:
        """Of the objective, without loads and with parameters folded: the timing driver has neither."""
        system, _ = plain(self.region.system)
        built = [self._built[candidate] for candidate in candidates]
        if system != self.region.system:
            built, _ = compile_variants(system, candidates, self._progress)
        sample = self._timed_sample(system)
        rounds = Rounds(self._request.effort.rounds, self._request.effort.seconds)
        found = timed(dict.fromkeys(built, sample), rounds, self._progress)
        return {one.candidate: found[one][self._request.objective] for one in built}

    def attack(self, candidate: Candidate, draw: Draw, number: int) -> Attack:
        """A search for a counterexample; the first one also tries the strata.

        It begins with those that refuted other candidates: what is hard for one is hard for many.
        """
        self._progress(f"searching for a counterexample: {candidate.label}")
        error = functools.partial(self._error, self.library(candidate))
        for tried, refutation in enumerate(self._refutations, start=1):
            height = float(error(sample_from_table(self.region.domain, refutation.where))[0])
            if height > self._budget:
                return replace(refutation, error=height, evaluations=tried)
        seed = int(stream(self._seed, "attack", number).integers(2**31))
        effort = self._request.effort.attack
        found = attacked(self.region, self.judge, error, self.sample(draw), effort, seed, hard=number == 1)
        if found.error > self._budget:
            self._refutations.append(found)
        return found

    @property
    def _budget(self) -> float:
        """Of the error in every state; infinite where some may exceed it, or time has the budget."""
        return self._request.error if self._request.error and self._request.is_strict else math.inf

    def _error(self, library: Library, sample: Sample) -> Floats:
        return normwise_errors(self.judge, library, sample, self._request.objective)

    def _timed_sample(self, system: System) -> Sample:
        """States of the region, without loads."""
        own = self.region.domain
        size = own.first["force"]
        rows = own.uniform(TIMED_STATES, stream(self._seed, "time", 0))
        return Domain(system, own.low[:size], own.high[:size]).states(rows[:, :size])


def normwise_errors(judge: Judge, library: Library, sample: Sample, objective: str) -> Floats:
    """(B,) normwise errors of {ydot}; infinite where it is not finite, or not a solution at all."""
    found = judge.errors(library, sample, objective)
    return np.where(found.wrong | ~np.isfinite(found.normwise), np.inf, found.normwise)
