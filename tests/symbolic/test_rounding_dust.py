"""Closed forms of robots with oblique axes hold no numbers that rounding alone has made."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from sympy import Expr, Float, cos, sin

import kanegen as kg
from kanegen.reference import equations as reference
from kanegen.symbolic import derive
from kanegen.symbolic.closed.form import ClosedForm

ROBOT = """<robot name="oblique"><link name="base"/>
<link name="arm"><inertial><origin xyz="0 0 .03"/><mass value="0.5"/>
<inertia ixx="1e-3" iyy="2e-3" izz="2e-3" ixy="1e-4" ixz="0" iyz="0"/></inertial></link>
<link name="slide"><inertial><origin xyz="0 0.01 .03"/><mass value="{mass}"/>
<inertia ixx="1e-5" iyy="2e-5" izz="2e-5" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="shoulder" type="continuous"><origin xyz="0 0 .5" rpy="0.3 -0.2 0.1"/>
<parent link="base"/><child link="arm"/><axis xyz="{hinge}"/></joint>
<joint name="rail" type="prismatic"><origin xyz="0 0.02 .05"/>
<parent link="arm"/><child link="slide"/><axis xyz="{rail}"/>
<limit lower="0" upper="1" effort="1" velocity="1"/>
</joint></robot>"""


def _oblique(folder: Path, hinge: str, rail: str, mass: float = 0.05) -> kg.System:
    path = folder / "oblique.urdf"
    path.write_text(ROBOT.format(hinge=hinge, rail=rail, mass=mass))
    return kg.load(path)


def _floats(expression: Expr) -> list[float]:
    return [abs(float(number)) for number in expression.atoms(Float)]


def _require_values(system: kg.System, form: ClosedForm) -> None:
    """Make sure that a closed form has the values of the reference, to roundings of a dozen terms."""
    equations = derive(system)
    for x, y in np.random.default_rng(0).uniform(-1, 1, (5, 2, 2)):
        state = dict(zip((*equations.x, *equations.y), (*x, *y), strict=True))
        found = (np.array(part.xreplace(state).evalf(20), dtype=float) for part in (form.A, form.f))
        expected = reference.mass_matrix(system, x), reference.forcing(system, x, y)[:, None]
        for actual, wanted in zip(found, expected, strict=True):
            assert np.abs(actual - wanted).max() <= 1e-14 * np.abs(wanted).max()


@pytest.mark.parametrize("hinge", ["1 1 0", "1 2 0", "0 1 -1", "1 1 1", "1 -2 3"])
@pytest.mark.parametrize("rail", ["0 1 0", "1 1 0", "2 0 1"])
def test_weight_along_an_oblique_axis_has_no_moment_about_it(tmp_path: Path, hinge: str, rail: str) -> None:
    """Every term about the hinge has a factor that is not constant, and no number is at rounding level."""
    system = _oblique(tmp_path, hinge, rail)
    form = derive(system).closed_form()
    assert all(term.free_symbols for term in form.f[0].args)
    smallest = min(min(_floats(entry), default=1.0) for entry in (*form.A, *form.f))
    assert smallest > 1e-7
    _require_values(system, form)


def test_a_number_is_the_same_in_every_entry(tmp_path: Path) -> None:
    """The weight of the slide has the coefficients of {f} both along the rail and in the moment."""
    system = _oblique(tmp_path, "1 1 0", "0 1 0")
    form = derive(system).closed_form()
    theta, s = derive(system).x
    moment, along = form.f[0].expand(), form.f[1].expand()
    assert moment.coeff(s * cos(theta)) == along.coeff(sin(theta)) != 0
    assert moment.coeff(s * sin(theta)) == -along.coeff(cos(theta)) != 0


def test_small_numbers_of_the_model_stay(tmp_path: Path) -> None:
    """Nothing is compared with an absolute threshold: a slide of 1e-20 kg has all its terms."""
    small = _oblique(tmp_path, "1 1 0", "0 1 0", mass=1e-20)
    form, usual = (derive(one).closed_form() for one in (small, _oblique(tmp_path, "1 1 0", "0 1 0")))
    assert form.A[1, 1] == Float(1e-20)
    assert form.f[1].expand().free_symbols == usual.f[1].expand().free_symbols
    assert len(form.f[1].expand().args) == len(usual.f[1].expand().args)
    _require_values(small, form)
