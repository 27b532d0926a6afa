"""Integrals of motion: by hand, constant along trajectories, and none where something acts."""

from __future__ import annotations

import numpy as np
import pytest
import sympy

import kanegen as kg
from tests.support.cases import slow_among, slow_except
from tests.support.paths import MODELS


def model(name: str) -> kg.System:
    return kg.load(MODELS / f"{name}.toml")


def top() -> kg.System:
    """A heavy symmetrical top with Euler's angles."""
    joint = kg.Joint(
        sequence="3-1-3",
        free=(True, True, True, False, False, False),
        freedom_names=("psi", "tilt", "spin", "", "", ""),
    )
    m, length, across, along = (
        kg.Parameter(name, value)
        for name, value in (("m", 0.25), ("l", 0.06), ("I1", 1.8e-4), ("I3", 2.6e-4))
    )
    inertia = ((across, 0, 0), (0, across, 0), (0, 0, along))
    return kg.System("top", (kg.Body("top", 0, m, inertia, (0, 0, length), joint),), (0, 0, -9.81))


def slides(spring: str) -> kg.System:
    """Two carts on a rail, with an energy between them or to the ground."""
    joints = {name: kg.Joint(name=name, free=(False, False, False, True, False, False)) for name in "ab"}
    points = {name: (kg.Point(f"p{name}", (0, k, 0)),) for k, name in enumerate("ab")}
    bodies = tuple(
        kg.Body(name, 0, 1.0 + k, np.zeros((3, 3)), (0, 0, 0), joints[name], points=points[name])
        for k, name in enumerate("ab")
    )
    return kg.System("slides", bodies, (0, 0, -9.81)).with_force_elements(
        kg.Spring(("pa", "pb" if spring == "between" else (0, 2, 0)), stiffness=3.0, rest_length=0.5)
    )


HINGE = (False, False, True, False, False, False)
SLIDE = (False, False, False, True, False, False)
A = kg.Parameter("a", 0.0)


def carrier(joint: kg.Joint, gravity: object = (0, 0, -9.81), inner: int = 0, **parts: object) -> kg.System:
    """A carrier on the ground, and on it an eccentric wheel about axis `inner` and a pole about axis 3."""
    inertia = np.diag([0.2, 0.3, 0.4])
    wheel = kg.Joint(name="wheel", free=tuple(i == inner for i in range(6)))
    bodies = (
        kg.Body("base", 0, 2.0, inertia, (0, 0, 0), joint),
        kg.Body("disc", 1, 1.0, inertia, (0.3, 0.2, 0.1), wheel),
        kg.Body("rod", 1, 1.0, inertia, (0.5, 0, 0), kg.Joint((0.2, 0, 0), name="pole", free=HINGE)),
    )
    return kg.System("carrier", bodies, gravity, **parts)  # type: ignore[arg-type]


def turntable(**joint: object) -> kg.Joint:
    return kg.Joint(name="base", free=HINGE, **joint)  # type: ignore[arg-type]


def rail(**joint: object) -> kg.Joint:
    return kg.Joint(name="base", free=SLIDE, **joint)  # type: ignore[arg-type]


def motor(freedom: str, body: str = "") -> dict[str, object]:
    return {"rotors": (kg.Rotor("motor", freedom, (0, 0, 1), 0.05, 5.0, body),)}


ROLLS = {"couplings": (kg.Coupling("wheel", {"base": 2.0}),)}
MIMICS = {"couplings": (kg.Coupling("wheel", {"pole": 2.0}),)}

ACTED_ON = {
    "rolls on the ground": (carrier(rail(), inner=2, **ROLLS), []),
    "a gear inside": (carrier(rail(), inner=2, **MIMICS), ["momentum of base"]),
    "turns with the ground": (carrier(turntable(), **ROLLS), []),
    "a motor of the rail": (carrier(rail(), **motor("base")), ["momentum of base"]),
    "a motor of the table": (carrier(turntable(), **motor("base", "disc")), ["momentum of base"]),
    "a motor inside": (carrier(turntable(), **motor("pole")), ["momentum of base"]),
    "gravity along the rail": (carrier(rail(), (A, 0, -9.81)), []),
    "gravity across the axis": (carrier(turntable(), (0, A, -9.81)), []),
    "an inclined rail": (carrier(rail(orientation=(0, A, 0))), []),
    "a rail in another direction": (carrier(rail(orientation=(A, 0, 0))), ["momentum of base"]),
    "an inclined axis": (carrier(turntable(orientation=(A, 0, 0))), []),
    "an axis with another zero": (carrier(turntable(orientation=(0, 0, A))), ["momentum of base"]),
    "locked at an angle": (carrier(turntable(locked=(A, 0, 0, 0, 0, 0))), []),
    "armature": (carrier(rail(armature=(0, 0, 0, A, 0, 0))), ["momentum of base"]),
}


@pytest.mark.parametrize("name", slow_except(ACTED_ON, *list(ACTED_ON)[::3]))
def test_momenta_in_space_hold_for_all_parameters_couplings_and_rotors(name: str) -> None:
    """What is named stays constant with a = 0.4: its rate is 0, by a difference over 2e-4 s of the motion."""
    system, expected = ACTED_ON[name]
    energy, *momenta = kg.derive(system).integrals_of_motion()
    found = [one.name for one in momenta]
    assert energy.name == "energy"
    assert found == expected
    given = {"a": 0.4} if system.parameters else {}
    library = kg.build(system, ("forward_dynamics",), flags="-O0")
    library = library.with_parameters(given) if given else library
    rng = np.random.default_rng(3)
    x, y = rng.uniform(-1, 1, len(system.coordinates)), rng.normal(size=len(system.freedoms))
    step = np.array([[1e-4], [-1e-4]])
    for one in (energy, *momenta):
        values = one.along(x + step * y, y + step * library.forward_dynamics(x, y), given)
        assert abs(values[0] - values[1]) <= 2e-4 * 1e-6 * (1 + abs(values[0])), one.name


