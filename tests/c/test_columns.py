"""Derivatives of {ydot} in loops over columns, as C: the values and bits of straight-line code."""

from __future__ import annotations

from math import inf

import numpy as np
import pytest

import kanegen as kg
from benchmarks import models
from kanegen.c import target
from kanegen.lowering import solution_columns
from kanegen.options import Variant
from kanegen.program.ir import PARAMETERS, PREPARED
from kanegen.recursion.outputs import selection
from tests.support import random_trees
from tests.support.cases import slow_except
from tests.support.floating_trees import floating
from tests.support.orientation_trees import close
from tests.support.paths import MODELS

NAME = "forward_dynamics_derivatives"
STATES = 21
"""More than two vectors of states, and not a multiple of any."""


def built(system: kg.System, monkeypatch: pytest.MonkeyPatch, looped: int, variant: Variant) -> kg.Library:
    """Return the derivatives with loops from `looped` operations on."""
    monkeypatch.setattr(solution_columns, "LOOPED", looped)
    return kg.build(system, (NAME,), tier=variant)


def branched() -> kg.System:
    """Return hinges on a trunk with two branches, with a run-time parameter, a force element and loads."""
    rng = np.random.default_rng(3)
    count = 5
    free = np.eye(6, dtype=bool)[[0, 1, 2, 1, 0]]
    return kg.System.from_arrays(
        connection=[0, 1, 2, 1, 4],
        mass=[1.0, kg.Parameter("load", 2.0), 1.0, 1.5, 1.0],
        inertia=np.tile(np.diag([1.0, 1.2, 1.4]), (count, 1, 1)),
        mass_center=rng.uniform(-0.1, 0.1, (count, 3)),
        joint_position=rng.uniform(-0.3, 0.3, (count, 3)),
        free=free,
        loads=[False, True, False, False, False],
        name="branched",
    )


