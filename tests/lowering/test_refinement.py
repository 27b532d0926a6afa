"""Refinement of forward dynamics: results are accurate or reported as inaccurate, by certified truth."""

from __future__ import annotations

import functools
import warnings
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from sympy import Rational

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.library import Library
from kanegen.library.native import cache
from kanegen.lowering.conditioning import LARGEST_ACCEPTED_ERROR
from kanegen.measure.truth import truth
from kanegen.options import Variant
from kanegen.program.precision import DOUBLE, FLOAT, Precision, precision_named
from kanegen.recursion.correction_size import CorrectionSize
from kanegen.recursion.tree import tree
from kanegen.reference.matrices import length
from kanegen.reference.states import States, random_states
from tests.support import robots, systems
from tests.support.cases import slow_except
from tests.support.refinement import FORWARD, SOLVERS, computed, mixed, rods, sample


@pytest.fixture(scope="module", autouse=True)
def folder(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(cache.VARIABLE, str(tmp_path_factory.mktemp("cache")))
        yield


@functools.cache
def built(system: kg.System, outputs: tuple[str, ...] = FORWARD, **choices: object) -> Library:
    return kg.build(system, outputs, tier=Variant(**choices))


def solved(library: Library, states: States, tau: np.ndarray, i: int) -> tuple[np.ndarray, str]:
    """Return {ydot} of one state, and the warning or error about it, empty if there is none."""
    loads = {} if states.force is None else {"force": states.force[i], "torque": states.torque[i]}
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            value = library.forward_dynamics(states.x[i], states.y[i], tau[i], **loads)
        except kg.SingularError as error:
            return np.full(len(tau[i]), np.nan), str(error)
    return value.astype(float), str(caught[0].message) if caught else ""


def exactly(
    system: kg.System, states: States, tau: np.ndarray, i: int, precision: Precision = DOUBLE
) -> tuple[np.ndarray, np.ndarray]:
    """Return the exact {ydot} of one state, and the factors by which its entries are compared."""
    loads = {} if states.force is None else {"force": states.force[i], "torque": states.torque[i]}
    state = (states.x[i], states.y[i], tau[i])
    found = truth(system, *state, outputs=FORWARD, unit_roundoff=precision.roundoff, **loads)
    return found["forward_dynamics"].value, found.units.acceleration


def errors_and_messages(
    library: Library, system: kg.System, count: int, seed: int = 1
) -> list[tuple[float, str]]:
    """Return the normwise error of every state, and the message about it."""
    precision = precision_named(library.precision)
    states, tau = sample(system, count, seed, precision)
    found = []
    for i in range(count):
        value, message = solved(library, states, tau, i)
        true, scale = exactly(system, states, tau, i, precision)
        found.append((float(length((value - true) * scale) / length(true * scale)), message))
    return found


@pytest.mark.parametrize("precision", ["double", "float"])
@pytest.mark.parametrize("ratio", slow_except((30.0, 1000.0), 1000.0))
def test_growing_masses_are_accurate_or_reported(ratio: float, precision: str) -> None:
    system = rods(ratio)
    found = errors_and_messages(built(system, precision=precision), system, 60)
    limit = LARGEST_ACCEPTED_ERROR * precision_named(precision).roundoff
    assert all(error <= limit for error, message in found if not message)
    assert any(not message for _, message in found) or (ratio, precision) == (1000.0, "float")
    if precision == "double":
        assert all(error <= 1e-12 and not message for error, message in found)


def test_without_refinement_errors_are_reported() -> None:
    """The systems of the test above need refinement; otherwise it would prove nothing."""
    found = errors_and_messages(built(rods(1000.0), refinement=0), rods(1000.0), 10)
    assert all(message for _, message in found)
    assert any(error > 0.01 and "not accurate in this state" in message for error, message in found)


@pytest.mark.parametrize(
    ("ratio", "precision"),
    [pytest.param(50.0, "double", marks=pytest.mark.slow), (1000.0, "double"), (8.0, "float")],
)
def test_a_factorisation_reports_where_it_fails(ratio: float, precision: str) -> None:
    found = errors_and_messages(
        built(rods(ratio), precision=precision, solver="factorisation", refinement=1), rods(ratio), 40
    )
    limit = LARGEST_ACCEPTED_ERROR * precision_named(precision).roundoff
    assert all(error <= limit for error, message in found if not message)
    said = [message for error, message in found if error > limit]
    assert said
    doubtful = "the result is not accurate in this state. Most digits are lost at freedom 'body"
    assert all(doubtful in text or "the pivot of [A] at freedom" in text for text in said)


def test_overflow_is_reported_as_inaccurate() -> None:
    """Squares of accelerations leave the range of float here."""
    library, system = built(rods(30.0), precision="float", refinement=1), rods(30.0)
    x = random_states(system, 1).x[0]
    with pytest.warns(kg.KanegenWarning, match="not accurate in this state"):
        library.forward_dynamics(x, np.full(8, 1e12))


@pytest.mark.parametrize("solver", slow_except(SOLVERS, "articulated bodies"))
@pytest.mark.parametrize(
    "make",
    [
        pytest.param(lambda: mixed(1), marks=pytest.mark.slow),
        lambda: mixed(2),
        pytest.param(lambda: systems.chain(3), marks=pytest.mark.slow),
    ],
)
def test_ordinary_trees_stay_as_accurate(make: Callable[[], kg.System], solver: str) -> None:
    system = make()
    states, tau = sample(system, 6, 3, DOUBLE)
    exact = np.stack([exactly(system, states, tau, i)[0] for i in range(6)])
    scale = length(exact, axis=1)
    errors = [
        length(computed(system, states, tau, solver=solver, refinement=steps) - exact, axis=1) / scale
        for steps in (0, 1, 2)
    ]
    assert (errors[1] <= np.maximum(2 * errors[0], 100 * DOUBLE.roundoff)).all()
    assert (errors[2] <= np.maximum(2 * errors[0], 100 * DOUBLE.roundoff)).all()


def test_angles_that_lose_their_rank_keep_their_accuracy() -> None:
    """Residuals are torques on the bodies, so that nothing is divided by cos(theta2) twice."""
    system = systems.chain(2, ["theta1", "theta2", "theta3"])
    library = built(system, refinement=1)
    states = random_states(system, 1)
    x, y = states.x[0].copy(), states.y[0]
    x[[1, 4]] = np.pi / 2 - 1e-6
    found = library.forward_dynamics(x, y)
    exact = truth(system, x, y, outputs=FORWARD)["forward_dynamics"].value
    regular = [1, 4]
    assert np.abs(found - exact)[regular].max() <= 1e-13 * np.abs(exact[regular]).max()
    assert length(found - exact) <= 1e-9 * length(exact)


def test_speeds_that_are_angular_velocities() -> None:
    system = mixed(3).with_speeds("angular_velocity")
    states, tau = sample(system, 5, 4, DOUBLE)
    plain, refined = (computed(system, states, tau, refinement=steps) for steps in (0, 1))
    assert (length(refined - plain, axis=1) <= 1e-12 * length(plain, axis=1)).all()
    assert (refined != plain).any()


def test_parameters() -> None:
    mass = [kg.Parameter("m1", 1.0), 1.0, 1.0, 1e3, 1e6, 1e9]
    plain = rods(30.0, 6)
    bodies = tuple(replace(body, mass=m) for body, m in zip(plain.bodies, mass, strict=True))
    system = replace(plain, bodies=bodies)
    library = built(system, refinement=1)
    changed = system.with_parameters({"m1": 3.0})
    states, tau = sample(changed, 4, 2, DOUBLE)
    other = library.with_parameters({"m1": 3.0})
    for i in range(4):
        value, message = solved(other, states, tau, i)
        exact = truth(changed, states.x[i], states.y[i], tau[i], outputs=FORWARD)["forward_dynamics"].value
        assert not message
        assert length(value - exact) <= 1e-13 * length(exact)


def test_a_batch_reports_the_states_that_single_calls_report() -> None:
    """The same states of a batch are inaccurate or singular as one by one."""
    system = rods(8.0)
    library = built(system, precision="float", solver="factorisation", refinement=1)
    states, tau = sample(system, 37, 5, FLOAT)
    single = [solved(library, states, tau, i) for i in range(37)]
    doubtful = sum("not accurate" in message for _, message in single)
    failed = sum("pivot" in message for _, message in single)
    assert doubtful > 0
    with pytest.warns(
        kg.KanegenWarning, match=f"in {doubtful} of 37 states the result is not accurate"
    ) as caught:
        found = library.forward_dynamics(states.x, states.y, tau)
    assert caught[0].filename == __file__
    assert (f"in {failed} of 37 states the result does not exist" in str(caught[0].message)) == (failed > 0)
    assert np.isnan(found).any(axis=1).sum() == failed


def test_automatic_refinement_is_chosen_where_needed() -> None:
    for bodies, ratio, wanted in (
        (8, 30.0, 1),
        (8, 1e3, 1),
        (5, 30.0, 1),
        (8, 1.0, 0),
        (8, 0.03, 0),
        (3, 30.0, 0),
    ):
        compiled = compile_module(rods(ratio, bodies), FORWARD)
        assert compiled.refinement.startswith(f"{wanted} (auto: "), (bodies, ratio, compiled.refinement)
        assert not wanted or compiled.methods == {"forward_dynamics": "articulated bodies"}


ORDINARY: dict[str, Callable[[], kg.System]] = {
    "eight_body": systems.eight_body,
    "panda": lambda: kg.load(robots.robot_file("panda")),
    "ur5": lambda: kg.load(robots.robot_file("ur5_robot")),
    "hyq": lambda: kg.load(robots.robot_file("hyq_no_sensors"), floating_base=True),
    "chain": lambda: systems.chain(6, ["theta1", "s2"]),
    "star": lambda: systems.random_system(np.random.default_rng(1), 5, connection=(0, 1, 1, 1, 1)),
}


@pytest.mark.filterwarnings("ignore::kanegen.KanegenWarning")
@pytest.mark.parametrize("precision", slow_except(["double", "float"], "double"))
@pytest.mark.parametrize("name", slow_except(ORDINARY, "ur5", "star"))
def test_automatic_refinement_leaves_ordinary_trees_alone(name: str, precision: str) -> None:
    system = ORDINARY[name]()
    source = kg.generate(system, FORWARD, tier=Variant(precision=precision))
    plain = kg.generate(system, FORWARD, tier=Variant(precision=precision, refinement=0))
    code = f"{system.name}.c"
    assert source.files[code].splitlines()[1:] == plain.files[code].splitlines()[1:]
    assert "refinement: 0 (auto: " in source.files[f"{system.name}.h"]


def test_nothing_is_decided_without_forward_dynamics() -> None:
    header = kg.generate(rods(30.0)).files["rods.h"]
    assert " *     precision: double\n *     sincos: shared\n *\n" in header
    assert "refinement" not in header


def test_the_header_documents_refinement_and_status() -> None:
    header = kg.generate(rods(30.0), FORWARD).files["rods.h"]
    assert "refinement: 1 (auto: it repairs about 1e+09 roundoffs)" in header
    reported = "-1 and below: minus such a place where nothing failed, but the error may be large"
    assert reported in header
    plain = kg.generate(rods(30.0), FORWARD, tier=Variant(refinement=0)).files["rods.h"]
    assert "refinement: 0\n" in plain
    assert reported in plain
    assert "-1 and below" not in kg.generate(rods(0.03), FORWARD).files["rods.h"]


@pytest.mark.parametrize(
    ("name", "most"), [pytest.param("eight_body", 0.6, marks=pytest.mark.slow), ("chain", 0.45)]
)
def test_a_step_costs_clearly_less_than_a_solution(name: str, most: float) -> None:
    """The first step, which includes the size of the correction, and the second, as shares of a solution."""
    system = ORDINARY["eight_body"]() if name == "eight_body" else systems.chain(5)
    variants = [Variant(solver=SOLVERS[0], refinement=steps) for steps in (0, 1, 2)]
    costs = [sum(compile_module(system, FORWARD, variant=v).operations.values()) for v in variants]
    assert costs[1] - costs[0] <= most * costs[0]
    assert costs[2] - costs[1] <= most * costs[0]


def test_unknown_refinements() -> None:
    for value in (3, -1, "always", True):
        with pytest.raises(kg.OptionError, match=f"^unknown refinement {value!r}"):
            Variant(refinement=value)


def test_angles_and_translations_have_one_size() -> None:
    """Their unit is a length whose square is the mean pivot of the angles over that of the translations."""
    free = systems.flags(1, ["theta1", "theta2", "s3"])
    one = replace(systems.random_system(np.random.default_rng(0), 1), force_elements=())
    joint = replace(one.bodies[0].joint, free=tuple(map(bool, free[0])), locked=(0.0,) * 6)
    system = replace(one, bodies=(replace(one.bodies[0], joint=joint),))
    prepared = tree(system)
    pivots, solution, correction = ([Rational(v) for v in row] for row in ((2, 4, 8), (1, 2, 5), (3, 0, 1)))
    size = CorrectionSize(prepared, pivots, solution, correction)
    assert size.whole == Rational(3, 8) * (1 + 4) + 25


def test_each_step_of_refinement_corrects_what_the_one_before_has_left() -> None:
    """Where one step leaves thousands of roundoffs, a second leaves a few; it is not the first step again."""
    system = rods(50.0)
    states, tau = sample(system, 6, 3, DOUBLE)
    exact, scale = (
        np.stack(rows) for rows in zip(*(exactly(system, states, tau, i) for i in range(6)), strict=True)
    )
    once, twice = (
        length(
            (computed(system, states, tau, solver="factorisation", refinement=steps) - exact) * scale, axis=1
        )
        / length(exact * scale, axis=1)
        for steps in (1, 2)
    )
    assert (once > 100 * DOUBLE.roundoff).all()
    assert (twice <= 16 * DOUBLE.roundoff).all()
