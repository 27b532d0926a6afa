"""Trade-off studies with made figures, for tests of the words and the pictures that follow from them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np

from kanegen.measure.timing import BATCH, LATENCY, OBJECTIVES, Times
from kanegen.measure.truth.measurement import Measurement
from kanegen.studies.tradeoff.domain import default_domain
from kanegen.studies.tradeoff.outcome import ConfirmedVariant, Study, StudyOptions, VariantResult
from kanegen.studies.tradeoff.pareto_front import Point, pareto_front
from kanegen.studies.tradeoff.variants import Candidate
from tests.support import systems

SPREAD = (1.0, 1.01, 0.99, 1.02, 0.98, 1.005, 0.995)
"""Times of seven rounds over their median, of a machine without noise."""


def measured(error: float) -> Measurement:
    """Return errors in two states, of which the larger one is `error`."""
    values = {field.name: np.zeros(2) for field in fields(Measurement)}
    values["normwise"] = np.array([0.5 * error, error])
    values["bound"] = np.array([error, error])
    return Measurement(**values)


def result(
    candidate: Candidate, ns: float, error: float, rounds: tuple[float, ...] = SPREAD, **others: Any
) -> VariantResult:
    """Return a variant with a time for each round and errors up to `error`; batches take half the time."""
    times = {LATENCY: Times(tuple(ns * r for r in rounds)), BATCH: Times(tuple(0.5 * ns * r for r in rounds))}
    errors = dict.fromkeys(OBJECTIVES, measured(error))
    return VariantResult(candidate, 100, 1000, errors, {}, times, **others)


def made_study(*results: VariantResult) -> Study:
    """Return a study with these results, whose Pareto fronts stay as they were selected."""
    system = systems.chain(2, ["theta3"])
    study = Study("made", 2, (), default_domain(system), StudyOptions(), results, (), {})
    fronts: Mapping[str, tuple[ConfirmedVariant, ...]] = {
        objective: tuple(_confirmed(point) for point in pareto_front(study.points(objective)))
        for objective in OBJECTIVES
    }
    return Study("made", 2, (), study.domain, study.options, results, (), fronts)


def _confirmed(point: Point[VariantResult]) -> ConfirmedVariant:
    """Return a variant on a front with the figures by which it was selected."""
    one = point.item
    assert one.times is not None
    errors = one.errors[LATENCY]
    return ConfirmedVariant(one, errors, errors.max, one.times, errors.max, {}, stays=True)
