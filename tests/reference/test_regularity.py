"""Systems whose [A] is singular in every state are refused by name; ill-conditioned ones pass."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from numpy.typing import NDArray

import kanegen as kg
from kanegen.errors import SingularError
from kanegen.model.coordinates import FREEDOMS
from kanegen.reference import equations as reference
from kanegen.reference.regularity import (
    VelocityRows,
    dependent_column,
    inertia_axes,
    massless_motions,
    require_regular,
)
from kanegen.reference.states import random_states
from tests.support import systems

Floats = NDArray[np.float64]

ONE, NONE = np.eye(3), np.zeros((3, 3))
EXAMPLES = settings(max_examples=60, deadline=None, derandomize=True)


def tree(
    connection: list[int], mass: list[float], inertia: list[Any], free: list[str], **more: Any
) -> kg.System:
    """Return bodies whose mass centres and joints lie at their origins.

    `free` has the names of the free freedoms of each body, separated by blanks.
    """
    bodies = len(connection)
    places: dict[str, Any] = {"mass_center": np.zeros((bodies, 3)), "joint_position": np.zeros((bodies, 3))}
    return kg.System.from_arrays(
        connection, mass, inertia, **{**places, **more},
        free=np.vstack([systems.flags(1, names.split()) for names in free]),
    )  # fmt: skip


def rod(axis: Floats) -> Floats:
    """Return the inertia of a thin rod along a unit vector, rounded as a rotated inertia is."""
    inertia: Floats = np.eye(3) - np.outer(axis, axis)
    return inertia


def rotated_rod(seed: int) -> Floats:
    """Return the inertia of a thin rod in a random direction."""
    rotation = systems.random_rotation(np.random.default_rng(seed))
    inertia = rotation @ np.diag([0.7, 0.7, 0.0]) @ rotation.T
    return (inertia + inertia.T) / 2


# Singular


def test_massless_leaf() -> None:
    system = tree([0, 1], [1.0, 0.0], [ONE, NONE], ["theta1", "theta2"])
    message = (
        r"body 'body2': freedom 'body2.theta2' moves neither mass nor inertia, so \[A\] is singular in every "
        r"state and has no inverse, which forward_dynamics would need\. Give 'body2' mass or inertia that "
        r"moves with it, or lock the freedom\.$"
    )
    with pytest.raises(SingularError, match=message):
        require_regular(system)


def test_the_outermost_freedom_without_mass_is_named() -> None:
    system = tree([0, 1, 2, 1], [1, 0, 0, 1], [ONE, NONE, NONE, ONE], ["theta1", "theta1 s2", "", "theta1"])
    with pytest.raises(SingularError, match=r"body 'body2': freedom 'body2.theta1' moves"):
        require_regular(system)


def test_every_freedom_without_mass_is_named() -> None:
    """Locking the named freedoms, and no fewer, leaves a regular [A]."""
    free = ["theta1", "theta1 s2", "theta2", "theta1"]
    system = tree([0, 1, 2, 1], [1, 0, 0, 1], [ONE, NONE, NONE, ONE], free)
    heads = [system.speed_names[motion[0]] for motion in massless_motions(system)]
    assert heads == ["body3.theta2", "body2.theta1", "body2.s2"]
    message = (
        r"freedom 'body3.theta2' moves .* The same holds for 'body2.theta1', 'body2.s2'\. Give their bodies"
    )
    with pytest.raises(SingularError, match=message):
        require_regular(system)
    require_regular(tree([0, 1, 2, 1], [1, 0, 0, 1], [ONE, NONE, NONE, ONE], ["theta1", "", "", "theta1"]))


def test_a_system_without_any_mass() -> None:
    bodies = 40
    system = tree([*range(bodies)], [0.0] * bodies, [NONE] * bodies, ["theta1"] * bodies)
    assert sorted(motion[0] for motion in massless_motions(system)) == [*range(bodies)]
    with pytest.raises(SingularError, match=r"'body28.theta1' and 27 further freedoms\. Give"):
        require_regular(system)


def test_joint_name_is_used() -> None:
    hinge = kg.Joint(free=(False, False, True, False, False, False), name="wrist_roll")
    hand = kg.Body("hand", 0, 1.0, ((1, 0, 0), (0, 1, 0), (0, 0, 0)), joint=hinge)
    with pytest.raises(SingularError, match=r"body 'hand': freedom 'wrist_roll' moves"):
        require_regular(kg.System("robot", (hand,)))


def test_point_mass_with_all_freedoms() -> None:
    with pytest.raises(SingularError, match=r"freedom 'body1.theta3' moves"):
        require_regular(tree([0], [1.0], [NONE], [" ".join(FREEDOMS)]))


@pytest.mark.parametrize("seed", range(8))
def test_point_mass_about_any_axis_through_it(seed: int) -> None:
    """Three angles can always turn about the line to the point, also where its position is rounded."""
    center = np.random.default_rng(seed).standard_normal((1, 3))
    with pytest.raises(
        SingularError, match=r"'body1.theta1' together with 'body1.theta3', 'body1.theta2' moves"
    ):
        require_regular(tree([0], [1.0], [NONE], ["theta1 theta2 theta3"], mass_center=center))


@pytest.mark.parametrize("seed", range(8))
def test_point_mass_welded_onto_an_axis(seed: int) -> None:
    """The hinge's axis passes through the mass only up to rounding."""
    turn = systems.random_rotation(np.random.default_rng(seed))
    offset = np.array([0.1, -0.2, 0.3])
    system = tree(
        [0, 1], [0.0, 1.0], [NONE, NONE], ["theta3", ""],
        joint_orientation=[ONE, turn], joint_position=[np.zeros(3), offset],
        mass_center=[np.zeros(3), turn @ (np.array([0.0, 0.0, 1.7]) - offset)],
    )  # fmt: skip
    with pytest.raises(SingularError, match=r"body 'body1': freedom 'body1.theta3' moves"):
        require_regular(system)


