"""The points about which fixed-frame columns of [A] stay: no others cost less, and no digits are lost."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.measure.comparison import compare
from kanegen.model.coordinates import FREEDOMS
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import Program
from kanegen.recursion import fixed_frame_columns
from kanegen.recursion.fixed_frame_choice import FixedFrameChoice, choose, kept_points
from kanegen.recursion.tree import Tree, tree
from tests.support import systems
from tests.support.chains import hinges
from tests.support.couplings import permanent_name


def mixed_chain(seed: int, bodies: int) -> kg.System:
    """Return a chain of hinges, sliders, gimbals and joints without length."""
    rng = np.random.default_rng(seed)
    kinds = [FREEDOMS[2:3], FREEDOMS[:1], FREEDOMS[1:2], FREEDOMS[3:4], FREEDOMS[:2], FREEDOMS[:3]]
    chances = [0.3, 0.3, 0.2, 0.1, 0.05, 0.05]
    free = np.concatenate([systems.flags(1, kinds[rng.choice(6, p=chances)]) for _ in range(bodies)])
    made = systems.random_system(rng, bodies, connection=range(bodies), free=free, loads=False, locked=False)
    without = [
        replace(body, joint=replace(body.joint, position=(0, 0, 0))) if rng.random() < 0.3 else body
        for body in made.bodies
    ]
    return replace(made, bodies=tuple(without))


def operations(prepared: Tree, stations: set[int]) -> int:
    """Count what columns cost in the fixed frame, from the last body of a chain inward, column by column.

    Args:
        prepared: A chain.
        stations: Numbers of the bodies where all columns shift to O_K.
    """
    n = len(prepared.joints)
    rotations = {joint.body: len(joint.rotations) for joint in prepared.joints}
    has_arm = {joint.body: joint.arm != (0, 0, 0) for joint in prepared.joints}
    columns: Counter[int] = Counter()
    total, last = 0, n
    for k in range(n - 1, 0, -1):
        arriving, columns = columns, Counter({k: rotations[k + 1]})
        for point, count in arriving.items():
            if point == last and k not in stations:
                total += count * 11 * rotations[k]
                columns[point] += count
            else:
                shift = 12 if any(has_arm[i] for i in range(k + 1, point + 1)) else 0
                total += count * (shift + 5 * rotations[k])
                columns[k] += count
        if k in stations or k == n - 1:
            last = k
        else:
            total += 9 * rotations[k] + 3
    return total


@pytest.mark.parametrize("seed", range(6))
def test_no_other_stations_cost_less(seed: int) -> None:
    """All sets of stations are counted, by a count that follows every column."""
    prepared = tree(mixed_chain(seed, 9))
    every = range(1, len(prepared.joints))
    kept, saved = kept_points(prepared, every)
    found = operations(prepared, {k for k in every if k not in kept})
    assert saved == operations(prepared, set(every)) - found
    sets = (set(chosen) for count in range(len(every)) for chosen in combinations(every[:-1], count))
    assert found == min(operations(prepared, {*chosen, every[-1]}) for chosen in sets)


def test_columns_of_long_chains_stay_about_points() -> None:
    """Most columns pass most joints of a long chain without a shift; a short one is not worth a basis."""
    assert choose(tree(hinges(12))) == FixedFrameChoice()
    choice = choose(tree(hinges(64)))
    assert choice.bodies == set(range(1, len(choice.bodies) + 1))
    assert len(choice.bodies) > 48
    assert len(choice.kept) > 0.75 * len(choice.bodies)
    assert all(k < kept for k, kept in choice.kept.items())


def test_points_stay_on_the_path_where_branches_meet() -> None:
    """Where branches meet, all columns shift to one point."""
    chain = hinges(100)
    lower = [*range(50), 8, *range(51, 100)]
    bodies = tuple(replace(body, lower=j) for body, j in zip(chain.bodies, lower, strict=True))
    system = replace(chain, bodies=bodies)
    prepared = tree(system)
    kept = choose(prepared).kept
    assert 8 not in kept
    assert kept.keys() & set(range(1, 8))
    assert kept.keys() & set(range(9, 51))
    assert kept.keys() & set(range(51, 101))
    for k, outward in kept.items():
        assert k in {joint.body for joint in prepared.inward(prepared.joints[outward - 1])}


def test_coupled_columns_meet_about_one_point() -> None:
    """Columns that one entry of {y} causes are added up, which needs one point for all of them."""
    chain = hinges(48)
    first, *_, last = (permanent_name(chain, freedom) for freedom in chain.freedoms)
    coupled = replace(chain, couplings=(kg.Coupling(last, {first: 0.5}),))
    assert choose(tree(chain)).kept
    assert not choose(tree(coupled)).kept


class Evaluated:
    """[A] by a program that NumPy evaluates, as `compare` calls it."""

    outputs = ("mass_matrix",)

    def __init__(self, program: Program) -> None:
        self._program = program

    def mass_matrix(self, x: np.ndarray, **_: np.ndarray) -> np.ndarray:
        found = evaluate(self._program, {"x": list(x.T)}, np)["A"]
        n = round(len(found) ** 0.5)
        rows = [np.broadcast_to(value, len(x)) for value in found]
        return np.stack(rows, axis=-1).reshape(-1, n, n)


@pytest.mark.parametrize("long", [6, 14])
def test_a_distant_point_on_the_axis_of_a_hinge_costs_no_digits(
    long: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One link is 10^6 times as long as the others.

    Where its joint has an axis of the lower body, `JointMotion.origin` is as far from the hinge, along it.
    """
    chain = hinges(20)
    body = chain.bodies[long]
    joint = replace(body.joint, position=tuple(1e6 * value for value in body.joint.position))
    bodies = (*chain.bodies[:long], replace(body, joint=joint), *chain.bodies[long + 1 :])
    system = replace(chain, bodies=bodies)
    bodies_inward = frozenset(range(1, 17))
    kept, _ = kept_points(tree(system), bodies_inward)
    assert kept
    choice = FixedFrameChoice(bodies_inward, kept)
    monkeypatch.setattr(fixed_frame_columns, "choose", lambda _: choice)
    library = Evaluated(compile_module(system, ("mass_matrix",)).module.functions["mass_matrix"])
    report = compare(system, library, states=20)  # type: ignore[arg-type]
    assert report.passed, str(report)
