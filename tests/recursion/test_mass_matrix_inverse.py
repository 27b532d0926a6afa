"""The inverse of [A], against the inverse of the reference's [A], in a wider precision, and by its status."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.errors import KanegenWarning, OptionError, SingularError
from kanegen.lowering.conditioning import LARGEST_ACCEPTED_ERROR
from kanegen.lowering.losses import array_inputs
from kanegen.lowering.lower import lower
from kanegen.model.arrays import Floats
from kanegen.options import Variant
from kanegen.program.constants import MULTIPRECISION
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import Program
from kanegen.recursion import derive, methods
from kanegen.reference import equations as reference
from kanegen.reference.states import States, random_states
from tests.support import random_trees, systems
from tests.support.cases import slow_except
from tests.support.chains import bushes, gimbals, hinges
from tests.support.robots import robot_file
from tests.support.rod_on_light_links import ROUNDOFF, X, rod_on_light_links
from tests.support.status_search import TREES

NAME = "mass_matrix_inverse"


def program(system: kg.System, way: Mapping[str, str]) -> Program:
    return lower(derive(system, way), (NAME,))


def computed(system: kg.System, way: Mapping[str, str], states: States) -> Floats:
    """Return the (B, n, n) values of the program that becomes C."""
    lowered, n = program(system, way), len(system.freedoms)
    (rows,) = evaluate(lowered, array_inputs(system, lowered, states), np, np.float64).values()
    found = np.stack([np.broadcast_to(row, len(states)) for row in rows], axis=-1)
    return found.reshape(-1, n, n)


def scaled(matrix: Floats, root: Floats) -> Floats:
    return matrix / root[:, :, None] / root[:, None, :]


def check(found: Floats, a: Floats) -> None:
    """Require an inverse of (B, n, n) matrices, entry (i, j) relative to the root of entries (i, i), (j, j).

    An inverse is known to as many digits as the condition number of [A], with a diagonal of ones, leaves
    (Higham 2002, section 10.1).
    """
    root = np.sqrt(np.diagonal(a, axis1=1, axis2=2))
    unit = scaled(a, root)
    expected = scaled(np.linalg.inv(unit), root)
    size = np.sqrt(np.diagonal(expected, axis1=1, axis2=2))
    error = np.abs(scaled(found - expected, size)).max(axis=(1, 2))
    assert (error <= 1e-14 * np.linalg.cond(unit)).all()
    assert (found == found.transpose(0, 2, 1)).all()


@pytest.mark.parametrize("seed", slow_except(range(24), *range(5)))
def test_trees_with_everything(seed: int) -> None:
    """Both solvers, where they take the rotors of the tree."""
    system = random_trees.everything(seed, 3)
    states = random_states(system, 5, seed)
    a = np.asarray(reference.mass_matrix(system, states.x, states.prescribed))
    for way in methods(system, (NAME,), "factorisation"):
        check(computed(system, way, states), a)
    for way in methods(system, (NAME,)):
        check(computed(system, way, states), a)


@pytest.mark.parametrize("seed", slow_except(range(6), *range(3)))
@pytest.mark.parametrize("solver", ["articulated bodies", "factorisation"])
def test_trees_without_rotors(solver: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    system = systems.random_system(rng, bodies=int(rng.integers(1, 7)))
    states = random_states(system, 5, seed)
    (way,) = methods(system, (NAME,), solver)
    check(computed(system, way, states), np.asarray(reference.mass_matrix(system, states.x)))


@pytest.mark.parametrize("tree", [hinges(6), bushes(4), gimbals(3)], ids=lambda system: system.name)
def test_chains(tree: kg.System) -> None:
    states = random_states(tree, 4)
    for solver in ("articulated bodies", "factorisation"):
        (way,) = methods(tree, (NAME,), solver)
        check(computed(tree, way, states), np.asarray(reference.mass_matrix(tree, states.x)))


def test_close_to_gimbal_lock_every_entry_keeps_its_digits() -> None:
    """[A] is nearly singular there, but its inverse, in the components of the body, is not lost."""
    system = kg.load(robot_file("solo12"), floating_base=True)
    system = system.with_locked({name: 0.1 for name in system.freedom_names[6:]})
    (way,) = methods(system, (NAME,))
    assert way[NAME] == "articulated bodies"
    states = random_states(system, 1)
    middle = system.freedom_names.index("base_link.theta2")
    states.x[:, middle] = np.pi / 2 - 1e-7
    lowered = program(system, way)
    rows = array_inputs(system, lowered, states)
    exact = {name: [MULTIPRECISION.mpf(float(row[0])) for row in values] for name, values in rows.items()}
    (wide,) = evaluate(lowered, exact, MULTIPRECISION, MULTIPRECISION.mpf).values()
    expected = np.array([float(value) for value in wide]).reshape(6, 6)
    found = computed(system, way, states)[0]
    size = np.sqrt(np.diagonal(expected))
    assert size.max() > 1e6  # it is close to singular
    # cos(theta2) itself has an error of one roundoff of 1, over 1e-7.
    assert np.abs((found - expected) / size[:, None] / size).max() <= 1e-8
    regular = [i for i in range(6) if size[i] < 1e3 * size.min()]
    assert len(regular) >= 3
    block = np.ix_(regular, regular)
    assert np.abs((found - expected) / size[:, None] / size)[block].max() <= 1e-12


@pytest.fixture(scope="module")
def library() -> kg.Library:
    return kg.build(random_trees.everything(9, 3), (NAME, "mass_matrix"))


def test_compiled_code(library: kg.Library) -> None:
    """One state and many, with other values of the parameters, and together with [A]."""
    system = random_trees.everything(9, 3)
    changed = random_trees.other_parameters(system, 1)
    for model, built in (
        (system, library),
        (system.with_parameters(changed), library.with_parameters(changed)),
    ):
        states = random_states(model, 37)
        given = {"prescribed": states.prescribed} if system.prescribed else {}
        a = np.asarray(reference.mass_matrix(model, states.x, states.prescribed))
        found = built.mass_matrix_inverse(states.x, **given)
        check(found, a)
        one = {name: value[3] for name, value in given.items()}
        assert built.mass_matrix_inverse(states.x[3], **one) == pytest.approx(found[3], rel=1e-12, abs=1e-13)


def test_single_precision() -> None:
    system = kg.load(robot_file("ur5_robot"))
    library = kg.build(system, (NAME,), tier="single")
    x = np.random.default_rng(3).uniform(-2, 2, (20, 6))
    a = np.asarray(reference.mass_matrix(system, x))
    found = library.mass_matrix_inverse(x)
    assert found.dtype == np.float32
    expected = np.linalg.inv(a)
    size = np.sqrt(np.diagonal(expected, axis1=1, axis2=2))
    assert np.abs(scaled(found - expected, size)).max() <= 1e-5 * np.linalg.cond(a).max() / 100


def test_a_singular_state_has_no_inverse() -> None:
    """A point mass on two light links of equal length cannot move along them while they are stretched."""
    system = kg.System.from_arrays(
        connection=[0, 1],
        mass=[0.0, 1.0],
        inertia=np.zeros((2, 3, 3)),
        mass_center=[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]],
        joint_position=[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]],
        free=np.array([[0, 0, 1, 0, 0, 0]] * 2, dtype=bool),
    )
    library = kg.build(system, (NAME,))
    with pytest.raises(
        SingularError, match=r"mass_matrix_inverse: the pivot of \[A\] at freedom 'body1.theta3'"
    ):
        library.mass_matrix_inverse([0.1, 0.0])
    with pytest.warns(KanegenWarning, match=r"in 1 of 2 states the result does not exist"):
        found = library.mass_matrix_inverse([[0.1, 0.0], [0.1, 0.2]])
    assert np.isnan(found[0]).all()
    assert np.isfinite(found[1]).all()
    with pytest.raises(OptionError, match="mass_matrix"):
        library.mass_matrix([0.0, 0.0])


def test_a_tree_without_an_inverse_is_refused() -> None:
    body = kg.Body(
        "point", 0, 1.0, np.zeros((3, 3)).tolist(), (0.0, 0.0, 0.0), kg.Joint(free=(True,) + (False,) * 5)
    )
    with pytest.raises(SingularError, match="which mass_matrix_inverse would need"):
        kg.generate(kg.System("point", (body,)), (NAME,))


@pytest.mark.parametrize("solver", slow_except(("cheapest", "factorisation"), "cheapest"))
@pytest.mark.parametrize("together", slow_except((False, True), True))
def test_no_large_error_is_silent(solver: str, together: bool) -> None:
    """A rod on light links, whose {ydot} is refined, while [A]^-1 beside it is not: it has a status."""
    system = rod_on_light_links()
    outputs = ("forward_dynamics", NAME) if together else (NAME,)
    library = kg.build(system, outputs, tier=Variant(solver=solver), on_status="ignore")
    x = np.array(X) + 0.3 * np.random.default_rng(1).normal(size=(40, 6))
    found = library.mass_matrix_inverse(x)
    reported = statuses(library, x)
    errors = np.array([error_in_wide_precision(system, *one) for one in zip(x, found, strict=True)])
    assert errors.max() > LARGEST_ACCEPTED_ERROR * ROUNDOFF  # the test can fail
    assert (errors[~reported] <= LARGEST_ACCEPTED_ERROR * ROUNDOFF).all()


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
def test_search_for_large_errors_without_a_status(seed: int) -> None:
    """Arms, elbows, wrists and chains with masses of many sizes, straight and bent."""
    rng = np.random.default_rng(seed)
    system = TREES[seed % len(TREES)](rng, rng.choice([3.0, 6.0]))
    n = len(system.freedoms)
    x = rng.uniform(-3, 3, (40, n)) * rng.choice([1.0, 0.1, 0.01], (40, n))
    for solver in ("cheapest", "factorisation"):
        library = kg.build(system, (NAME,), tier=Variant(solver=solver), on_status="ignore")
        pairs = zip(x, library.mass_matrix_inverse(x), statuses(library, x), strict=True)
        silent = [(one, found) for one, found, reported in pairs if not reported]
        errors = [error_in_wide_precision(system, *pair) for pair in silent]
        assert max(errors, default=0.0) <= LARGEST_ACCEPTED_ERROR * ROUNDOFF


def statuses(library: kg.Library, x: Floats) -> NDArray[np.bool_]:
    """Return for each of (B, m) states whether the inverse has a status."""
    found: list[bool] = []
    reporting = library.with_on_status(lambda report: found.__setitem__(-1, True))
    for one in x:
        found.append(False)
        reporting.mass_matrix_inverse(one)
    return np.array(found)


def error_in_wide_precision(system: kg.System, x: Floats, found: Floats) -> float:
    """Return the error of an inverse, compared with that of [A] in 320 bits."""
    n, number = len(system.freedoms), MULTIPRECISION.mpf
    (way,) = methods(system, ("mass_matrix",))
    lowered = lower(derive(system, way), ("mass_matrix",))
    elements = {array.name: [number(0)] * array.size for array in lowered.inputs}
    elements["x"] = [number(value) for value in x]
    (rows,) = evaluate(lowered, elements, MULTIPRECISION, number).values()
    exact = MULTIPRECISION.matrix(n, n)
    for i, value in enumerate(rows):
        exact[i // n, i % n] = value
    inverse = exact**-1
    expected = np.array([[float(inverse[i, j]) for j in range(n)] for i in range(n)])
    size = np.sqrt(np.diagonal(expected))
    return float(np.abs((found - expected) / size[:, None] / size).max())


def operations(system: kg.System) -> int:
    return sum(compile_module(system, (NAME,)).operations.values())


@pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")
@pytest.mark.parametrize(
    ("robot", "floating", "limit"),
    [
        ("ur5_robot", False, 360),
        ("panda", False, 890),
        pytest.param("talos_reduced", True, 17665, marks=pytest.mark.slow),
    ],
)
def test_operations_with_those_of_the_mass_matrix(robot: str, floating: bool, limit: int) -> None:
    assert operations(kg.load(robot_file(robot), floating_base=floating)) <= limit


def test_branches_cost_what_each_costs() -> None:
    """An entry costs what two freedoms have in common: nothing, for bodies that the ground carries."""
    one = bushes(1)
    two = replace(one, bodies=(*one.bodies, replace(one.bodies[0], name="other")))
    assert operations(two) == 2 * operations(one)
