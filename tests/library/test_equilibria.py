"""States of rest and steady motions: textbooks, families, gimbal lock, and what is refused."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.library.equilibria import Equilibrium
from kanegen.library.equilibria.stability import gains_no_energy
from tests.support.command import kanegen
from tests.support.paths import MODELS


def model(name: str) -> kg.System:
    return kg.load(MODELS / f"{name}.toml")


def top(sequence: str = "3-1-3") -> kg.System:
    """A heavy symmetrical top with Euler's angles, one body on a fixed point."""
    joint = kg.Joint(
        sequence=sequence,
        free=(True, True, True, False, False, False),
        freedom_names=("precession", "tilt", "spin", "", "", ""),
    )
    return kg.System("top", (kg.Body("top", 0, M, np.diag([I1, I1, I3]), (0, 0, L), joint),), (0, 0, -G))


M, L, I1, I3, G = 0.25, 0.06, 1.8e-4, 2.6e-4, 9.81


def test_a_double_pendulum_has_four() -> None:
    found = kg.equilibria(model("double_pendulum"))
    states = {tuple(round(float(v) / np.pi) for v in one.x): one.stability.verdict for one in found}
    assert states == {(0, 0): "stable", (0, 1): "unstable", (1, 0): "unstable", (1, 1): "unstable"}
    assert all(one.residual < 1e-13 for one in found)
    assert found[0].free_directions == ()
    assert "minimum" in found[0].stability.reason


def test_what_slides_freely_is_one_family() -> None:
    found = kg.equilibria(model("cart_two_poles"))
    assert len(found) == 4
    assert all(one.free_directions == ({"position": 1.0},) for one in found)
    assert [one.stability.verdict for one in found] == ["stable"] + ["unstable"] * 3


def test_a_family_along_several_coordinates() -> None:
    """Two carts with a spring between them: they may be moved together."""
    slide = {name: kg.Joint(name=name, free=(False, False, False, True, False, False)) for name in ("a", "b")}
    bodies = tuple(kg.Body(name, 0, 1.0, np.zeros((3, 3)), joint=joint) for name, joint in slide.items())
    system = kg.System("carts", bodies).with_force_elements(kg.Potential(kg.parse("2*(x.b - x.a - 0.5)**2")))
    (found,) = kg.equilibria(system)
    (direction,) = found.free_directions
    assert direction == pytest.approx({"a": 1.0, "b": 1.0})
    assert found.coordinates["b"] - found.coordinates["a"] == pytest.approx(0.5, abs=1e-12)
    assert found.stability.verdict == "stable"


def test_a_spring_keeps_turns_apart() -> None:
    """A torsion spring counts turns, so that a pendulum on it may hang wound up: sin(q) = -k q / (m g l)."""
    joint = kg.Joint(name="q", free=(False, False, True, False, False, False))
    bob = kg.Body("bob", 0, 1.0, np.zeros((3, 3)), (1, 0, 0), joint)
    system = kg.System("wound", (bob,), (10.0, 0, 0)).with_force_elements(kg.JointSpring("q", stiffness=1.0))
    found = kg.equilibria(system)
    roots = sorted(one.coordinates["q"] for one in found)
    assert len(roots) >= 5
    assert np.sin(roots) == pytest.approx(-np.array(roots) / 10, abs=1e-12)
    assert np.abs(roots).max() > np.pi


def test_a_crane_hangs_where_its_drum_holds_the_load() -> None:
    system = model("gantry_crane").with_locked({"rope_length": 8.0})
    found = kg.equilibria(system)
    assert found[0].stability.verdict == "stable"
    assert [found[0].coordinates[f"rope.theta{k}"] for k in (1, 2)] == pytest.approx([0, 0], abs=1e-12)
    assert {"bridge_travel", "trolley_travel"} <= {name for one in found[0].free_directions for name in one}