def test_values_of_states_that_do_not_fit() -> None:
    energy = kg.derive(model("double_pendulum")).integrals_of_motion()[0]
    with pytest.raises(kg.ArrayError, match=r"x: expected shape \(..., 2\), got \(3,\)"):
        energy.along(np.zeros(3), np.zeros(2))
    with pytest.raises(kg.ArrayError, match=r"y: expected as many states as x has"):
        energy.along(np.zeros((4, 2)), np.zeros((5, 2)))
    joint = kg.Joint(name="wheel", prescribed=HINGE, free=SLIDE)
    body = kg.Body("wheel", 0, 1.0, np.eye(3), (0.1, 0, 0), joint)
    momentum = kg.derive(kg.System("wheel", (body,), (0, 0, -9.81))).integrals_of_motion()[0]
    with pytest.raises(kg.OptionError, match="depends on the prescribed motion"):
        momentum.along([0.0], [1.0])


def names(system: kg.System) -> list[str]:
    return [one.name for one in kg.derive(system).integrals_of_motion()]


def test_a_top_by_hand() -> None:
    """The textbook's three integrals of the heavy top."""
    energy, psi, spin = kg.derive(top()).integrals_of_motion()
    m, length, I1, I3, tilt = sympy.symbols("m l I1 I3 tilt", real=True)
    psi_dot, tilt_dot, spin_dot = sympy.symbols("psi_dot tilt_dot spin_dot", real=True)
    omega3 = spin_dot + psi_dot * sympy.cos(tilt)
    A = I1 + m * length**2
    by_hand = {
        spin: I3 * omega3,
        psi: A * psi_dot * sympy.sin(tilt) ** 2 + I3 * omega3 * sympy.cos(tilt),
        energy: (A * (psi_dot**2 * sympy.sin(tilt) ** 2 + tilt_dot**2) + I3 * omega3**2) / 2
        + m * sympy.Rational(981, 100) * length * sympy.cos(tilt),
    }
    for found, expected in by_hand.items():
        assert sympy.simplify(sympy.nsimplify(found.expression) - expected) == 0
    assert [one.name for one in (energy, psi, spin)] == ["energy", "momentum of psi", "momentum of spin"]


SYSTEMS = {
    "top": top,
    "spinning_top": lambda: model("spinning_top"),
    "furuta_pendulum": lambda: model("furuta_pendulum"),
    "cart_two_poles": lambda: model("cart_two_poles"),
    "double_pendulum": lambda: model("double_pendulum"),
    "gantry_crane": lambda: model("gantry_crane"),
    "free_body": lambda: model("free_body"),
    "satellite": lambda: model("satellite"),
    "slides": lambda: slides("between"),
}


@pytest.mark.parametrize("name", slow_among(SYSTEMS, "satellite", "top", "gantry_crane", "free_body"))
def test_integrals_stay_constant_along_a_trajectory(name: str) -> None:
    """DOP853 with a tolerance of 1e-12 a step leaves drifts of about 1e-10 of the sizes on the way."""
    system = SYSTEMS[name]()
    rng = np.random.default_rng(4)
    x = np.array(system.neutral_coordinates) + rng.uniform(0.2, 0.6, len(system.coordinates))
    y = rng.uniform(-1, 1, len(system.freedoms))
    library = kg.build(system, ("forward_dynamics", "coordinate_rates"))
    path = kg.simulate(library, x, y, np.linspace(0, 0.5, 30), "DOP853", tolerance=1e-12)
    integrals = kg.derive(system).integrals_of_motion()
    assert integrals
    assert np.ptp(path.y, axis=0).max() > 1e-3
    for one in integrals:
        values = one.along(path.x, path.y)
        size = max(np.abs(values).max(), np.abs(path.y).max() * 1e-6)
        assert np.ptp(values) <= 1e-9 * size, one.name


def test_what_is_found() -> None:
    assert names(model("double_pendulum")) == ["energy"]
    assert names(model("cart_two_poles")) == ["energy", "momentum of position"]
    assert names(model("spinning_top"))[1:] == [
        "momentum of top.theta3",
        "angular momentum about axis 3 through the joint of top",
    ]
    assert names(slides("between")) == ["energy", "linear momentum, axis 1"]
    assert len(names(model("satellite"))) == 10


def test_what_acts_leaves_none() -> None:
    assert names(slides("to the ground")) == ["energy", "momentum of b"]
    assert names(model("quarter_car")) == []
    damped = model("cart_pole").with_force_elements(kg.JointSpring("pole", damping=0.1))
    assert names(damped) == ["momentum of cart_position"]
    driven = model("cart_pole").with_force_elements(kg.Drive("cart_position", kg.parse("sin(t)")))
    assert names(driven) == []


def test_parameters_have_other_values() -> None:
    _, psi, spin = kg.derive(top()).integrals_of_motion()
    x, y = np.zeros(3), np.array([0.0, 0.0, 2.0])
    assert spin.along(x, y, {"I3": 3.0}) == pytest.approx(6.0)
    assert psi.along(np.zeros((4, 3)), np.tile(y, (4, 1))).shape == (4,)
    with pytest.raises(kg.OptionError, match="there is no 'I4'"):
        spin.along(x, y, {"I4": 3.0})


def test_large_trees_are_refused() -> None:
    with pytest.raises(kg.OptionError, match="at most 8"):
        kg.derive(model("eight_body")).integrals_of_motion()
