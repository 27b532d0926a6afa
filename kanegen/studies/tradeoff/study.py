"""The study of one model: all variants are built, judged and timed; the best of them once more.

What is selected on one sample is confirmed on another, so that luck is not reported as accuracy.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from kanegen.choices import require_one
from kanegen.errors import OptionError
from kanegen.library.native import compilers
from kanegen.measure.errors import QUANTILES
from kanegen.measure.timing import OBJECTIVES, Rounds, Times
from kanegen.measure.truth.measurement import Measurement
from kanegen.model.prescribed import require_unprescribed
from kanegen.model.system import System
from kanegen.options import Progress
from kanegen.reference.regularity import require_regular
from kanegen.studies.bench.states import without_loads_and_parameters
from kanegen.studies.tradeoff.compilation import CompiledVariant, compile_variants
from kanegen.studies.tradeoff.converting import converted
from kanegen.studies.tradeoff.domain import Domain, default_domain
from kanegen.studies.tradeoff.hard_states import climb, hard_states
from kanegen.studies.tradeoff.judge import Judge
from kanegen.studies.tradeoff.outcome import RANKED_BY, Confirmed, Entry, Study, StudyOptions
from kanegen.studies.tradeoff.pareto_front import Point, front
from kanegen.studies.tradeoff.samples import Sample
from kanegen.studies.tradeoff.times import timed
from kanegen.studies.tradeoff.variants import Candidate, Refusal, candidates

SELECT, VALIDATE, HARD, SEARCH = range(4)
"""What samples are for; with the seed of the study it is their seed, so that no two share a state."""

USUAL = StudyOptions()
"""Unless others are asked for."""


def study(
    system: System,
    terms: StudyOptions = USUAL,
    progress: Progress = lambda stage: None,
    domain: Domain | None = None,
    variants: Iterable[Candidate] | None = None,
) -> Study:
    """Speed against accuracy of the forward dynamics of a model, over its variants.

    Args:
        system: The model; loads are switched off and run-time parameters folded.
        terms: Of the study.
        progress: Told the name of each stage.
        domain: Of the model without loads and parameters; by default `default_domain`.
        variants: What is tried; by default the table of `variants`.

    Raises:
        BuildError: If there is no C compiler.
        MissingError: If a package of the extra `study` is missing.
        OptionError: If a term makes no sense, the domain belongs to another system, a freedom is prescribed,
            or no variant can be built.
        SingularError: If [A] is singular in every state.
    """
    require_one("quantile", terms.quantile, RANKED_BY)
    require_unprescribed(system, "study")
    model, notes = without_loads_and_parameters(system)
    require_regular(model)
    compilers.find()
    bench = Bench(model, domain or default_domain(model), terms, progress)
    wanted, refused = (list(variants), []) if variants is not None else candidates()
    built, not_built = compile_variants(model, wanted, progress)
    if not built:
        first = (*refused, *not_built, Refusal("none", "there is none"))[0]
        raise OptionError(f"no variant can be built. The first one, {first.label}: {first.reason}")
    entries = bench.entries(built)
    fronts = {objective: bench.confirmed(entries, objective) for objective in OBJECTIVES}
    every = tuple(entries.values())
    return Study(
        model.name, len(model.freedoms), notes, bench.domain, terms, every, (*refused, *not_built), fronts
    )


class Bench:
    """Judges and times the variants of one model, remembering every truth."""

    def __init__(self, system: System, domain: Domain, terms: StudyOptions, progress: Progress) -> None:
        if domain.system != system:
            raise OptionError(f"the domain belongs to another system than {system.name!r} as it is studied.")
        self.domain = domain
        self._system, self._terms, self._progress = system, terms, progress
        self._judges: dict[System, Judge] = {}

    def entries(self, built: Sequence[CompiledVariant]) -> dict[CompiledVariant, Entry]:
        """Every variant with its errors and, where it is right, its times; equal programs share them."""
        terms = self._terms
        sample = self.domain.sample(terms.states, (terms.seed, SELECT))
        hard = hard_states(self.domain, terms.hard, (terms.seed, HARD))
        programs = {one.fingerprint: one for one in reversed(built)}
        measured: dict[CompiledVariant, Entry] = {}
        for number, one in enumerate(programs.values()):
            self._progress(f"judging {number + 1} of {len(programs)}: {one.candidate.label}")
            errors = {objective: self.errors(one, sample, objective) for objective in OBJECTIVES}
            measured[one] = Entry(
                one.candidate, one.operations, one.size, errors, self._by_stratum(one, hard), times=None
            )
        times = self._times([one for one, entry in measured.items() if not entry.wrong])
        measured = {one: replace(entry, times=times.get(one)) for one, entry in measured.items()}
        return {one: _shared(one, programs[one.fingerprint], measured) for one in built}

    def errors(self, built: CompiledVariant, sample: Sample, objective: str) -> Measurement:
        """Of a variant in states of the domain."""
        own = built.candidate.of(self._system)
        judge = self._judges.setdefault(own, Judge(own))
        return judge.errors(built.library, converted(sample, self._system, own), objective)

    def confirmed(self, entries: Mapping[CompiledVariant, Entry], objective: str) -> tuple[Confirmed, ...]:
        """The front by one objective, measured again."""
        share, terms = QUANTILES[self._terms.quantile], self._terms
        points = [
            Point(one, point.time, point.error)
            for one, entry in entries.items()
            if entry.same_as is None and (point := entry.point(objective, share)) is not None
        ]
        best = [point.what for point in front(points)]
        sample = self.domain.sample(terms.states, (terms.seed, VALIDATE))
        errors = {one: self.errors(one, sample, objective) for one in best}
        times = self._times(best)
        fresh = front(Point(one, times[one][objective].median, errors[one].quantile(share)) for one in best)
        stay = [point.what for point in fresh]
        found = {one: self._attacked(one, sample, errors[one], objective) for one in best}
        return tuple(
            Confirmed(entries[one], errors[one], times[one], *found[one], one in stay) for one in best
        )

    def _by_stratum(self, built: CompiledVariant, hard: Sample | None) -> dict[str, dict[str, Measurement]]:
        if hard is None:
            return {}
        errors = {objective: self.errors(built, hard, objective) for objective in OBJECTIVES}
        return {
            stratum: {objective: found[hard.of(stratum)] for objective, found in errors.items()}
            for stratum in dict.fromkeys(hard.strata)
        }

    def _times(self, built: Sequence[CompiledVariant]) -> dict[CompiledVariant, dict[str, Times]]:
        """In the states by which variants are selected; time hardly depends on them."""
        terms = self._terms
        sample = self.domain.sample(terms.states, (terms.seed, SELECT))
        own = {one: converted(sample, self._system, one.candidate.of(self._system)) for one in built}
        return timed(own, Rounds(terms.rounds, terms.seconds), self._progress)

    def _attacked(
        self, built: CompiledVariant, sample: Sample, errors: Measurement, objective: str
    ) -> tuple[float, dict[str, tuple[float, ...]]]:
        """The largest error near the worst state of a sample, and that state."""
        terms, start = self._terms, sample[errors.worst : errors.worst + 1]
        self._progress(f"searching for the largest error: {built.candidate.label}")
        worst, height = climb(
            self.domain,
            start,
            lambda tried: self.errors(built, tried, objective).normwise,
            terms.search,
            (terms.seed, SEARCH),
        )
        arrays = {"x": worst.x, "y": worst.y, "tau": worst.tau}
        return height, {name: tuple(values[0].tolist()) for name, values in arrays.items()}


def _shared(
    one: CompiledVariant, program: CompiledVariant, measured: Mapping[CompiledVariant, Entry]
) -> Entry:
    """The entry of a variant, which may share its program with another."""
    entry = measured[program]
    if one is program:
        return entry
    return replace(entry, candidate=one.candidate, same_as=program.candidate.label)