@pytest.mark.slow
def test_where_two_families_cross_nothing_is_called_unstable() -> None:
    """At the pivot of the rope the crane's load swings without weight: forces vanish to the second order."""
    system = model("gantry_crane")
    crossing = kg.equilibria(system)[1]
    assert [crossing.coordinates[f"rope.theta{k}"] for k in (1, 2)] == pytest.approx(
        [np.pi / 2] * 2, abs=1e-7
    )
    assert crossing.stability.verdict == "undecided"
    state = {"rope.theta1": np.pi / 2, "rope.theta2": np.pi / 2, "rope_length": -1.6}
    assert kg.linearize(system, state).stability.verdict == "undecided"
    beside = kg.linearize(system, state | {"rope.theta2": 1.5})
    assert beside.stability.verdict == "unstable"


@pytest.mark.parametrize("tilt", [0.4, 1.2])
def test_steady_precession(tilt: float) -> None:
    """Routh's condition m g l = precession (I3 omega3 - I precession cos(tilt)), with omega3 by hand."""
    across, precession = I1 + M * L**2, 3.0
    omega3 = (M * G * L / precession + across * precession * np.cos(tilt)) / I3
    spin = omega3 - precession * np.cos(tilt)
    (found,) = kg.equilibria(top(), {"spin": spin, "precession": precession})
    assert abs(found.coordinates["tilt"]) == pytest.approx(tilt, abs=1e-9)
    assert found.speeds == {"precession": precession, "tilt": 0.0, "spin": spin}
    assert {name for one in found.free_directions for name in one} == {"precession", "spin"}
    # Small nutation of a steady precession (Goldstein, section 5.7), by the linear model.
    nutation = max(mode.frequency for mode in found.model.modes) * 2 * np.pi
    p, c = precession, np.cos(tilt)
    expected = (I3 * omega3 / across - 2 * p * c) ** 2 + (p * np.sin(tilt)) ** 2
    assert nutation**2 == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("share", [0.98, 1.02])
def test_a_sleeping_top_is_stable_above_its_threshold(share: float) -> None:
    """The textbook's threshold omega3^2 = 4 I m g l / I3^2, with I about the fixed point."""
    threshold = np.sqrt(4 * (I1 + M * L**2) * M * G * L) / I3
    system = top("1-2-3")
    spinning = kg.linearize(system, y={"spin": share * threshold})
    assert (spinning.stability.verdict == "unstable") == (share < 1)
    found = kg.equilibria(system, {"spin": share * threshold})
    upright = max(found, key=lambda one: np.cos(one.x[0]) * np.cos(one.x[1]))
    assert (upright.stability.verdict == "unstable") == (share < 1)


def test_states_in_gimbal_lock_are_left_out() -> None:
    """Upright and hanging are gimbal lock for 3-1-3; the search says how many states it left out."""
    found = kg.equilibria(top())
    assert found.singular > 0
    assert len(found) == 0
    assert "without accelerations left out, as in gimbal lock" in str(found)
    assert len(kg.equilibria(top("1-2-3"))) == 2


def test_a_torque_holds_a_pendulum() -> None:
    found = kg.equilibria(model("cart_pole"), tau={"pole": 0.1})
    assert sorted(np.sin(one.coordinates["pole"]) for one in found) == pytest.approx(
        [-0.1 / (0.1 * 9.81 * 0.5)] * 2, abs=1e-12
    )


def hanging(element: kg.ForceElement) -> Equilibrium:
    """Return the equilibrium at 0 of a pendulum that hangs there, with one force element."""
    joint = kg.Joint(name="q", free=(False, False, True, False, False, False))
    bob = kg.Body("bob", 0, 2.0, np.diag([0.1, 0.2, 0.3]), (0, -0.5, 0), joint)
    system = kg.System("hanging", (bob,), (0, -9.81, 0)).with_force_elements(element)
    return min(kg.equilibria(system, starts=20), key=lambda one: abs(one.coordinates["q"]))


