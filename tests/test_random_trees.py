"""Property: the compiled C of any tree agrees with the reference."""

from __future__ import annotations

import numpy as np
from hypothesis import HealthCheck, given, settings

import kanegen as kg
from kanegen.check import compare
from tests.systems import systems

TOLERANCE = 1e-13
"""Trees of up to 12 bodies lose about 1e-15; the bound of `compare` itself is tighter still."""

FLAGS = ("-O1", "-ffp-contract=off")
"""Without contraction every level of optimisation gives the same bits, and this one compiles sooner."""


@settings(max_examples=40, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
@given(systems())
def test_c_equals_the_reference(system: kg.System) -> None:
    library = kg.build(system, flags=FLAGS)
    report = compare.compare(system, library, states=20)
    assert report.max_error <= TOLERANCE, str(report)
    assert report.passed, str(report)


@settings(max_examples=10, deadline=None, derandomize=True)
@given(systems(max_bodies=4))
def test_a_batch_equals_its_states(system: kg.System) -> None:
    library = kg.build(system, flags=FLAGS)
    rng = np.random.default_rng(3)
    x, y = rng.normal(size=(2, 5, library.n))
    matrices, forcings = library.mass_matrix(x), library.forcing(x, y)
    for i in range(len(x)):
        np.testing.assert_array_equal(matrices[i], library.mass_matrix(x[i]))
        np.testing.assert_array_equal(forcings[i], library.forcing(x[i], y[i]))
