"""Columns of [A] shifted, by force combinations and in a fixed frame: the same entries, fewer operations."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.model.coordinates import FREEDOMS
from kanegen.program.evaluate import evaluate
from kanegen.recursion import columns, fixed_frame_columns
from kanegen.recursion.fixed_frame_choice import FixedFrameChoice, bodies_that_save, choose
from kanegen.recursion.tree import Tree, tree
from kanegen.reference import equations as reference
from tests.support import systems
from tests.support.cases import slow_among

OUTPUTS = ("mass_matrix",)
BINARY = (0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7)
"""A tree of fifteen bodies."""


def joints(bodies: int, free: Iterable[str], *, orientations: bool = False) -> kg.System:
    """A chain, the same freedoms free at every joint."""
    rng = np.random.default_rng(1)
    return systems.random_system(
        rng, bodies, connection=range(bodies), free=systems.flags(bodies, free), loads=False,
        orientations=orientations, locked=False,
    )  # fmt: skip


def mixed(seed: int, bodies: int = 7) -> kg.System:
    """A deep tree with any freedoms."""
    rng = np.random.default_rng(seed)
    connection = (0, *(int(rng.integers(max(0, k - 2), k)) + 1 for k in range(1, bodies)))
    return systems.random_system(rng, bodies, connection=connection, loads=False)


MODELS = {
    "tilted hinges": lambda: joints(6, ["theta3"], orientations=True),
    "gimbals": lambda: joints(6, FREEDOMS[:3]),
    "tilted gimbals": lambda: joints(4, FREEDOMS[:3], orientations=True),
    "free bodies": lambda: joints(4, FREEDOMS),
    "cylinders": lambda: joints(5, ["theta1", "theta3", "s2"]),
    "sliders": lambda: joints(4, ["theta2", "s1", "s2", "s3"]),
    "mixed 0": lambda: mixed(0),
    "mixed 1": lambda: mixed(1),
}


def error(system: kg.System, seed: int = 0) -> float:
    """The greatest error of an entry, relative to the diagonal entries beside it."""
    n = len(system.freedoms)
    x = np.random.default_rng(seed).normal(size=n)
    module = compile_module(system, OUTPUTS).module
    found = np.reshape(evaluate(module.functions["mass_matrix"], {"x": x}, np)["A"], (n, n))
    expected = reference.mass_matrix(system, x)
    scale = np.sqrt(np.diag(expected))
    return float(np.abs((found - expected) / np.outer(scale, scale)).max())


def cost(system: kg.System) -> int:
    return sum(compile_module(system, OUTPUTS).operations.values())


def all_bodies(prepared: Tree) -> FixedFrameChoice:
    return FixedFrameChoice(frozenset(joint.body for joint in prepared.joints))


def no_bodies(prepared: Tree) -> FixedFrameChoice:
    return FixedFrameChoice()


def some_bodies(prepared: Tree) -> FixedFrameChoice:
    """A random part of the bodies, with all that is inward of them; many columns stay about other points."""
    rng = np.random.default_rng(len(prepared.joints))
    picked = {joint.body: bool(rng.random() < 0.8) for joint in prepared.joints}
    bodies = [joint.body for joint in prepared.joints if all(picked[j.body] for j in prepared.inward(joint))]
    kept: dict[int, int] = {}
    for k in reversed(bodies):
        j = prepared.joints[k - 1].lower
        if j and rng.random() < 0.9:
            kept[j] = kept[k] if k in kept and rng.random() < 0.7 else k
    return FixedFrameChoice(frozenset(bodies), kept)


@pytest.mark.parametrize("choice", [choose, all_bodies, some_bodies])
@pytest.mark.parametrize("name", slow_among(MODELS, "mixed 0", "gimbals", "tilted gimbals"))
def test_the_frame_of_a_column_does_not_matter(
    name: str, choice: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fixed_frame_columns, "choose", choice)
    assert error(MODELS[name]()) <= 1e-14


@pytest.mark.parametrize("name", slow_among(MODELS, "mixed 0", "mixed 1"))
def test_each_way_saves_operations_where_it_is_taken(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    system = MODELS[name]()
    chosen = choose(tree(system)).bodies
    with_all = cost(system)
    monkeypatch.setattr(fixed_frame_columns, "choose", no_bodies)
    without_fixed_frame = cost(system)
    assert with_all < without_fixed_frame if chosen else with_all == without_fixed_frame
    monkeypatch.setattr(columns, "_shift_saves", lambda *_: False)
    without_shifts = cost(system)
    monkeypatch.setattr(columns, "_combination_cost", lambda _: 10**6)
    assert without_fixed_frame <= without_shifts <= cost(system)


def test_columns_change_to_the_fixed_frame_where_this_saves() -> None:
    """Long chains of gimbals do up to the last but one body, hinges and free bodies do not."""
    assert bodies_that_save(tree(joints(10, FREEDOMS[:3]))) == set(range(1, 9))
    assert bodies_that_save(tree(joints(3, FREEDOMS[:3]))) == set()
    assert bodies_that_save(tree(joints(20, ["theta3"]))) == set()
    assert bodies_that_save(tree(joints(10, FREEDOMS))) == set()


def test_the_lower_body_of_a_chosen_body_is_chosen() -> None:
    free = systems.flags(15, FREEDOMS[:3])
    binary = systems.random_system(np.random.default_rng(2), 15, connection=BINARY, free=free)
    for system in (binary, *(mixed(seed, bodies=14) for seed in range(3))):
        chosen = bodies_that_save(tree(system))
        assert chosen
        assert {system.connection[k - 1] for k in chosen} <= chosen | {0}


def test_every_tree_on_the_ground_has_its_own_choice() -> None:
    """A second tree beside a chain of gimbals changes nothing for it."""
    one = joints(6, FREEDOMS[:3])
    hinge = replace(joints(1, ["theta3"]).bodies[0], name="alone")
    both = kg.System("both", (*one.bodies, hinge))
    assert bodies_that_save(tree(both)) == bodies_that_save(tree(one)) != set()
    assert error(both) <= 1e-14


def test_masses_as_parameters_reach_shifts_and_force_combinations() -> None:
    """Shares hold a reciprocal mass, which `prepare` takes."""
    numbers = joints(3, FREEDOMS)
    bodies = tuple(
        replace(body, mass=kg.Parameter(f"m{k}", body.mass)) for k, body in enumerate(numbers.bodies)
    )
    operations = compile_module(kg.System("named", bodies), OUTPUTS).operations
    assert operations["divide"] == 0 < operations["prepare"]
