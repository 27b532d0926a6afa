"""Limits of freedoms: what they accept, the order in a system, what models do with them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.measure.bounds.domain import read_domain
from kanegen.measure.bounds.statement import lines
from kanegen.measure.comparison import compare
from kanegen.model.arrays import Floats
from kanegen.reference import equations as reference
from kanegen.reference.states import random_states, states_away_from_gimbal_lock
from kanegen.studies.budget.region import region_from_table
from kanegen.studies.tradeoff.domain import default_domain
from tests.support import systems
from tests.support.random_trees import everything

INF = math.inf


def _arm() -> kg.System:
    """Two bodies: a hinge and a slide on one, a ball joint with a quaternion on the other."""
    free = (False, False, True, True, False, False)
    limits = kg.Limits.of({"theta3": {"position": (-1.5, 2.0), "speed": 3.0}, "s1": {"effort": 40.0}})
    upper = kg.Body("upper", 0, 1.0, np.eye(3).tolist(), joint=kg.Joint(free=free, limits=limits))
    ball = kg.Joint(free=(True,) * 3 + (False,) * 3, coordinates="quaternion")
    lower = kg.Body("lower", 1, 1.0, np.eye(3).tolist(), joint=ball)
    return kg.System("arm", (upper, lower))


def test_limits_of_a_system_stand_in_the_order_of_x_and_y() -> None:
    system = _arm().with_limits({"lower.theta2": {"speed": 7.0, "effort": 5.0}})
    assert system.coordinate_names == (
        "upper.theta3",
        "lower.e0",
        "lower.e1",
        "lower.e2",
        "lower.e3",
        "upper.s1",
    )
    limits = system.limits
    assert limits.lower.tolist() == [-1.5, *[-INF] * 5]
    assert limits.upper.tolist() == [2.0, *[INF] * 5]
    assert limits.speed.tolist() == [3.0, INF, 7.0, INF, INF]
    assert limits.effort.tolist() == [INF, INF, 5.0, INF, 40.0]
    assert limits


def test_a_system_without_limits_says_so() -> None:
    assert not everything(1).limits


def test_limits_are_saved_and_loaded(tmp_path: Path) -> None:
    ends = {"position": (-INF, 0.1 + 0.2), "speed": 1e-300}
    system = _arm().with_limits({"upper.theta3": ends, "upper.s1": {"position": (-2, INF), "effort": 0}})
    system.save(tmp_path / "arm.toml")
    again = kg.load(tmp_path / "arm.toml")
    assert again == system
    assert again.limits.upper[0] == 0.1 + 0.2


def test_limits_change_nothing_of_the_equations() -> None:
    """The equations do not contain limits, so every line of statements stays."""
    limited = _arm()
    plain = limited.with_limits({"upper.theta3": {}, "upper.s1": {}})
    assert not plain.limits
    assert kg.generate(limited).operations == kg.generate(plain).operations


def test_ranges_of_states_are_the_limits_where_there_are_some() -> None:
    """Of one side only, the other end stays, or keeps its distance where the limit lies beyond it."""
    ends = {"upper.theta3": {"position": (4, INF)}, "upper.s1": {"position": (-INF, 0.25), "speed": 3}}
    limits = _arm().with_limits(ends).limits
    low, high = limits.positions(-np.ones(6), np.ones(6))
    assert low.tolist() == [4, -1, -1, -1, -1, -1]
    assert high.tolist() == [6, 1, 1, 1, 1, 0.25]
    assert limits.speeds(np.full(5, 0.5)).tolist() == [0.5, 0.5, 0.5, 0.5, 3]
    assert limits.words == "2 of 6 coordinates, 1 of 5 speeds"
    below = _arm().with_limits({"upper.theta3": {"position": (-INF, -4)}}).limits
    low, high = below.positions(-np.ones(6), np.ones(6))
    assert (low[0], high[0]) == (-6, -4)


def _limited_chain() -> kg.System:
    """Two hinges, one of them with limits that leave a narrow range away from zero."""
    ends = {"position": (0.5, 0.75), "speed": 0.01, "effort": 2.0}
    return systems.chain(2, ["theta2"]).with_limits({"body2.theta2": ends})


def _inside(x: Floats, y: Floats, tau: Floats | None = None) -> None:
    """Make sure that states fill the limits of the second hinge, and that the first has its whole range."""
    assert 0.5 <= x[:, 1].min() < 0.51
    assert 0.74 < x[:, 1].max() <= 0.75
    assert 0.0095 < np.abs(y[:, 1]).max() <= 0.01
    assert np.abs(x[:, 0]).max() > 3
    assert np.abs(y[:, 0]).max() > 0.5
    assert tau is None or 1.9 < np.abs(tau[:, 1]).max() <= 2


def test_states_of_comparisons_benches_and_studies_stay_within_the_limits() -> None:
    system = _limited_chain()
    states = random_states(system, 1000, limits=system.limits)
    _inside(states.x, states.y)
    timed = states_away_from_gimbal_lock(system, 1000)
    _inside(timed.x, timed.y, timed.tau)
    sample = default_domain(system).sample(1000, 0)
    _inside(sample.x, sample.y, sample.tau)


def test_a_comparison_says_that_its_states_stay_within_the_limits() -> None:
    """A library that is wrong outside the limits alone passes, and the report says why."""
    system = _limited_chain()

    class Inside:
        outputs = ("mass_matrix", "forcing")

        def mass_matrix(self, x: Floats) -> Floats:
            wrong = (x[:, 1] < 0.5) | (x[:, 1] > 0.75)
            return reference.mass_matrix(system, x) * np.where(wrong, 2.0, 1.0)[:, None, None]

        def forcing(self, x: Floats, y: Floats, **loads: Floats) -> Floats:
            return reference.forcing(system, x, y)

    report = compare(system, Inside())  # type: ignore[arg-type]
    assert report.passed
    assert "stay within the limits of the model, on 1 of 2 coordinates, 1 of 2 speeds" in str(report)
    assert "limits of the model" not in str(compare(systems.chain(2, ["theta2"]), Inside()))  # type: ignore[arg-type]


def _gripper(*couplings: kg.Coupling) -> kg.System:
    """Three slides on the ground, all with limits."""
    free = (False, False, False, True, False, False)
    ends = {"left": (0.0, 0.04), "right": (0.0, 0.01), "third": (-0.03, 0.0)}
    bodies = tuple(
        kg.Body(
            name,
            0,
            1.0,
            np.eye(3).tolist(),
            joint=kg.Joint(
                free=free, name=name, limits=kg.Limits.of({"s1": {"position": limit, "speed": 3.0}})
            ),
        )
        for name, limit in ends.items()
    )
    return kg.System("gripper", bodies, couplings=couplings)


def test_coupled_freedoms_stay_within_their_limits() -> None:
    system = _gripper(
        kg.Coupling("right", {"left": 0.8}, 0.001), kg.Coupling("third", {"right": -2.0}, 0.004)
    )
    # right: 0 <= 0.8 x + 0.001 <= 0.01; third: -0.03 <= 0.002 - 1.6 x <= 0, so 0.00125 <= x <= 0.02
    limits = system.limits
    np.testing.assert_allclose([limits.lower[0], limits.upper[0]], [0.00125, 0.01125], rtol=1e-14)
    assert limits.speed[0] == pytest.approx(3.0 / 1.6, rel=1e-15)
    assert (limits.not_kept, limits.words) == ((), "1 of 1 coordinates, 1 of 1 speeds")
    left = random_states(system, 1000, limits=limits).x[:, 0]
    assert 0.0 <= (0.8 * left + 0.001).min() < (0.8 * left + 0.001).max() <= 0.01 + 1e-15
    box = read_domain(None, system)
    assert (box.low["x"][0], box.high["x"][0]) == (limits.lower[0], limits.upper[0])


def test_limits_of_coupled_freedoms_that_are_no_ranges_are_named() -> None:
    several = _gripper(kg.Coupling("third", {"left": 1.0, "right": -1.0}))
    assert several.limits.not_kept == ("third",)
    words = "2 of 2 coordinates, 2 of 2 speeds, but not those of the coupled freedom 'third'"
    assert any(words in line for line in lines(read_domain(None, several)))
    apart = _gripper(kg.Coupling("right", {"left": 1.0}, 0.5))
    assert apart.limits.not_kept == ("right",)
    assert apart.limits.upper[0] == 0.04
    moved = several.with_prescribed("left")
    assert moved.limits.not_kept == ("third",)


def test_bounds_and_budgets_hold_within_the_limits_unless_a_domain_says_otherwise() -> None:
    system = _limited_chain()
    box = read_domain(None, system)
    assert [box.low["x"][1], box.high["x"][1]] == [0.5, 0.75]
    assert [box.low["y"][1], box.high["tau"][1], box.high["tau"][0]] == [-0.01, 2.0, 0.0]
    assert any("limits of the model, where it has some" in line for line in lines(box))
    wider = {"x": {"body2.theta2": [-1.0, 1.0]}, "tau": {"body2.theta2": 0.0}}
    assert read_domain(wider, system).low["x"][1] == -1.0
    assert read_domain(wider, system).high["tau"][1] == 0.0
    region = region_from_table(system, wider).domain
    assert [region.low[1], region.high[1]] == [-1.0, 1.0]
    assert region.as_dict()["y"]["body2.theta2"][1] == pytest.approx(0.01, rel=1e-7)  # single precision


def test_other_coordinates_drop_limits_of_the_angles_with_a_warning() -> None:
    system = kg.System("cube", (kg.Body("cube", 0, 1.0, np.eye(3).tolist()),))
    limited = system.with_limits({"cube.theta2": {"position": (-1, 1)}, "cube.s1": {"speed": 2}})
    with pytest.warns(kg.KanegenWarning, match=r"limits of angles are left out.*cube"):
        changed = limited.with_coordinates("quaternion")
    assert changed.limits.speed.tolist() == [INF, INF, INF, 2, INF, INF]
    assert limited.with_speeds("angle_rates") == limited


def test_a_prescribed_freedom_keeps_its_limits() -> None:
    driven = _arm().with_prescribed("upper.theta3")
    assert driven.bodies[0].joint.limits.upper[2] == 2.0
    assert not np.isfinite(driven.limits.upper).any()


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"theta3": {"position": (1, -1)}}, "lower position of theta3, 1.0, exceeds the upper one, -1.0"),
        ({"theta3": {"position": (INF, INF)}}, "theta3 cannot move between inf and inf. Lock it"),
        ({"theta3": {"position": (1, 1)}}, "theta3 cannot move between 1.0 and 1.0. Lock it"),
        ({"theta3": {"speed": 0}}, "theta3 cannot move at the speed 0. Lock it"),
        ({"theta3": {"position": (math.nan, 1)}}, "lower of theta3: nan is not a number"),
        ({"theta3": {"position": 3}}, "theta3: position: expected 2 entries, got 3"),
        ({"theta3": {"speed": -1}}, "speed of theta3 is -1.0. A limit of the speed is its largest magnitude"),
        ({"theta3": {"effort": "big"}}, "effort of theta3: 'big' is not a number"),
        ({"theta3": {"speed": kg.Parameter("v", 1.0)}}, "is not a number"),
        ({"theta3": {"velocity": 1}}, "theta3: unknown key 'velocity'"),
        ({"theta4": {"speed": 1}}, "'theta4' is no freedom. Known are 'theta1', "),
        ({"theta3": 1}, "theta3: expected a table"),
        ([1, 2], "limits: expected a table"),
    ],
)
def test_what_is_no_limit_is_refused(table: Any, message: str) -> None:
    with pytest.raises(kg.ModelError) as caught:
        kg.Limits.of(table)
    assert message in str(caught.value)


def test_limits_fit_their_joint() -> None:
    locked = kg.Limits.of({"theta1": {"speed": 1.0}})
    with pytest.raises(kg.ModelError, match="theta1 is locked, so a limit says nothing"):
        kg.Joint(free=(False,) * 5 + (True,), limits=locked)
    placed = kg.Limits.of({"theta1": {"position": (0, 1)}})
    with pytest.raises(kg.ModelError, match="theta1 is no coordinate of this joint"):
        kg.Joint(coordinates="quaternion", limits=placed)
    with pytest.raises(kg.ModelError, match=r"limits: .* is no Limits"):
        kg.Joint(limits={"theta1": 1})  # type: ignore[arg-type]
    with pytest.raises(kg.ModelError, match=r"'upper.s2': limits: s2 is locked"):
        _arm().with_limits({"upper.s2": {"speed": 1}})
    with pytest.raises(
        kg.ModelError, match=r"limits: there is no freedom 'uper.s1'. Did you mean 'upper.s1'"
    ):
        _arm().with_limits({"uper.s1": {"speed": 1}})
