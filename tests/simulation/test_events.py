"""Events against closed forms: throws, pendulums by elliptic functions, and what is refused."""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np
import pytest
from scipy.special import ellipj, ellipk

import kanegen as kg
from kanegen.simulation.events import _first
from tests.support.moving_pendulum import GRAVITY, pendulum
from tests.support.paths import MODELS

METHODS = [
    {"step": 0.01},
    {"tolerance": 1e-12},
    pytest.param({"method": "Radau", "tolerance": 1e-9}, marks=pytest.mark.slow),
]


@functools.cache
def thrown() -> kg.Library:
    """Return a point mass that flies freely, with its position as a point."""
    free = (False, False, False, True, True, True)
    body = kg.Body("ball", 0, 2.0, np.zeros((3, 3)), joint=kg.Joint(free=free))
    system = kg.System("throw", (body,), gravity=(0.0, 0.0, -GRAVITY)).with_points(
        {"tip": ("ball", (0.0, 0.0, 0.25))}
    )
    return kg.build(system, ("forward_dynamics", "point_positions", "kinetic_energy", "potential_energy"))


@pytest.mark.parametrize("options", METHODS)
def test_a_throw_lands_where_the_parabola_does(options: dict[str, Any]) -> None:
    """The tip is 0.25 m above the mass centre. RK4 is exact for a parabola."""
    motion = kg.simulate(
        thrown(),
        [0.0, 0.0, 1.0],
        [3.0, 0.0, 4.0],
        5.0,
        events=["y.ball.s3 < 0", kg.Event("point_positions.tip.z <= 0", terminal=True), "x.ball.s1 > 100"],
        **options,
    )
    apex, landing = motion.events
    v, h = 4.0, 1.25
    expected = (v + math.sqrt(v * v + 2 * GRAVITY * h)) / GRAVITY
    tolerance = 1e-14 if "step" in options else 10 * options["tolerance"]
    assert apex.time == pytest.approx(v / GRAVITY, abs=max(tolerance, 4e-15))
    assert (apex.direction, apex.terminal) == ("falling", False)
    assert landing.time == pytest.approx(expected, abs=max(tolerance, 4e-15))
    assert landing.x[0] == pytest.approx(3.0 * expected)
    assert motion.times[-1] == landing.time
    assert abs(motion.output("point_positions.tip.z")[-1]) < 5e-15 + tolerance
    assert (np.diff(motion.times) > 0).all()


@pytest.mark.parametrize("options", METHODS)
def test_passages_of_a_pendulum_are_quarter_periods(options: dict[str, Any]) -> None:
    """From level and at rest it passes the lowest position after K(1/2)/sqrt(g), then every two of them."""
    motion = kg.simulate(
        pendulum(), {"body1.theta3": 0.0}, None, 6.0, events="x.body1.theta3 + pi/2", **options
    )
    quarter = ellipk(0.5) / math.sqrt(GRAVITY)
    expected = quarter * np.arange(1, 12, 2)
    expected = expected[expected < 6.0]
    assert len(motion.events) == len(expected)
    error = 1e-5 if "step" in options else 1e3 * options["tolerance"]
    assert [one.time for one in motion.events] == pytest.approx(expected, abs=error)
    assert [one.direction for one in motion.events] == (["falling", "rising"] * 3)[: len(expected)]
    rising = kg.simulate(pendulum(), [0.0], [0.0], 6.0, events="x.body1.theta3 > -pi/2", **options)
    assert [one.time for one in rising.events] == [one.time for one in motion.events[1::2]]


def test_the_state_of_an_event_is_on_the_surface_to_rounding() -> None:
    motion = kg.simulate(pendulum(), [0.0], [0.0], 6.0, step=0.01, events="x.body1.theta3 < -1")
    for one in motion.events:
        before = np.nextafter(one.time, 0)
        assert abs(one.x[0] + 1) < 4 * abs(one.y[0]) * (one.time - before) + 4e-16
        phi = 2 * math.asin(math.sqrt(0.5) * ellipj(math.sqrt(GRAVITY) * one.time + ellipk(0.5), 0.5)[0])
        assert phi - math.pi / 2 == pytest.approx(-1.0, abs=1e-6)  # the error of RK4 with 0.01 s


