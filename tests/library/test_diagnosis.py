"""Error estimates against certified truth, regularity against NumPy, and the diagnosis of both."""

from __future__ import annotations

import warnings
from dataclasses import FrozenInstanceError

import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.library import Library
from kanegen.library.native import cache
from kanegen.measure.truth import conditioning, truth
from kanegen.options import Variant
from kanegen.program.precision import DOUBLE, precision_named
from kanegen.reference import equations as reference
from kanegen.reference.matrices import length
from kanegen.reference.states import random_states
from tests.support import systems
from tests.support.cases import slow_except
from tests.support.refinement import SOLVERS, computed, mixed, rods, sample

OUTPUTS = ("forward_dynamics", "error_estimate", "regularity")


@pytest.fixture(scope="module", autouse=True)
def folder(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(cache.VARIABLE, str(tmp_path_factory.mktemp("cache")))
        yield


def built(system: kg.System, outputs: tuple[str, ...] = OUTPUTS, **choices: object) -> Library:
    return kg.build(system, outputs, tier=Variant(**choices))


@pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")
@pytest.mark.parametrize(
    ("ratio", "precision", "solver"),
    [
        pytest.param(100.0, "double", "articulated bodies", marks=pytest.mark.slow),
        pytest.param(30.0, "double", "factorisation", marks=pytest.mark.slow),
        pytest.param(1.0, "float", "factorisation", marks=pytest.mark.slow),
        (30.0, "float", "articulated bodies"),
    ],
)
def test_the_estimate_is_the_error(ratio: float, precision: str, solver: str) -> None:
    """The two agree within a factor of three, where the error is more than rounding and no forces cancel."""
    system = rods(ratio)
    library = built(system, precision=precision, solver=solver, refinement=0)
    kind = precision_named(precision)
    states = random_states(system, 40, 3).rounded(kind)
    found = library.forward_dynamics(states.x, states.y).astype(float)
    estimates = library.error_estimate(states.x, states.y).astype(float)
    ratios = []
    for x, y, value, estimate in zip(states.x, states.y, found, estimates, strict=True):
        exact = truth(system, x, y, unit_roundoff=kind.roundoff)
        error = length(value - exact["forward_dynamics"].value)
        if error > 50 * kind.roundoff * length(value) and conditioning(exact).chi < 100:
            ratios.append(length(estimate) / error)
    assert len(ratios) >= 20
    assert min(ratios) >= 1 / 3
    assert max(ratios) <= 3


@pytest.mark.parametrize("solver", slow_except(SOLVERS, "articulated bodies"))
def test_the_estimate_is_the_difference_that_a_step_makes(solver: str) -> None:
    """The system has all kinds of joints and loads.

    With an estimate every body keeps its own inertia, so that the plain and the refined solution begin alike.
    """
    system = mixed(1)
    states, tau = sample(system, 6, 2, DOUBLE)
    both = ("forward_dynamics", "error_estimate")
    plain, estimate = computed(system, states, tau, both, solver=solver, refinement=0)
    refined, same = computed(system, states, tau, both, solver=solver, refinement=1)
    alone = computed(system, states, tau, ("error_estimate",), solver=solver, refinement=0)
    assert (estimate == same).all()
    assert (estimate == alone).all()
    assert (estimate >= 0).all()
    assert estimate.max() > 0
    size = np.abs(plain).max(axis=1, keepdims=True)
    assert (np.abs(np.abs(refined - plain) - estimate) <= 2.0**-50 * size).all()


@pytest.mark.slow
def test_the_estimate_shares_the_solution() -> None:
    system = systems.chain(4)
    alone, both = (
        sum(compile_module(system, outputs, variant=Variant(refinement=1)).operations.values())
        for outputs in (("forward_dynamics",), ("forward_dynamics", "error_estimate"))
    )
    assert both <= alone + 2 * 4  # squares and their roots


def test_regularity_of_a_factorisation() -> None:
    """Freedom i keeps 1 over the first entry of the inverse of the block of [A] that begins at i."""
    system = systems.chain(4, ["theta2"])
    library = built(system, ("regularity",), solver="factorisation")
    x = random_states(system, 5, 1).x
    found = library.regularity(x)
    for state, shares in zip(x, found, strict=True):
        a = reference.mass_matrix(system, state)
        for i in range(4):
            outward = np.linalg.inv(a[i:, i:])
            assert shares[i] == pytest.approx(1 / outward[0, 0] / a[i, i], rel=1e-12)
    bodies = built(system, ("regularity",), solver="articulated bodies").regularity(x)
    assert bodies == pytest.approx(found, rel=1e-12)


def test_regularity_contains_the_distance_from_gimbal_lock() -> None:
    system = systems.chain(1, ["theta1", "theta2", "theta3"])
    library = built(system, ("regularity",))
    x = np.array([[0.3, angle, -0.8] for angle in (0.0, 0.7, 1.2, np.pi / 2 - 1e-6)])
    share = library.regularity(x)
    assert share[:, 0] / share[0, 0] == pytest.approx(np.cos(x[:, 1]) ** 2, rel=1e-9)
    assert share[:, 1:] == pytest.approx(np.tile(share[0, 1:], (4, 1)), rel=1e-12)
    assert share[0].max() == pytest.approx(1.0)
    spinning = built(system.with_speeds("angular_velocity"), ("regularity",)).regularity(x)
    assert spinning == pytest.approx(np.tile(share[0], (4, 1)), rel=1e-12)


def test_regularity_of_translations_and_trees() -> None:
    """Every value is between 0 and 1, and the product of all pivots is the determinant of [A]."""
    system = systems.random_system(np.random.default_rng(4), 4, free=systems.flags(4, ["theta1", "s1", "s3"]))
    library = built(system, ("regularity", "mass_matrix"))
    x = random_states(system, 5, 1).x
    found, a = library.regularity(x), library.mass_matrix(x)
    assert (found > 0).all()
    assert (found <= 1 + 1e-14).all()
    diagonal = np.diagonal(a, axis1=1, axis2=2)
    assert np.prod(found * diagonal, axis=1) == pytest.approx(np.linalg.det(a), rel=1e-11)


def test_diagnose_names_the_worst() -> None:
    system = systems.chain(2, ["theta1", "theta2", "theta3"])
    library = built(system)
    states = random_states(system, 6, 1)
    states.x[4, 4] = np.pi / 2 - 1e-3
    found = library.diagnose(states.x, states.y)
    assert (found.states, found.singular) == (6, 0)
    assert found.singularity is not None
    assert found.singularity.value == pytest.approx(1e-3, rel=1e-5)
    assert (found.singularity.freedom, found.singularity.body) == ("body2.theta2", "body2")
    assert found.singularity.state == 4
    regularity = library.regularity(states.x)
    assert found.pivot.value == regularity.min()
    assert found.pivot.freedom == "body2.theta1"
    estimate = library.error_estimate(states.x, states.y)
    shares = estimate / np.abs(library.forward_dynamics(states.x, states.y)).max(axis=1, keepdims=True)
    assert found.estimate is not None
    assert found.estimate.value == shares.max()
    assert found.estimate.state == np.argmax(shares.max(axis=1))
    text = str(found)
    assert text.startswith("6 states, 0 of them singular\nlargest relative error before refinement: ")
    assert "smallest pivot, relative to its inertia: " in text
    assert (
        "gimbal lock, |cos| or |sin| of theta2: 1.0e-03 at freedom 'body2.theta2' of body 'body2', state 4"
        in text
    )
    with pytest.raises(FrozenInstanceError):
        found.states = 7  # type: ignore[misc]


def test_diagnose_of_one_state_and_of_a_singular_one() -> None:
    system = systems.chain(2, ["theta1", "s2"], loads=True)
    library = built(system)
    states = random_states(system, 1)
    x, y = states.x[0], states.y[0]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = library.diagnose(x, y, np.ones(len(x)), states.force[0], states.torque[0])
        assert (found.states, found.pivot.state) == (1, 0)
        broken = library.diagnose(np.full(len(x), np.nan), y)
    assert (broken.singular, broken.estimate) == (1, None)
    assert np.isnan(broken.pivot.value)
    assert "1 state, 1 of them singular\nsmallest pivot" in str(broken)


def test_a_chain_of_hinges_has_no_gimbal_lock() -> None:
    found = built(rods(30.0)).diagnose(np.full(8, 0.1), np.ones(8))
    assert found.singularity is None
    assert found.estimate is not None
    assert 1e-16 < found.estimate.value < 1e-9


def test_other_sequences_have_gimbal_lock_elsewhere() -> None:
    joints = {"connection": [0], "mass": [1.0], "inertia": [np.eye(3)], "mass_center": [[0.1, 0.2, 0.3]]}
    system = kg.System.from_arrays(
        **joints,
        joint_position=[[0, 0, 0]],
        free=systems.flags(1, ["theta1", "theta2", "theta3"]),
        sequence="3-1-3",
    )
    found = built(system).diagnose([0.4, 0.01, 0.2], [0.1, 0.2, 0.3])
    assert found.singularity is not None
    assert found.singularity.value == pytest.approx(np.sin(0.01))


def test_what_diagnose_needs() -> None:
    library = built(rods(1.0), ("forward_dynamics", "regularity"))
    with pytest.raises(kg.OptionError, match="built without the output 'error_estimate'"):
        library.diagnose(np.zeros(8), np.zeros(8))
    with pytest.raises(kg.ArrayError, match=r"^diagnose: there is no state"):
        built(rods(1.0)).diagnose(np.empty((0, 8)), np.empty((0, 8)))