@pytest.mark.parametrize(
    ("element", "reason"),
    [
        (kg.Drive("q", "2*y.q**3"), "a drive on 'q' may do work in a motion"),
        (kg.Drive("q", "3*y.q*abs(y.q)"), "a drive on 'q' may do work in a motion"),
        (kg.Drive("q", "3*sign(y.q)"), "a kink or a jump"),
        (kg.Drive("q", "3*sign(y.q) - y.q"), "a kink or a jump"),
        (kg.Drive("q", "sin(t)"), "depend on the time, and balance in this state at t = 0 s"),
        (kg.Drive("q", "sin(t) - y.q"), "depend on the time, and balance in this state at t = 0 s"),
        (kg.Potential(kg.parse("-20*abs(x.q)")), "a kink or a jump"),
        (kg.Potential(kg.parse("-20*max(0, x.q)**2")), "a kink or a jump"),
    ],
    ids=str,
)
def test_what_neither_eigenvalues_nor_the_energy_decide(element: kg.ForceElement, reason: str) -> None:
    """An effort that vanishes at rest may do work; beside a kink no linear model holds."""
    found = hanging(element)
    assert found.coordinates["q"] == pytest.approx(0, abs=1e-9)
    assert found.stability.verdict == "undecided"
    assert reason in found.stability.reason


@pytest.mark.parametrize(
    ("element", "verdict"),
    [
        (kg.Potential(kg.parse("-20*max(0, x.q - 1)**2")), "stable"),
        (kg.Potential(kg.parse("-2*abs(x.q)**3")), "stable"),
        (kg.JointSpring("q", stiffness=1.0), "stable"),
        (kg.JointSpring("q", stiffness=1.0, damping=0.1), "asymptotically stable"),
        (kg.JointFriction("q", 1.0, 0.1), "asymptotically stable"),
        (kg.Drive("q", "-y.q - y.q*abs(y.q)"), "asymptotically stable"),
        (kg.Drive("q", "2*y.q"), "unstable"),
    ],
    ids=str,
)
def test_kinks_elsewhere_and_smooth_forces_are_decided(element: kg.ForceElement, verdict: str) -> None:
    assert hanging(element).stability.verdict == verdict


@pytest.mark.parametrize(
    ("element", "expected"),
    [
        (kg.JointSpring("q", stiffness=1.0, damping=0.1), True),
        (kg.JointSpring("q", stiffness=1.0, damping=-0.1), False),
        (kg.Spring(("tip", (0.0, 0.0, 1.0)), damping=kg.Parameter("c", -1.0)), False),
        (kg.PointLoad("tip", force=("-y.q**3", "0", "0")), False),
    ],
    ids=str,
)
def test_which_elements_gain_no_energy(element: kg.ForceElement, expected: bool) -> None:
    assert gains_no_energy(element) is expected


def test_nothing_rests_in_free_fall() -> None:
    found = kg.equilibria(model("free_body").with_coordinates("quaternion"))
    gravity = np.linalg.norm([value for value in map(float, model("free_body").gravity)])
    if gravity:
        assert len(found) == 0
        assert found.smallest_residual == pytest.approx(gravity, rel=0.5)


@pytest.mark.parametrize(
    ("system", "speeds", "message"),
    [
        ("double_pendulum", {"q2": 1.0}, "forces depend on 'q2' itself"),
        ("double_pendulum", {"q3": 1.0}, "speeds: there is no 'q3'"),
        (
            "furuta_pendulum",
            {"arm_angle": "a"},
            "speeds: the value of 'arm_angle' is 'a', which is no finite",
        ),
        (
            "furuta_pendulum",
            {"arm_angle": np.inf},
            "speeds: the value of 'arm_angle' is inf, which is no finite",
        ),
        ("satellite", {"bus.omega1": 1.0}, "'bus.omega1' is no rate of a coordinate"),
    ],
)
def test_what_is_refused(system: str, speeds: dict[str, Any], message: str) -> None:
    with pytest.raises(kg.OptionError, match=message):
        kg.equilibria(model(system), speeds)


@pytest.mark.parametrize("starts", [0, -1, "many", True])
def test_a_wrong_number_of_starts_is_refused(starts: Any) -> None:
    with pytest.raises(kg.OptionError, match="no positive number of states"):
        kg.equilibria(model("cart_pole"), starts=starts)


def test_the_command() -> None:
    path = str(MODELS / "cart_pole.toml")
    assert "free: cart_position" in kanegen("equilibria", path).stdout
    data = json.loads(kanegen("equilibria", path, "--tau", "pole=0.1", "--json").stdout)
    assert len(data["equilibria"]) == 2
    assert "is not NAME=VALUE" in kanegen("equilibria", path, "--speed", "pole", status=2).stderr
