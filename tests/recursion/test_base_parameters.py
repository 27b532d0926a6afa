"""Base parameters: their number against ranks and publications, and that they reproduce every effort."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.model.coordinates import FREEDOMS
from kanegen.reference.regressor import regressor
from tests.support import prescribed_trees, random_trees, systems
from tests.support.cases import slow_except
from tests.support.command import kanegen
from tests.support.high_precision import exact, exact_system
from tests.support.orientation_trees import close
from tests.support.paths import PENDULUM, ROOT
from tests.support.programs import values
from tests.support.robots import robot_file

PUMA = ROOT / "benchmarks" / "validation" / "models" / "puma560.toml"

HINGE, SLIDE = ((False,) * 2 + (True,) + (False,) * 3, (False,) * 3 + (True,) + (False,) * 2)

UNIT = ((1, 0, 0), (0, 1, 0), (0, 0, 1))

EXPRESSION = """name = "tree"
gravity = [0, 0, -9.81]
[parameters]
l = {default}
[[body]]
name = "a"
connection = "ground"
mass = 2.0
inertia = [0.1, 0.2, 0.3]
joint.free = ["theta3"]
[[body]]
name = "b"
connection = "a"
mass = 1.5
inertia = [0.15, 0.2, 0.3]
joint.free = ["theta3"]
{place}
"""

GAP = 1e6
"""Least ratio of the smallest singular value that counts to the largest one that does not: rounding leaves
1e-15, and generic trees of this size have no singular value below 1e-6."""


def upright_puma() -> kg.System:
    """Return Puma 560 as published; the inertia of its third link is one that no real body has."""
    with pytest.warns(kg.KanegenWarning, match="violate the triangle inequality"):
        return kg.load(PUMA)


def motions(system: kg.System, seed: int, count: int) -> dict[str, Any]:
    """Return many states of a system, with the motion of what is prescribed."""
    rng, n = np.random.default_rng(seed), len(system.freedoms)
    found: dict[str, Any] = {name: rng.normal(size=(count, n)) for name in ("y", "ydot")}
    found["x"] = rng.uniform(-1.5, 1.5, (count, len(system.coordinates)))
    if system.prescribed:
        found["prescribed"] = rng.normal(size=(count, 3, len(system.prescribed)))
    return found


def rows(system: kg.System, seed: int = 0) -> np.ndarray:
    """Return the regressor of many states by the reference, on top of each other."""
    count = 10 + 30 * system.number_of_bodies // len(system.freedoms)
    stacked = regressor(system, **motions(system, seed, count))
    found: np.ndarray = stacked.reshape(-1, stacked.shape[-1])
    return found


def rank(matrix: np.ndarray) -> int:
    """Return the rank of a matrix, whose singular values must leave a gap at rounding errors."""
    sizes = np.linalg.norm(matrix, axis=0)
    kept = matrix[:, sizes > 1e-12 * sizes.max()]
    singular = np.linalg.svd(kept / np.linalg.norm(kept, axis=0), compute_uv=False)
    count = int((singular > 1e-9 * singular[0]).sum())
    rest = singular[count] if count < len(singular) else 0.0
    assert rest * GAP < singular[count - 1]
    return count


def agrees(system: kg.System, seed: int = 0) -> kg.BaseParameters:
    """Make sure that base parameters are as many as the rank, and give the same efforts."""
    base, every = kg.base_parameters(system), rows(system, seed)
    close(every[:, base.columns] @ base.matrix, every, 1e-11)
    assert len(base) == rank(every)
    assert np.array_equal(base.matrix[:, base.columns], np.eye(len(base)))
    return base


@pytest.mark.parametrize("seed", slow_except(range(40), *range(6)))
def test_random_trees(seed: int) -> None:
    """Any freedoms free, also slides that are followed by hinges, and branches on the ground."""
    assert agrees(systems.random_system(np.random.default_rng(seed), 4, loads=False)).is_proven


@pytest.mark.parametrize("seed", slow_except(range(30), 0))
def test_trees_with_everything(seed: int) -> None:
    """Quaternions, frames of bodies for their users, parameters; couplings in trees of odd seeds."""
    system = random_trees.everything(seed, 3)
    assert agrees(system).is_proven == (not system.couplings)


@pytest.mark.parametrize("kind", prescribed_trees.KINDS)
def test_prescribed_motion(kind: str) -> None:
    for seed in range(2):
        agrees(prescribed_trees.tree(kind, seed))


@pytest.mark.parametrize(
    "free",
    [
        ("theta1",),
        ("s1",),
        ("s1", "theta1"),
        ("s2", "theta1"),
        ("theta1", "theta3"),
        ("s1", "s2", "s3"),
        FREEDOMS,
    ],
)
def test_special_geometries(free: tuple[str, ...]) -> None:
    """Parallel, perpendicular and intersecting axes, with gravity along an axis, across it, and none."""
    for gravity in ((0.0, 0.0, -9.81), (-9.81, 0.0, 0.0), (0.0, 0.0, 0.0)):
        for orientations in (False, True):
            for size in (0.0, 1.0):
                system = systems.random_system(
                    np.random.default_rng(3), 3, connection=(0, 1, 2), free=systems.flags(3, free),
                    orientations=orientations, locked=False, gravity=gravity, loads=False,
                )  # fmt: skip
                joints = (
                    replace(body.joint, position=tuple(size * value for value in body.joint.position))
                    for body in system.bodies
                )
                pairs = zip(system.bodies, joints, strict=True)
                bodies = tuple(replace(body, joint=joint) for body, joint in pairs)
                agrees(replace(system, bodies=bodies))


def joined(*joints: tuple[int, str], **more: Any) -> kg.System:
    """Return a tree with a body for each joint: the number of its lower body and the name of its freedom."""
    count, names = len(joints), [name for _, name in joints]
    return systems.random_system(
        np.random.default_rng(5), count, connection=[lower for lower, _ in joints],
        free=np.array([[name == freedom for freedom in FREEDOMS] for name in names]),
        orientations=False, locked=False, loads=False, gravity=(0.0, 0.0, -9.81), **more,
    )  # fmt: skip


def test_a_first_moment_that_only_a_mean_shows() -> None:
    """A slide along the axis of a hinge changes Ixx + Iyy of what it carries, and thereby shows its mz."""
    system = joined((0, "theta1"), (1, "theta3"), (2, "s3"))
    bodies = (replace(body, joint=replace(body.joint, position=(0, 0, 0))) for body in system.bodies)
    base = agrees(replace(system, bodies=tuple(bodies)))
    assert {"m_3", "mx_3", "my_3", "mz_3"} <= {base.parameters[column] for column in base.columns}


@pytest.mark.parametrize("factor", [1.0, -0.4, 2.5])
def test_couplings_leave_fewer(factor: float) -> None:
    """Two slides of a hand along one axis that follow each other, and hinges in different branches."""
    fingers = joined((0, "theta1"), (1, "theta3"), (2, "s2"), (2, "s2"))
    coupled = fingers.with_couplings(kg.Coupling("body4.s2", {"body3.s2": factor}, 0.1))
    assert len(agrees(coupled)) < len(agrees(fingers))
    legs = joined((0, "theta1"), (1, "theta1"), (0, "theta1"), (3, "theta1"))
    agrees(legs.with_couplings(kg.Coupling("body3.theta1", {"body1.theta1": factor})))


def test_published_numbers() -> None:
    """Puma 560 has 36 (Mayeda, Yoshida and Osuka 1990), an arm like Panda's 43 (Gaz et al. 2019).

    Both stand upright. With gravity across the first axis, its first moments count, too.
    """
    puma = upright_puma()
    assert len(kg.base_parameters(puma)) == 36
    assert len(kg.base_parameters(replace(puma, gravity=(9.81, 0.0, 0.0)))) == 38
    with pytest.warns(kg.KanegenWarning):
        panda = kg.load(robot_file("panda"))
    arm = panda.with_locked({"panda_finger_joint1": 0.0})
    assert len(kg.base_parameters(arm)) == 43
    assert len(kg.base_parameters(replace(arm, gravity=(9.81, 0.0, 0.0)))) == 45


PANDA = """
Izz_1 + Iyy_2
mx_2
my_2 - mz_3 - 0.316 m_34567
Ixx_2 - Iyy_2 + Iyy_3 + 0.632 mz_3 + 0.099856 m_3 + 0.10666225 m_4567
Ixy_2
Ixz_2
Iyz_2
Izz_2 + Iyy_3 + 0.632 mz_3 + 0.099856 m_3 + 0.10666225 m_4567
mx_3 + 0.0825 m_4567
my_3 - mz_4
Ixx_3 - Iyy_3 + Iyy_4 - 0.00680625 m_4
Ixy_3 + 0.0825 mz_4
Ixz_3
Iyz_3
Izz_3 + Iyy_4 + 0.00680625 m_4 + 0.0136125 m_567
mx_4 - 0.0825 m_567
my_4 + mz_5 + 0.384 m_567
Ixx_4 - Iyy_4 + Iyy_5 + 0.768 mz_5 + 0.14064975 m_567
Ixy_4 + 0.0825 mz_5 + 0.03168 m_567
Ixz_4
Iyz_4
Izz_4 + Iyy_5 + 0.768 mz_5 + 0.15426225 m_567
mx_5
my_5 - mz_6
Ixx_5 - Iyy_5 + Iyy_6 + 0.007744 m_7
Ixy_5
Ixz_5
Iyz_5
Izz_5 + Iyy_6 + 0.007744 m_7
mx_6 + 0.088 m_7
my_6 - mz_7
Ixx_6 - Iyy_6 + Iyy_7 - 0.007744 m_7
Ixy_6 + 0.088 mz_7
Ixz_6
Iyz_6
Izz_6 + Iyy_7 + 0.007744 m_7
mx_7
my_7
Ixx_7 - Iyy_7
Ixy_7
Ixz_7
Iyz_7
Izz_7
"""
"""The 43 coefficients of Panda without friction, from the code beside Gaz and others (2019), with first
moments and inertias about the origin; m_567 is m_5 + m_6 + m_7."""


def published(line: str, names: tuple[str, ...]) -> np.ndarray:
    """Return a line of `PANDA` as a row of factors of the inertial parameters."""
    row = np.zeros(len(names))
    for sign, factor, name, numbers in re.findall(r"([+-]?) ?([\d.]+ )?([mI]\w*)_(\d+)", line):
        for number in numbers:
            row[names.index(f"{name}_{number}")] += float(f"{sign}{factor or 1}")
    return row


def test_combinations_of_panda_as_published() -> None:
    """All of them, column by column: the link frames of the file are those of the publication."""
    with pytest.warns(kg.KanegenWarning):
        panda = kg.load(robot_file("panda"))
    base = kg.base_parameters(panda.with_locked({"panda_finger_joint1": 0.0}))
    links = slice(0, 70)  # the fingers are fixed to the last link
    expected = [published(line, base.parameters[links]) for line in PANDA.strip().splitlines()]
    assert base.matrix[:, links] == pytest.approx(np.array(expected), abs=1e-12)


def test_regrouped_parameters_of_puma_560() -> None:
    """The axes of the wrist intersect, so that inertias pass from link to link without masses."""
    base = kg.base_parameters(upright_puma())
    found = {name.split(" ")[0]: name for name in base.names}
    assert found["Izz_6"] == "Izz_6"
    assert found["Ixx_6"] == "Ixx_6 - Iyy_6"
    assert found["my_5"] == "my_5 + mz_6"
    assert found["Izz_5"] == "Izz_5 + Iyy_6"
    assert found["Ixx_5"] == "Ixx_5 - Iyy_5 + Iyy_6"
    assert found["my_4"] == "my_4 - mz_5"
    assert found["mx_2"] == "mx_2 + 0.4318*m_3 + 0.4318*m_4 + 0.4318*m_5 + 0.4318*m_6"
    assert not {"mx_1", "my_1", "Ixx_1"} & found.keys()


def test_a_pendulum_by_hand() -> None:
    """A hinge across gravity shows its moment of inertia and two first moments; along gravity the former."""
    body = kg.Body("bob", 0, 2.0, UNIT, (0.3, 0, 0), kg.Joint(free=HINGE))
    across = kg.System("pendulum", (body,), (9.81, 0.0, 0.0))
    assert kg.base_parameters(across).names == ("mx_1", "my_1", "Izz_1")
    along = kg.base_parameters(replace(across, gravity=(0.0, 0.0, 9.81)))
    assert along.names == ("Izz_1",)
    assert along.is_proven
    slider = replace(across, bodies=(replace(body, joint=kg.Joint(free=SLIDE)),))
    assert kg.base_parameters(slider).names == ("m_1",)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["hyq_no_sensors", "talos_reduced"])
@pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")
def test_floating_robots(name: str) -> None:
    """A free body shows all ten parameters, a hinge on it seven."""
    system = kg.load(robot_file(name), floating_base=True)
    assert len(agrees(system)) == 10 + 7 * (system.number_of_bodies - 1)


def test_a_rank_in_high_precision() -> None:
    """At 40 digits no pivot is between 1e-6 and 1e-30, so no combination was taken for zero that is not.

    Joint frames are not turned: a rotation of doubles is one to 16 digits only.
    """
    system = systems.random_system(np.random.default_rng(4), 3, orientations=False, loads=False)
    with mpmath.workdps(40):
        given = {name: exact(each) for name, each in motions(system, 1, 14).items()}
        stacked = regressor(exact_system(system.values()), **given)
        matrix = stacked.reshape(-1, stacked.shape[-1])
        pivots = []
        for _ in range(min(matrix.shape)):
            place = np.unravel_index(np.argmax(np.abs(matrix)), matrix.shape)
            pivots.append(pivot := matrix[place])
            if pivot == 0:
                break
            matrix = matrix - np.outer(matrix[:, place[1]] / pivot, matrix[place[0]])
    sizes = np.abs(np.array(pivots, dtype=float))
    base = kg.base_parameters(system)
    assert sizes[len(base) - 1] > 1e-6
    assert sizes[len(base) :].max(initial=0.0) < 1e-30


def test_the_base_regressor_is_columns_of_the_regressor() -> None:
    system = random_trees.everything(2, 3)
    base = kg.base_parameters(system)
    given = {name: each[0] for name, each in motions(system, 3, 1).items()}
    found = values(system, ("regressor", "base_regressor"), given)
    n = len(system.freedoms)
    whole = found["regressor"].astype(float).reshape(n, -1)
    close(found["base_regressor"].astype(float).reshape(n, -1), whole[:, base.columns], 1e-14)


def test_run_time_parameters_keep_general_columns() -> None:
    """Columns are those of the code for every value; special values leave combinations that suffice."""
    body = kg.Body("a", 0, 1.0, UNIT, (0.3, 0, 0), kg.Joint(free=HINGE))
    offset = kg.Parameter("offset", 0.0)
    outer = replace(body, name="b", lower=1, joint=replace(body.joint, position=(offset, 0.0, 0.2)))
    system = kg.System("two", (body, outer), (0.0, 0.0, -9.81))
    special, general = kg.base_parameters(system), kg.base_parameters(system.with_parameters({"offset": 0.5}))
    assert special.columns == general.columns
    assert rank(rows(system)) < len(special) == rank(rows(system.with_parameters({"offset": 0.5})))
    for base, value in ((special, 0.0), (general, 0.5)):
        model = system.with_parameters({"offset": value})
        close(rows(model)[:, base.columns] @ base.matrix, rows(model))
        library = kg.build(system, "base_regressor").with_parameters({"offset": value})
        given = motions(model, 1, 4)
        found = library.base_regressor(given["x"], given["y"], given["ydot"]) @ base.matrix
        close(found, regressor(model, **given))


def test_units_of_length_and_mass_do_not_matter() -> None:
    """A tree in units that are smaller by powers of two has the same columns and scaled combinations."""
    system = systems.random_system(np.random.default_rng(7), 4, loads=False)
    small = systems.from_values(systems.rescaled(system.values(), 2.0**20, 2.0**-30, 1.0))
    one, other = kg.base_parameters(system), kg.base_parameters(small)
    scale = np.tile(2.0 ** (-30 * np.array([0, *(1,) * 3, *(2,) * 6])), 4)
    assert one.columns == other.columns
    assert np.array_equal(other.matrix, one.matrix * scale[list(one.columns), None] / scale)


@pytest.mark.parametrize(("precision", "margin"), [("double", 1e-12), ("float", 1e-5)])
def test_one_state_and_many_in_c(precision: str, margin: float) -> None:
    system = systems.random_system(np.random.default_rng(9), 3, loads=False)
    library = kg.build(system, "base_regressor", precision=precision)
    dtype = np.float32 if precision == "float" else np.float64
    given = {name: each.astype(dtype) for name, each in motions(system, 2, 21).items()}
    x, y, ydot = given["x"], given["y"], given["ydot"]
    expected = regressor(system, *(each.astype(float) for each in (x, y, ydot)))
    expected = expected[..., kg.base_parameters(system).columns]
    for row in (slice(None), 5):
        close(library.base_regressor(x[row], y[row], ydot[row]), expected[row], margin)


def test_the_cost_of_the_columns_alone() -> None:
    """A base regressor costs less than the whole one, although it says the same."""
    system = systems.chain(4)
    base, whole = (
        sum(compile_module(system, (name,)).operations.values()) for name in ("base_regressor", "regressor")
    )
    assert base < 0.9 * whole


def test_what_is_no_system_is_refused() -> None:
    for function in (kg.base_parameters, kg.inertial_parameters):
        with pytest.raises(kg.OptionError, match=r"^'panda.urdf' is no System\. Make one with kg\.load"):
            function("panda.urdf")  # type: ignore[arg-type]
        with pytest.raises(kg.OptionError, match="is no System"):
            function([])  # type: ignore[arg-type]


def test_factors_of_run_time_parameters() -> None:
    """The factor 1 of a length of 1 m is no factor 1; where it is no product, its number has a remark."""
    body = kg.Body("a", 0, 1.0, UNIT, (0.3, 0, 0), kg.Joint(free=HINGE))
    length, height = kg.Parameter("l", -1.0), kg.Parameter("h", 0.0)
    for place, first, second, at_defaults in (
        ((length, 0.0, 0.0), "mx_1 + l*m_2", "Izz_1 + l**2*m_2", ()),
        ((length, height, 0.0), "mx_1 + l*m_2", "Izz_1 + 1*m_2", ("l", "h")),
        ((length, height, 0.0), "mx_1 + l*m_2", "my_1 + h*m_2", ("l", "h")),
        ((2.0, 0.0, 0.0), "mx_1 + 2*m_2", "Izz_1 + 4*m_2", ()),
    ):
        outer = replace(body, name="b", lower=1, joint=replace(body.joint, position=place))
        base = kg.base_parameters(kg.System("two", (body, outer), (0.0, -9.81, 0.0)))
        assert {first, second} <= set(base.names)
        assert base.at_defaults == at_defaults
        assert str(base).splitlines()[-len(base) :] == list(base.names)
        assert str(base).startswith("at the default values of l, h:\n") == bool(at_defaults)


def test_info_names_the_sums() -> None:
    sums = "mx_1 + l1*m_2", "my_1", "Izz_1 + l1**2*m_2", "mx_2", "my_2", "Izz_2"
    count = "of 20 inertial parameters 6 combinations are base parameters"
    text = kanegen("info", PENDULUM, "--base-parameters").stdout
    assert "\n  ".join([f"{count}:", *sums]) in text
    assert f"{count} (--base-parameters names them)\n" in kanegen("info", PENDULUM).stdout
    found = json.loads(kanegen("info", PENDULUM, "--json").stdout)["base_parameters"]
    assert found == {"is_proven": True, "sums": list(sums), "at_defaults": []}


@pytest.mark.parametrize(
    ("length", "default", "others"),
    [
        ("sqrt(l*l - 3)", 2.0, (1.8, 3.0)),
        ("log(l - 2)", 4.0, (3.5, 9.0)),
        ("max(0, l - 2)", 4.0, (3.0, 1.0)),
        ("max(0, l - 2)", 2.0, (3.0,)),
        ("1/(l - 3)", 4.0, (2.0,)),
        ("l - l**3", 0.0, (0.5,)),
    ],
)
@pytest.mark.parametrize("place", ["joint.position = [{}, 0, 0.2]", "joint.orientation_angles = [{}, 0, 0]"])
def test_expressions_of_parameters(
    place: str, length: str, default: float, others: tuple[float, ...], tmp_path: Path
) -> None:
    """Roots, poles and kinks of lengths and angles: the columns are those around the defaults."""
    file = tmp_path / "tree.toml"
    file.write_text(EXPRESSION.format(default=default, place=place.format(f'"{length}"')))
    system = kg.load(file)
    base = kg.base_parameters(system)
    state = {"x": np.array([0.3, 0.7]), "y": np.array([-0.4, 0.5]), "ydot": np.array([0.2, -0.6])}
    found = values(system, ("base_regressor",), state, float)["base_regressor"]
    every = regressor(system, **{name: array[None] for name, array in state.items()})[0]
    close(np.reshape(found, (2, len(base))), every[:, list(base.columns)], 1e-13)
    for value in (default, *others):
        every = rows(system.with_parameters({"l": value}))
        combined = np.linalg.lstsq(every[:, list(base.columns)], every, rcond=1e-10)[0]
        close(every[:, list(base.columns)] @ combined, every, 1e-11)
        if value == default:
            close(every[:, list(base.columns)] @ base.matrix, every, 1e-11)
    assert len(base) == rank(rows(system.with_parameters({"l": others[0]})))
