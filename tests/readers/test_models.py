"""Every model of models/ is generated, compiled and compared with the reference, for several parameters."""

from __future__ import annotations

from pathlib import Path

import pytest

import kanegen as kg
from kanegen.measure import comparison as compare
from tests.support.paths import MODEL_FILES


@pytest.mark.parametrize("model", MODEL_FILES, ids=lambda path: path.stem)
def test_model_is_right(model: Path) -> None:
    report = kg.compare(kg.load(model), states=200)
    assert report.passed, str(report)
    assert report.max_error <= 1e-13


WITH_PARAMETERS = [model for model in MODEL_FILES if kg.load(model).parameters]


@pytest.mark.parametrize("model", WITH_PARAMETERS, ids=lambda path: path.stem)
def test_other_parameters_take_effect(model: Path) -> None:
    system = kg.load(model)
    others = {p.name: p.value * (1.25 + 0.125 * i) for i, p in enumerate(system.parameters)}
    library = kg.build(system).with_parameters(others)
    changed = compare.compare(system.with_parameters(others), library, states=100)
    assert changed.passed, str(changed)
    assert not compare.compare(system, library, states=100).passed


def test_eight_body_is_the_tree_of_the_notes() -> None:
    system = kg.load(MODEL_FILES[[path.stem for path in MODEL_FILES].index("eight_body")])
    assert system.connection == (0, 1, 2, 2, 1, 1, 1, 7)
    assert len(system.freedoms) == 48
    operations = kg.generate(system).operations
    assert operations["add"] + operations["multiply"] <= 4586