def test_two_crossings_within_one_step_are_found() -> None:
    """A step of 0.25 s, in which the ball rises above a height and falls below it again."""
    height = 1.0 + 4.0**2 / (2 * GRAVITY) - 0.01
    motion = kg.simulate(
        thrown(),
        [0.0, 0.0, 1.0],
        [0.0, 0.0, 4.0],
        1.0,
        every=0.25,
        step=0.25,
        events=f"x.ball.s3 - {height!r}",
    )
    half = math.sqrt(2 * 0.01 / GRAVITY)
    expected = [4.0 / GRAVITY - half, 4.0 / GRAVITY + half]
    assert [one.time for one in motion.events] == pytest.approx(expected, abs=1e-13)
    assert int(expected[0] / 0.25) == int(expected[1] / 0.25)


def test_an_event_that_holds_at_the_start_must_begin_again() -> None:
    motion = kg.simulate(
        pendulum(), [0.0], [0.0], 3.0, step=0.01, events=["x.body1.theta3 > -1", "x.body1.theta3"]
    )
    upward = kg.simulate(pendulum(), [0.0], [1.0], 0.1, step=0.01, events=["x.body1.theta3 > 0"])
    assert not upward.events  # both sides are equal at the start
    returned = [one for one in motion.events if one.condition == "x.body1.theta3 > -1"]
    assert len(returned) == 1 and returned[0].time > 1.0
    assert returned[0].direction == "rising"


def test_events_of_time_and_of_accelerations() -> None:
    system = kg.load(MODELS / "double_pendulum.toml").with_points({"tip": ("lower", (0.7, 0.0, 0.0))})
    motion = kg.simulate(
        system, {"q1": 0.3}, None, 1.0, step=0.01, events=["t > 0.3333", "point_accelerations.tip.x"]
    )
    at = next(one for one in motion.events if one.condition.startswith("t"))
    assert at.time == np.nextafter(0.3333, 1) or at.time == pytest.approx(0.3333, abs=1e-16)
    library = motion.library
    for one in motion.events:
        if one.condition.startswith("point"):
            ydot = library.forward_dynamics(one.x, one.y)
            assert abs(library.point_accelerations(one.x, one.y, ydot)[0, 0]) < 1e-12


def test_bisection_ends_at_the_first_double() -> None:
    assert _first(lambda t: t >= 1.25, 0.0, 2.0) == 1.25
    edge = math.nextafter(1.0, 2.0)
    assert _first(lambda t: t > 1.0, 0.0, 2.0) == edge


@pytest.mark.parametrize(
    ("events", "message"),
    [
        ("x.body1.teta3", "there is no such variable. Did you mean 'x.body1.theta3'?"),
        ("x.body1.theta3 == 1", "compares by another sign than < <= > >="),
        ("0 < x.body1.theta3 < 1", "has several comparisons. Give each as an own event"),
        ("x.body1.theta3 < 1 and t > 1", "has several comparisons. Give each as an own event"),
        ("x.body1.theta3 <", "event: expression 'x.body1.theta3 <': nothing after '<'"),
        ("__import__('os')", "there is no function '__import__'"),
        ("momentum", "one element is needed, such as momentum.linear.x"),
        (3, "events: 3 is no event. Give a text such as 'x.pole > 1'"),
        ([3], "is no event. Give a text such as"),
        (kg.Event(3), "is no event. Give a text such as"),  # type: ignore[arg-type]
        ("-" * 100_000 + "t > 1", "no expression, or nested too deeply"),
        ("+".join(["t"] * 20_000) + " > 1", "nested too deeply"),
        ("t" + " " * 300_000 + "> 1", "at most 300000 are read"),
    ],
)
def test_what_is_refused(events: Any, message: str) -> None:
    with pytest.raises(kg.OptionError) as error:
        kg.simulate(pendulum(), [0.0], [0.0], 1.0, step=0.1, events=events)
    assert message in str(error.value)
    assert len(str(error.value).splitlines()) == 1


def test_events_of_many_states_and_without_value_are_refused() -> None:
    with pytest.raises(kg.OptionError, match="a motion with events begins in one state, not in 2"):
        kg.simulate(pendulum(), np.zeros((2, 1)), np.zeros((2, 1)), 1.0, step=0.1, events="t - 1")
    with pytest.raises(kg.StatusError, match=r"event 'log\(x.body1.theta3\)' has no finite value"):
        kg.simulate(pendulum(), [0.0], [0.0], 1.0, step=0.1, events="log(x.body1.theta3)")
