"""Properties of compiled C of random trees: it agrees with the reference, in batches too."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings

import kanegen as kg
from kanegen.measure import comparison as compare
from tests.support.systems import systems

TOLERANCE = 1e-13
"""Errors of trees of up to 12 bodies are about 1e-15; the bound of `compare` is tighter still."""


def agrees_with_the_reference(system: kg.System) -> None:
    library = kg.build(system)
    report = compare.compare(system, library, states=20)
    assert report.max_error <= TOLERANCE, str(report)
    assert report.passed, str(report)


@settings(max_examples=6, deadline=None, derandomize=True)
@given(systems(max_bodies=8))
def test_c_equals_the_reference(system: kg.System) -> None:
    agrees_with_the_reference(system)


@pytest.mark.slow
@settings(max_examples=25, deadline=None, derandomize=True)
@given(systems())
def test_c_of_larger_trees_equals_the_reference(system: kg.System) -> None:
    agrees_with_the_reference(system)


@settings(max_examples=5, deadline=None, derandomize=True)
@given(systems(max_bodies=4))
def test_a_batch_equals_its_states(system: kg.System) -> None:
    """The difference is at most the effect of an ulp of every sine and cosine, which batches compute anew."""
    library = kg.build(system)
    x, y = np.random.default_rng(3).normal(size=(2, 5, library.n))
    for batch, states in (
        (library.mass_matrix(x), [library.mass_matrix(row) for row in x]),
        (library.forcing(x, y), [library.forcing(*rows) for rows in zip(x, y, strict=True)]),
    ):
        np.testing.assert_allclose(batch, states, rtol=0, atol=1e-15 * library.n * np.abs(batch).max())


@settings(max_examples=5, deadline=None, derandomize=True)
@given(systems(max_bodies=4))
def test_the_place_in_a_batch_does_not_matter(system: kg.System) -> None:
    library = kg.build(system)
    x, y = np.random.default_rng(4).normal(size=(2, 19, library.n))
    whole = library.evaluate(x, y)
    for rows in (slice(None, None, -1), slice(3, 4), slice(5, 18), slice(1, None, 2)):
        part = library.evaluate(x[rows], y[rows])
        np.testing.assert_array_equal(part.mass_matrix, whole.mass_matrix[rows])
        np.testing.assert_array_equal(part.forcing, whole.forcing[rows])
