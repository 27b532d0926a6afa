"""The study of one model: all variants are built, measured and timed, and the best of them once more.

The variants on the Pareto front are selected by one sample and confirmed by another, so that a lucky sample
is not reported as accuracy.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from kanegen.choices import require_one
from kanegen.errors import OptionError
from kanegen.measure.errors import QUANTILES, quantile
from kanegen.measure.timing import OBJECTIVES, Rounds, Times
from kanegen.measure.truth.measurement import Measurement
from kanegen.model.description import require_unprescribed
from kanegen.model.system import System
from kanegen.options import Progress, quiet
from kanegen.reference.regularity import require_regular
from kanegen.studies.bench.states import limits_note, without_loads_and_parameters
from kanegen.studies.tradeoff.compilation import CompiledVariant
from kanegen.studies.tradeoff.domain import Domain, Sample, default_domain
from kanegen.studies.tradeoff.evaluator import VariantEvaluator
from kanegen.studies.tradeoff.hard_states import climb, hard_states
from kanegen.studies.tradeoff.outcome import RANKED_BY, ConfirmedVariant, Study, StudyOptions, VariantResult
from kanegen.studies.tradeoff.pareto_front import Point, pareto_front
from kanegen.studies.tradeoff.variants import Candidate, Refusal, candidates

SELECT, VALIDATE, HARD, SEARCH = range(4)
"""The purposes of samples; the purpose is part of the seed, so that no two purposes share a state."""

DEFAULT_OPTIONS = StudyOptions()
"""The options of a study if no others are given."""


def study(
    system: System,
    options: StudyOptions = DEFAULT_OPTIONS,
    progress: Progress = quiet,
    domain: Domain | None = None,
    variants: Iterable[Candidate] | None = None,
) -> Study:
    """Measure the speed and the accuracy of the forward dynamics of a model, over its variants.

    Args:
        system: The model; its loads are switched off and its run-time parameters become constants.
        options: Sizes of the samples, rounds of timing, seed and quantile.
        progress: Function that is called with the name of each stage.
        domain: States of the model without loads and parameters; by default `default_domain`.
        variants: The variants to measure; by default the table of `tradeoff.variants`.

    Raises:
        BuildError: If there is no C compiler.
        MissingError: If a package of the extra `study` is missing.
        OptionError: If an option is out of range, the domain belongs to another system, a freedom is
            prescribed, or no variant can be built.
        SingularError: If [A] is singular in every state.

    Example:
        >>> found = study(kg.load("models/panda.toml"), StudyOptions(states=64))
        >>> print(found.verdict("latency"))
    """
    require_one("quantile", options.quantile, RANKED_BY)
    require_unprescribed(system, "study")
    model, notes = without_loads_and_parameters(system)
    require_regular(model)
    if domain is None:
        domain, notes = default_domain(model), (*notes, *limits_note(model))
    if domain.system != model:
        raise OptionError(f"the domain belongs to another system than {model.name!r} as it is studied.")
    evaluator = VariantEvaluator(model, progress)
    wanted, refused = (list(variants), []) if variants is not None else candidates()
    built, not_built = evaluator.build(wanted)
    if not built:
        first = (*refused, *not_built, Refusal("none", "there is none"))[0]
        raise OptionError(f"no variant can be built. The first one, {first.label}: {first.reason}")
    measuring = _Measuring(evaluator, domain, options, progress)
    results = measuring.measure(built)
    pareto_fronts = {objective: measuring.confirm(results, objective) for objective in OBJECTIVES}
    every = tuple(results.values())
    return Study(
        model.name, len(model.freedoms), notes, domain, options, every, (*refused, *not_built), pareto_fronts
    )


class _Measuring:
    """The measurements of one study.

    Args:
        evaluator: Evaluator of the variants of the model.
        domain: The states of the study.
        options: Options of the study.
        progress: Function that is called with the name of each stage.
    """

    def __init__(
        self, evaluator: VariantEvaluator, domain: Domain, options: StudyOptions, progress: Progress
    ) -> None:
        self._evaluator, self._domain = evaluator, domain
        self._options, self._progress = options, progress

    def measure(self, built: Sequence[CompiledVariant]) -> dict[CompiledVariant, VariantResult]:
        """Measure and time all variants; variants with the same program share one measurement.

        A variant whose results do not solve the equations is not timed.
        """
        options = self._options
        sample = self._domain.sample(options.states, (options.seed, SELECT))
        hard = hard_states(self._domain, options.hard, (options.seed, HARD))
        programs = {one.fingerprint: one for one in reversed(built)}
        measured: dict[CompiledVariant, VariantResult] = {}
        for number, one in enumerate(programs.values()):
            self._progress(f"measuring {number + 1} of {len(programs)}: {one.candidate.label}")
            errors = {objective: self._evaluator.errors(one, sample, objective) for objective in OBJECTIVES}
            measured[one] = VariantResult(
                one.candidate, one.operations, one.size, errors, self._hard_errors(one, hard), times=None
            )
        times = self._times([one for one, result in measured.items() if not result.wrong])
        measured = {one: replace(result, times=times.get(one)) for one, result in measured.items()}
        return {one: _shared_result(one, programs[one.fingerprint], measured) for one in built}

    def confirm(
        self, results: Mapping[CompiledVariant, VariantResult], objective: str
    ) -> tuple[ConfirmedVariant, ...]:
        """Return the Pareto front of one objective, measured again in fresh states and timed again.

        Variants with other coordinates or speeds have other arrays and are on no front.
        """
        share, options = QUANTILES[self._options.quantile], self._options
        points = [
            Point(one, point.time, point.error)
            for one, result in results.items()
            if result.same_as is None
            and not one.candidate.changes_system
            and (point := result.point(objective, share)) is not None
        ]
        best = [point.item for point in pareto_front(points)]
        sample = self._domain.sample(options.states, (options.seed, VALIDATE))
        errors = {one: self._evaluator.errors(one, sample, objective) for one in best}
        proven = {
            one: quantile(self._evaluator.proven_bounds(one, sample, objective), QUANTILES["median"])
            for one in best
        }
        times = self._times(best)
        fresh = pareto_front(
            Point(one, times[one][objective].median, errors[one].quantile(share)) for one in best
        )
        stay = [point.item for point in fresh]
        found = {one: self._search(one, sample, errors[one], objective) for one in best}
        return tuple(
            ConfirmedVariant(results[one], errors[one], proven[one], times[one], *found[one], one in stay)
            for one in best
        )

    def _hard_errors(self, built: CompiledVariant, hard: Sample | None) -> dict[str, dict[str, Measurement]]:
        """Return the errors in hard states, by the kind of the states and by objective."""
        if hard is None:
            return {}
        errors = {objective: self._evaluator.errors(built, hard, objective) for objective in OBJECTIVES}
        return {
            kind: {objective: found[hard.rows_of(kind)] for objective, found in errors.items()}
            for kind in dict.fromkeys(hard.kinds)
        }

    def _times(self, built: Sequence[CompiledVariant]) -> dict[CompiledVariant, dict[str, Times]]:
        """Return the times in the sample for selection; times hardly depend on the states."""
        options = self._options
        sample = self._domain.sample(options.states, (options.seed, SELECT))
        return self._evaluator.times(built, sample, Rounds(options.rounds, options.seconds))

    def _search(
        self, built: CompiledVariant, sample: Sample, errors: Measurement, objective: str
    ) -> tuple[float, dict[str, tuple[float, ...]]]:
        """Search for the largest error from the worst state of a sample.

        Returns:
            The largest error that was found, and x, y and tau of its state.
        """
        options, start = self._options, sample[errors.worst : errors.worst + 1]
        self._progress(f"searching for the largest error: {built.candidate.label}")
        worst, largest = climb(
            self._domain,
            start,
            lambda tried: self._evaluator.errors(built, tried, objective).normwise,
            options.search,
            (options.seed, SEARCH),
        )
        arrays = {"x": worst.x, "y": worst.y, "tau": worst.tau}
        return largest, {name: tuple(values[0].tolist()) for name, values in arrays.items()}


def _shared_result(
    one: CompiledVariant, program: CompiledVariant, measured: Mapping[CompiledVariant, VariantResult]
) -> VariantResult:
    """Return the result of a variant, which names the variant `program` if it shares its program with it."""
    result = measured[program]
    if one is program:
        return result
    return replace(result, candidate=one.candidate, same_as=program.candidate.label)