@pytest.mark.parametrize("seed", range(8))
def test_rod_about_its_own_axis(seed: int) -> None:
    inertia = rotated_rod(seed)
    with pytest.raises(SingularError, match=r"together with"):
        require_regular(tree([0], [1.0], [inertia], ["theta1 theta2 theta3"]))
    turn = systems.random_rotation(np.random.default_rng(seed))
    welded = tree([0, 1], [0.0, 1.0], [NONE, rod(turn[:, 2])], ["theta3", ""], joint_orientation=[ONE, turn])
    with pytest.raises(SingularError, match=r"body 'body1': freedom 'body1.theta3' moves"):
        require_regular(welded)


@pytest.mark.parametrize(
    ("free", "names"),
    [
        (["theta3", "theta3"], "'body1.theta3' together with 'body2.theta3'"),
        (["s1", "s1"], "'body1.s1' together with 'body2.s1'"),
        (["s1 theta3", "s1 s2"], "'body1.s1' together with 'body2.s2', 'body2.s1'"),
    ],
)
def test_freedoms_that_undo_each_other(free: list[str], names: str) -> None:
    system = tree([0, 1], [0.0, 1.0], [NONE, ONE], free)
    with pytest.raises(SingularError, match=f"body 'body1': freedom {names} moves"):
        require_regular(system)


def test_angles_locked_in_gimbal_lock() -> None:
    system = tree([0], [1.0], [ONE], ["theta1 theta3"], locked=[[0, np.pi / 2, 0, 0, 0, 0]])
    with pytest.raises(SingularError, match=r"'body1.theta1' together with 'body1.theta3'"):
        require_regular(system)


# Regular


@EXAMPLES
@given(systems.systems())
def test_generic_systems_pass(system: kg.System) -> None:
    require_regular(system)


@EXAMPLES
@given(systems.systems(max_bodies=6))
def test_the_decision_is_that_of_the_mass_matrix(system: kg.System) -> None:
    """With every other body emptied, [A] is clearly singular or clearly regular in several states."""
    arrays = system.values()
    keep = np.arange(len(arrays.mass)) % 2 == 0
    inertia = arrays.inertia * keep[:, None, None]
    emptied = systems.from_values(replace(arrays, mass=arrays.mass * keep, inertia=inertia))
    a = reference.mass_matrix(emptied, random_states(emptied, 5, seed=9).x)
    scale = np.sqrt(np.where(np.einsum("bii->bi", a) > 0, np.einsum("bii->bi", a), 1.0))
    smallest = np.linalg.eigvalsh(a / scale[:, :, None] / scale[:, None, :])[:, 0]
    singular = bool((np.abs(smallest) < 1e-13).all())
    assert singular or smallest.max() > 1e-11
    if singular:
        with pytest.raises(SingularError, match=r"moves neither mass nor inertia"):
            require_regular(emptied)
    else:
        require_regular(emptied)


