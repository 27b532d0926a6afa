"""Systems whose [A] is singular in every state: whatever does not solve with [A] has its values.

[A], {f}, efforts and energies are linear in masses and inertias, and motions do not depend on them. So the
results of a tree, with and without any mass, say what they are for parts of its masses.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.lowering.accept import accept
from kanegen.measure.comparison import compare
from kanegen.model.body import Body
from kanegen.model.numbers import value_of
from kanegen.options import STRICT
from kanegen.recursion.outputs import (
    DERIVATIVES,
    EQUATIONS,
    OUTPUTS,
    PRODUCTS,
    SECOND_DERIVATIVES,
    available,
    solving,
)
from kanegen.reference.regularity import massless_motions
from tests.support import random_trees, systems
from tests.support.cases import slow_except
from tests.support.programs import values
from tests.support.robots import REFUSED, robot_file, robot_files

SEEDS = slow_except(range(24), 1)
NONE = ((0.0, 0.0, 0.0),) * 3

LINEAR = (
    "A", "f", "generalized_force", "reaction_loads", "kinetic_energy", "potential_energy",
)  # fmt: skip
"""Arrays that are linear in masses and inertias."""

SLOPES = ("forcing_derivatives", "inverse_dynamics_derivatives")
"""Derivatives that are, too."""

MOTIONS = (
    "body_poses",
    "xdot",
    "point_positions",
    "point_velocities",
    "point_accelerations",
    "point_jacobians",
)
"""Arrays that do not depend on masses and inertias."""


def without_motors(system: kg.System) -> kg.System:
    """Return the system without rotors and their inertias, which move without any mass of bodies."""
    bodies = tuple(replace(of, joint=replace(of.joint, armature=(0.0,) * 6)) for of in system.bodies)
    return replace(system, bodies=bodies, rotors=())


def with_masses_of(system: kg.System, keep: Callable[[int], bool]) -> kg.System:
    """Return the system with the masses of those bodies alone whose number `keep` accepts."""

    def body(k: int, of: Body) -> Body:
        return of if keep(k) else replace(of, mass=0.0, inertia=NONE)

    bodies = tuple(body(k, of) for k, of in enumerate(system.bodies, start=1))
    return replace(system, bodies=bodies)


def results(system: kg.System, seed: int, compared: tuple[str, ...]) -> dict[str, Any]:
    """Return the outputs with arrays `compared`, in a state that depends on the seed alone."""
    rng = np.random.default_rng(seed)
    n = len(system.freedoms)
    given: dict[str, Any] = {"x": rng.uniform(-1, 1, len(system.coordinates)), "t": [0.4]}
    given |= {name: rng.normal(size=n) for name in ("y", "ydot")}
    given |= {name: rng.normal(size=(system.number_of_bodies, 3)) for name in ("force", "torque")}
    given |= {name: rng.normal(size=(len(system.points), 3)) for name in ("point_force", "point_moment")}
    given["parameters"] = [parameter.value for parameter in system.parameters]
    names = tuple(name for name in available(system) if OUTPUTS[name].array(system).name in compared)
    return values(system, names, given)


@pytest.mark.parametrize(
    "linear", [LINEAR, pytest.param((*LINEAR, *SLOPES), marks=pytest.mark.slow)], ids=["values", "slopes"]
)
@pytest.mark.parametrize("seed", SEEDS)
def test_outputs_are_those_of_the_masses(seed: int, linear: tuple[str, ...]) -> None:
    """The numbers of a tree are those of its even and of its odd bodies, less those without mass."""
    tree = without_motors(random_trees.everything(seed)).map_numbers(value_of)
    whole, even, odd, none = (
        results(with_masses_of(tree, keep), seed, (*linear, *MOTIONS, "momentum"))
        for keep in (lambda k: True, lambda k: k % 2 == 0, lambda k: k % 2 == 1, lambda k: False)
    )
    assert set(linear) <= set(whole) and set(MOTIONS) <= set(whole)
    for name in linear:
        size = max(np.abs(found[name]).max() for found in (whole, even, odd, none))
        difference = np.abs(even[name] + odd[name] - none[name] - whole[name]).max()
        assert difference <= 1e-11 * size, name
    for name in MOTIONS:
        for found in (even, odd, none):
            assert np.abs(found[name] - whole[name]).max() <= 1e-13 * np.abs(whole[name]).max(), name
    assert not none["A"].any()
    assert not none["kinetic_energy"].any()
    assert not none["momentum"].any()


@pytest.mark.parametrize("seed", slow_except(range(8), 0))
def test_c_agrees_with_the_reference(seed: int) -> None:
    tree = without_motors(random_trees.everything(seed))
    for keep in (lambda k: k == 1, lambda k: False):
        system = with_masses_of(tree, keep)
        report = compare(system, kg.build(system), states=50)
        assert report.passed, str(report)


def test_what_solves_is_refused_and_nothing_else() -> None:
    """Every output of the table either refuses, because it solves with [A], or is generated.

    Derivatives, of which generation takes long, are only accepted.
    """
    system = with_masses_of(systems.chain(3, ["theta1", "theta2", "s2"]), lambda k: k < 3)
    system = system.with_points({"tip": (3, (0, 0, 0.1))}).with_prescribed("body2.s2").with_poses(["body3"])
    system = system.with_contacts(kg.Contact(point="tip", directions="force1"))
    assert massless_motions(system)
    names = available(system)
    assert set(names) == set(OUTPUTS)
    for name in names:
        if solving([name]):
            with pytest.raises(kg.SingularError, match=f"no inverse, which {name} would need"):
                kg.generate(system, name)
        elif name in (*DERIVATIVES, *PRODUCTS, *SECOND_DERIVATIVES):
            assert accept(system, [name], STRICT).outputs == (name,)
        else:
            assert kg.generate(system, name).outputs == (name,)


@pytest.mark.parametrize("name", slow_except(["ur5_robot", "panda", "solo12", "talos_left_arm"], "ur5_robot"))
def test_robots_without_inertials(name: str, tmp_path: Path) -> None:
    """A file without `<inertial>` moves as the same file with it, and its [A] and {f} are zero."""
    whole = robot_file(name)
    path = tmp_path / "bare.urdf"
    path.write_text(re.sub(r"<inertial>.*?</inertial>", "", whole.read_text(), flags=re.DOTALL))
    outputs = (*EQUATIONS, "body_poses", "momentum")
    bare, robot = (kg.build(kg.load(file), outputs) for file in (path, whole))
    x, y = np.random.default_rng(3).uniform(-2, 2, (2, robot.n))
    np.testing.assert_array_equal(bare.body_poses(x), robot.body_poses(x))
    assert not bare.mass_matrix(x).any()
    assert not bare.forcing(x, y).any()
    assert not bare.momentum(x, y).any()


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")
@pytest.mark.parametrize(
    "path", [path for path in robot_files() if path.stem not in REFUSED], ids=lambda path: path.stem
)
def test_real_robots_have_all_that_does_not_solve(path: Path) -> None:
    """Outputs that are derivatives are left out: deriving those of a large robot takes minutes."""
    system = kg.load(path)
    names = tuple(name for name in available(system) if not solving([name]) and name not in DERIVATIVES)
    assert set(EQUATIONS) < set(names)
    assert compile_module(system, names).module.together.outputs
