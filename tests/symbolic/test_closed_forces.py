"""What force elements add to closed forms: simplified, equal to the reference, its conditions named."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray
from sympy import Float, Function, Pow

import kanegen as kg
from kanegen.reference import equations as reference
from kanegen.symbolic import derive
from kanegen.symbolic.closed.form import ClosedForm
from kanegen.symbolic.literal.numeric import numeric
from kanegen.symbolic.printing.formats import render
from kanegen.symbolic.symbols import real
from tests.support.cases import slow_except
from tests.support.paths import MODELS

THIN = ((0.0, 0.0, 0.0),) * 3


def free(*names: str) -> tuple[bool, ...]:
    return tuple(name in names for name in ("theta1", "theta2", "theta3", "s1", "s2", "s3"))


def arm(*elements: Any) -> kg.System:
    """A hinge q that carries a slide r, with a tip, under force elements."""
    hinge = kg.Joint(free=free("theta3"), name="q")
    slide = kg.Joint(free=free("s1"), name="r", position=(0.3, 0.0, 0.0))
    inertia = ((0.2, 0, 0), (0, 0.3, 0), (0, 0, 0.25))
    bodies = (
        kg.Body("arm", 0, 1.1, inertia, (0.1, 0, 0), hinge, points=(kg.Point("elbow", (0.2, 0, 0)),)),
        kg.Body(
            "hand",
            1,
            kg.Parameter("m", 0.7),
            inertia,
            (0, 0, 0),
            slide,
            points=(kg.Point("tip", (0.4, 0, 0)),),
        ),
    )
    return kg.System("arm", bodies, gravity=(9.81, 0, 0), force_elements=elements)


K = kg.Parameter("k", 40.0)
ALONG = kg.Spring(("elbow", "tip"), stiffness=K, rest_length=0.25, damping=1.5)
ACROSS = kg.Spring(((0.0, 1.0, 0.0), "tip"), stiffness=K, rest_length=0.25, damping=1.5)

ELEMENTS: Mapping[str, Sequence[Any]] = {
    "a spring along the slide": [ALONG],
    "a spring to the ground": [ACROSS],
    "springs without a rest length": [kg.Spring(((0.0, 1.0, 0.0), "tip"), stiffness=3.7)],
    "a joint spring": [kg.JointSpring("q", stiffness=K, rest=0.1, damping=0.02)],
    "friction": [kg.JointFriction("q", friction=1.5, smoothing=0.01)],
    "functions": [
        kg.Drive("r", kg.parse("exp(-0.3*x.r**2)*abs(y.r) + sqrt(1.5 + x.q**2) - atan2(x.r, 1.1)"))
    ],
    "a condition": [kg.Drive("q", kg.parse("0.7*x.q if x.r + 0.5*x.q > 0.1 else min(y.q, 0.2)"))],
    "angles": [kg.Drive("q", kg.parse("2.5*sin(x.q)**2 + 2.5*cos(x.q)**2 + tan(x.q) - 3*sin(2*x.q)"))],
    "numbers in angles": [kg.Drive("q", kg.parse("2.5*sin(0.3*x.q + 0.7) + cos(1.5 - 0.25*y.r)*sin(-0.1)"))],
    "numbers in roots": [
        kg.Drive("q", kg.parse("sqrt(4*x.q**2 + 0.36) + sqrt(0.04)*abs(-2.5*x.r) + x.q/sqrt(2.25)"))
    ],
    "quotients": [kg.Drive("r", kg.parse("0.3/(x.r - 1.9) + x.q/(1 + x.q**2) + (x.r + 2.5)**5"))],
    "a potential": [kg.Potential(kg.parse("k*(x.r - 0.1)**2/2 + 0.2*cos(x.q)*x.r", [K]))],
    "a load on a point": [kg.PointLoad("tip", force=(kg.parse("-0.6*y.r"), 0.1, 0), moment=(0, 0, 2.5))],
    "several": [
        ALONG,
        ACROSS,
        kg.JointSpring("r", stiffness=2.2),
        kg.Drive("q", kg.parse("-0.4*y.q*abs(y.q)")),
    ],
}


def forcing(form: ClosedForm, system: kg.System, x: ArrayLike, y: ArrayLike) -> NDArray[Any]:
    """{f} of a closed form in numbers."""
    return numeric(system, derive(system).symbols, form.A, form.f, ()).forcing(x, y)


@pytest.mark.parametrize("name", slow_except(ELEMENTS, *list(ELEMENTS)[::2]))
def test_values(name: str) -> None:
    """Forms that hold everywhere equal the reference in states on both sides of a spring of zero length."""
    system = arm(*ELEMENTS[name])
    form = derive(system).closed_form(everywhere=True)
    assert not form.conditions
    for x, y in np.random.default_rng(0).uniform(-1.5, 1.5, (6, 2, 2)):
        expected = reference.forcing(system, x, y)
        assert np.abs(forcing(form, system, x, y) - expected).max() <= 1e-13 * np.abs(expected).max()


@pytest.mark.parametrize("name", ["a spring along the slide", "several"])
def test_values_where_the_conditions_hold(name: str) -> None:
    system = arm(*ELEMENTS[name])
    form = derive(system).closed_form()
    assert form.conditions == (real("r") + Float(0.5),)  # the tip is 0.3 + 0.4 - 0.2 outward of the elbow
    rng = np.random.default_rng(0)
    for _ in range(5):
        x, y = np.array([rng.uniform(-1, 1), rng.uniform(-0.49, 1)]), rng.uniform(-1, 1, 2)
        expected = reference.forcing(system, x, y)
        assert np.abs(forcing(form, system, x, y) - expected).max() <= 1e-13 * np.abs(expected).max()


def test_a_spring_along_a_slide_has_no_root() -> None:
    form = derive(arm(ALONG)).closed_form()
    assert str(form.f[1]).count("r_dot") == 1
    assert _functions(form) == {"sin", "cos"}
    assert {"sign", "sin", "cos"} == _functions(derive(arm(ALONG)).closed_form(everywhere=True))


def _functions(form: ClosedForm) -> set[str]:
    """The names of the functions in {f}, with "root" for every power that is no whole one."""
    roots = {"root" for power in form.f.atoms(Pow) if not power.exp.is_Integer}
    return roots | {type(call).__name__ for call in form.f.atoms(Function)}


@pytest.mark.parametrize(("direction", "way"), [((0.6, 0.8, 0.0), 1), ((-0.6, 0.0, 0.8), -1)])
def test_a_spring_on_an_oblique_line_from_the_ground(direction: tuple[float, ...], way: int) -> None:
    """The ends part by s along an oblique axis; the direction has the components of the axis."""
    axis = np.array(direction)
    other = np.array([0.0, 0.0, 1.0]) if axis[2] == 0 else np.array([0.0, 1.0, 0.0])
    rotation = np.array([axis, other, np.cross(axis, other)])
    joint = kg.Joint(free=free("s1"), name="s", orientation=tuple(map(tuple, rotation.tolist())))
    body = kg.Body("bob", 0, 1.0, THIN, (0, 0, 0), joint, points=(kg.Point("hook", (0, 0, 0)),))
    anchor = tuple((-0.5 * axis * way).tolist())
    system = kg.System(
        "rail", (body,), gravity=(0, 0, 0), force_elements=(kg.Spring((anchor, "hook"), 7.0, 0.25, 0.4),)
    )
    form = derive(system).closed_form()
    (condition,) = form.conditions
    assert condition == way * real("s") + Float(0.5)
    for s, u in ((0.3, -0.2), (-0.1, 0.4)):
        expected = reference.forcing(system, [s], [u])
        assert np.abs(forcing(form, system, [s], [u]) - expected).max() <= 1e-14 * 7


def test_a_length_that_is_zero_at_the_start_keeps_its_sign() -> None:
    joint = kg.Joint(free=free("s1"), name="s")
    body = kg.Body("bob", 0, 1.0, THIN, (0, 0, 0), joint, points=(kg.Point("hook", (0, 0, 0)),))
    springs = (kg.Spring(((0, 0, 0), "hook"), 7.0, 0.25),)
    form = derive(kg.System("rail", (body,), gravity=(0, 0, 0), force_elements=springs)).closed_form()
    assert not form.conditions
    assert str(form.f[0].expand()) == "-7*s + 7*sign(s)/4"


def test_documents_state_the_conditions_and_modules_need_none() -> None:
    equations = derive(kg.load(MODELS / "quarter_car.toml"))
    assert "that is where\n  -height + hub + 0.3 > 0\n  -hub + ride + 0.5 > 0\n" in render(equations)
    assert r"\mathit{hub} + 0.3 > 0" in render(equations, "markdown")
    assert r"\mathit{hub} + 0.3 >{}& 0 \\" in render(equations, "latex")
    module = render(equations, "python")
    assert "(-height + hub + 0.3 > 0) - (-height + hub + 0.3 < 0)" in module


def test_the_quarter_car_reads_like_that_of_a_textbook() -> None:
    h, r, z, k, c, gain = (real(name) for name in ("hub", "ride", "height", "stiffness", "damping", "gain"))
    dh, dr, dz = (real(name) for name in ("hub_dot", "ride_dot", "height_dot"))
    form = derive(kg.load(MODELS / "quarter_car.toml")).closed_form()
    tyre, suspension = 160000 * (z - h) + 50 * (dz - dh), k * (r - h) + c * (dr - dh)
    assert (form.f[0] - (tyre + suspension + gain * dr - Float(392.4))).expand() == 0
    assert (form.f[1] - (-suspension - gain * dr - 2943)).expand() == 0
    assert sum(int(entry.count_ops()) for entry in form.f) <= 22