@pytest.mark.parametrize("ratio", [1e-30, 1e-12, 1e12, 1e30])
@pytest.mark.parametrize("free", [FREEDOMS, ("theta3",), ("theta1", "theta2", "s3")])
def test_mass_ratios_pass(ratio: float, free: tuple[str, ...]) -> None:
    arrays, factor = systems.chain(4, free).values(), ratio ** np.arange(4)
    inertia = arrays.inertia * factor[:, None, None]
    require_regular(systems.from_values(replace(arrays, mass=arrays.mass * factor, inertia=inertia)))


@pytest.mark.parametrize("sizes", [(1e3, 1.0, 1e-6), (1e-6, 1.0, 1e3), (1e30,) * 3, (1e-30,) * 3])
@pytest.mark.parametrize("free", [FREEDOMS, ("theta2",)])
def test_cranes_and_grippers_pass(sizes: tuple[float, ...], free: tuple[str, ...]) -> None:
    arrays, size = systems.chain(3, free).values(), np.array(sizes)
    system = replace(
        arrays,
        mass=arrays.mass * size**3,
        inertia=arrays.inertia * (size**5)[:, None, None],
        mass_center=arrays.mass_center * size[:, None],
        joint_position=arrays.joint_position * np.array([[1.0], [sizes[0]], [sizes[1]]]),
        locked=np.zeros((3, 6)),
    )
    require_regular(systems.from_values(system))


@pytest.mark.parametrize("size", [1e-200, 1e200])
def test_lengths_may_have_any_exponent(size: float) -> None:
    system = tree([0, 1], [1.0, 1.0], [NONE, NONE], ["theta1", "theta1"], mass_center=size * ONE[1:])
    require_regular(system)


def test_small_and_thin_things_pass() -> None:
    require_regular(
        tree([0], [1e-9], [ONE * 1e-18], ["theta3"], mass_center=[[1e-4, 0, 0]])  # a micro-gram hinge
    )
    require_regular(tree([0], [0.0], [ONE * 1e-30], ["theta1"]))
    require_regular(tree([0], [1.0], [np.diag([1.0, 1.0, 1e-20])], ["theta3"]))  # thin, but not zero
    require_regular(tree([0], [1.0], [NONE], ["s1 s2 s3"]))
    require_regular(tree([0], [1.0], [NONE], ["theta1 theta2"], mass_center=[[0, 0, -1]]))
    require_regular(tree([0], [1.0], [rod(np.array([0.0, 0.0, 1.0]))], ["theta1 theta2"]))


def test_massless_bodies_between_massive_ones_pass() -> None:
    gimbal = tree([0, 1, 2], [0, 0, 1], [NONE, NONE, ONE], ["theta1", "theta2", "theta3"])
    require_regular(gimbal)
    coaxial = tree([0, 1], [1e-12, 1.0], [ONE * 1e-12, ONE], ["theta3", "theta3"])
    require_regular(coaxial)


@pytest.mark.parametrize("seed", range(5))
def test_the_first_dependent_column_and_those_it_depends_on(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rows = rng.normal(size=(9, 6))
    rows[:, 4] = rows[:, :4] @ np.array([2.0, 0.0, -3.0, 0.5])
    assert dependent_column(VelocityRows(rows, np.linalg.norm(rows, axis=0))) == [4, 0, 2, 3]
    rows[:, 4] += 1e-3 * rng.normal(size=9)
    assert dependent_column(VelocityRows(rows, np.linalg.norm(rows, axis=0))) == []


def test_axes_of_inertia() -> None:
    assert inertia_axes(NONE).shape == (0, 3)
    assert inertia_axes(ONE).shape == (3, 3)
    np.testing.assert_array_equal(np.abs(inertia_axes(np.diag([0.0, 1e-20, 1.0]))), np.eye(3)[1:])
    blocks = np.array([[1.0, 0, 0.3], [0, 1e-20, 0], [0.3, 0, 1.0]])
    assert inertia_axes(blocks).shape == (3, 3)
    for seed in range(20):
        axes, inertia = inertia_axes(rotated_rod(seed)), rotated_rod(seed)
        assert axes.shape == (2, 3)
        np.testing.assert_allclose(axes @ inertia, 0.7 * axes, atol=1e-15)