@pytest.mark.parametrize(
    "variant",
    [
        Variant(machine="portable"),
        pytest.param(Variant(machine="multiversioned"), marks=pytest.mark.slow),
        pytest.param(Variant(precision="float"), marks=pytest.mark.slow),
        pytest.param(Variant(precision="float", storage="double"), marks=pytest.mark.slow),
        pytest.param(Variant(precision="double-double"), marks=pytest.mark.slow),
        pytest.param(Variant(precision="long double"), marks=pytest.mark.slow),
    ],
    ids=lambda variant: f"{variant.precision} {variant.storage}".strip(),
)
@pytest.mark.parametrize(
    "longest", [0, pytest.param(inf, marks=pytest.mark.slow)], ids=["loops in batches", "straight batches"]
)
@pytest.mark.parametrize(
    "system",
    [branched(), pytest.param(floating(1, "angles"), marks=pytest.mark.slow)],
    ids=lambda one: one.name,
)
def test_loops_compute_what_straight_code_computes(
    system: kg.System, longest: float, variant: Variant, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And the lanes of a batch have the bits of one state, signs of zeros too, whichever computes them."""
    monkeypatch.setattr(target, "LONGEST_STRAIGHT", longest)
    loops, straight = (built(system, monkeypatch, looped, variant) for looped in (0, 10**9))
    code = "".join(loops.source.code.values())
    assert f"{NAME}_columns_1_1(" in code
    assert "columns_1_1(" not in "".join(straight.source.code.values())
    assert (f"{NAME}_simd_columns_1_1(" in code) == (longest == 0 and f"{NAME}_simd(" in code)
    x, y, tau = np.random.default_rng(5).uniform(-1, 1, (3, STATES, loops.n))
    x[:4], y[2:6], tau[4:8] = 0.0, 0.0, 0.0
    many, wanted = (one.forward_dynamics_derivatives(x, y, tau) for one in (loops, straight))
    close(many, wanted, 1e-3 if variant.precision == "float" else 1e-12)
    one = np.array([loops.forward_dynamics_derivatives(*state) for state in zip(x, y, tau, strict=True)])
    assert (one == many).all() and (np.signbit(one) == np.signbit(many)).all()


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
def test_random_trees(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """With force elements, loads, motors, rotors, couplings and parameters: C against instructions."""
    monkeypatch.setattr(random_trees, "ROTATIONS", ("two angles", "hinge", "none"))
    system = random_trees.everything(seed, bodies=3)
    loops, straight = (
        built(system, monkeypatch, looped, Variant(machine="portable")) for looped in (0, 10**9)
    )
    read = {array.name: array for function in loops.source.functions for array in function.inputs}
    rng = np.random.default_rng(seed)
    left_out = (PREPARED, PARAMETERS, "force", "torque", "point_force", "point_moment")
    inputs = {name: rng.uniform(-1, 1, (3, *read[name].shape)) for name in read if name not in left_out}
    found, wanted = (one.forward_dynamics_derivatives(**inputs) for one in (loops, straight))
    close(found, wanted, 1e-11)


@pytest.mark.parametrize("looped", [0, 10**9], ids=["loops", "straight"])
def test_where_the_solution_does_not_exist_all_elements_are_nan(
    looped: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A point mass on the axis of the first hinge, about which nothing has inertia."""
    system = kg.System.from_arrays(
        connection=[0, 1],
        mass=[0.0, 1.0],
        inertia=np.zeros((2, 3, 3)),
        mass_center=[[0, 0, 0], [0, 0, 1.0]],
        joint_position=np.zeros((2, 3)),
        free=np.eye(6, dtype=bool)[[2, 0]],
        name="on_axis",
    )
    library = built(system, monkeypatch, looped, Variant(machine="portable")).with_on_status("ignore")
    x = np.array([[0.3, 0.0], [0.3, 0.5]])
    found = library.forward_dynamics_derivatives(x, np.ones((2, 2)))
    assert np.isnan(found[0]).all() and np.isfinite(found[1]).all()
    assert np.isnan(library.forward_dynamics_derivatives(x[0], np.ones(2))).all()
    assert (library.forward_dynamics_derivatives(x[1], np.ones(2)) == found[1]).all()


@pytest.mark.parametrize("links", slow_except((8, 16, 24), 8))
@pytest.mark.slow
def test_code_is_linear_in_the_number_of_pairs_of_freedoms(
    links: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Straight lines are left for derivatives of inverse dynamics, so many lines for each pair."""
    monkeypatch.setattr(solution_columns, "LOOPED", 0)
    monkeypatch.setattr(selection, "may_cost_less", lambda system: False)
    source = kg.generate(models.revolute_chain(links), (NAME,), batches=False)
    lines = len(source.files[f"chain{links}.c"].splitlines())
    assert lines < 125 * links * (links + 1) / 2


def two_arms() -> kg.System:
    """Return two arms on the ground, whose rows stand among each other in the order of elimination."""
    return kg.System.from_arrays(
        connection=[0, 1, 2, 0, 4, 5],
        mass=np.ones(6),
        inertia=np.tile(np.diag([1.0, 1.2, 1.4]), (6, 1, 1)),
        mass_center=np.full((6, 3), 0.1),
        joint_position=np.full((6, 3), 0.3),
        free=np.eye(6, dtype=bool)[[0, 1, 2, 0, 1, 2]],
        name="two_arms",
    )


@pytest.mark.parametrize(
    "short", [0, pytest.param(12, marks=pytest.mark.slow)], ids=["rows in loops", "rows as statements"]
)
@pytest.mark.parametrize(
    "system", [two_arms(), kg.load(MODELS / "free_body.toml")], ids=lambda system: system.name
)
def test_columns_of_efforts_are_those_of_the_inverse(
    system: kg.System, short: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where elements vanish, between arms and between the components of one free body."""
    monkeypatch.setattr(solution_columns, "LOOPED", 0)
    monkeypatch.setattr(solution_columns, "SHORT", short)
    library = kg.build(system, (NAME, "mass_matrix"), tier=Variant(machine="portable"))
    x, y, tau = np.random.default_rng(2).uniform(-1, 1, (3, library.n))
    found = library.forward_dynamics_derivatives(x, y, tau)[:, library.derivative_columns(NAME)["tau"]]
    close(found, np.linalg.inv(library.mass_matrix(x)), 1e-12)
