"""The names of freedoms in a model are the symbols of its equations, wherever that is clear."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import kanegen as kg
from kanegen.reference import equations as reference
from kanegen.symbolic import derive
from kanegen.symbolic.printing.formats import render
from kanegen.symbolic.symbols import real


def slide(*names: str, parameter: str = "m") -> kg.System:
    """Bodies that slide on each other and turn, whose translations have these names."""
    joints = [
        kg.Joint(free=(True, False, False, True, False, False), freedom_names=("", "", "", name, "", ""))
        for name in names
    ]
    inertia = ((0.2, 0, 0), (0, 0.3, 0), (0, 0, 0.4))
    mass = kg.Parameter(parameter, 2.0)
    bodies = [kg.Body(f"b{k}", k, mass, inertia, (0.1, 0.2, 0.3), joint) for k, joint in enumerate(joints)]
    return kg.System("slides", tuple(bodies))


def symbols(system: kg.System) -> list[str]:
    equations = derive(system)
    return [str(symbol) for column in (equations.x, equations.y, equations.ydot) for symbol in column]


def test_named_freedoms_have_their_names_and_others_those_of_the_notes() -> None:
    assert symbols(slide("q1", "reach")) == [
        *("theta_1_1", "theta_2_1", "q1", "reach"),
        *("thetadot_1_1", "thetadot_2_1", "q1_dot", "reach_dot"),
        *("thetaddot_1_1", "thetaddot_2_1", "q1_ddot", "reach_ddot"),
    ]


@pytest.mark.parametrize(
    "name", ["joint-1", "1st", "Länge", "s_2_1", "theta_7_3", "F_1_1", "t", "pi", "m", "a b"]
)
def test_a_name_that_is_no_symbol_or_names_something_else_is_not_taken(name: str) -> None:
    assert symbols(slide(name))[1] == "s_1_1"


def test_a_name_that_is_the_rate_of_another_freedom_is_not_taken() -> None:
    assert symbols(slide("q", "q_dot"))[2:4] == ["s_1_1", "s_2_1"]
    assert symbols(slide("q", "r", parameter="q_ddot"))[2:4] == ["s_1_1", "r"]


def test_names_with_numbers_are_taken_where_the_notes_have_no_such_symbol() -> None:
    assert symbols(slide("joint_1", "S_1_1"))[2:4] == ["joint_1", "S_1_1"]


def test_intermediates_and_numbers_do_not_take_the_name_of_a_freedom() -> None:
    """The sine of body 1 is S_1_1 in the notes, and a closed form calls its first number number_0."""
    system = slide("S_1_1", "number_0")
    equations = derive(system, intermediates=True)
    names = [str(definition.symbol) for definition in equations.definitions]
    assert "S_1_1" not in names
    assert "S_1_1_" in names
    x, y = np.random.default_rng(0).uniform(-1, 1, (2, 4))
    numeric = equations.lambdify()
    assert np.allclose(numeric.mass_matrix(x), reference.mass_matrix(system, x), rtol=1e-13)
    assert np.allclose(numeric.forcing(x, y), reference.forcing(system, x, y), rtol=1e-13, atol=1e-13)
    form = equations.closed_form()
    state = dict(zip((*equations.x, *equations.y), (*x, *y), strict=True))
    found = np.array(form.A.xreplace(state | {real("m"): 2.0}), dtype=float)
    assert np.allclose(found, reference.mass_matrix(system, x), rtol=1e-13)


@pytest.mark.parametrize("closed", [True, False])
def test_python_module_with_names_of_python_and_of_its_own(closed: bool, tmp_path: Path) -> None:
    """Freedoms may have names that mean something else in Python, in NumPy and in the module."""
    system = slide("lambda", "sin", parameter="A")
    turned = zip(system.bodies, _with_named_angles(system), strict=True)
    system = replace(system, bodies=tuple(replace(body, joint=joint) for body, joint in turned))
    (tmp_path / "equations.py").write_text(render(derive(system), "python", closed))
    x, y = np.random.default_rng(1).uniform(-1, 1, (2, 4))
    code = (
        f"import equations as e; x, y = {x.tolist()}, {y.tolist()}; "
        "print(*e.mass_matrix(x).ravel(), *e.forcing(x, y))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    found = np.array(done.stdout.split(), dtype=float)
    expected = np.concatenate([reference.mass_matrix(system, x).ravel(), reference.forcing(system, x, y)])
    assert np.abs(found - expected).max() <= 1e-13 * np.abs(expected).max()


def _with_named_angles(system: kg.System) -> list[kg.Joint]:
    """The joints of a system with names for their angles as well."""
    joints = [body.joint for body in system.bodies]
    return [
        replace(joint, freedom_names=(name, "", "", joint.freedom_names[3], "", ""))
        for joint, name in zip(joints, ("x", "np"), strict=True)
    ]


@pytest.mark.parametrize(
    ("name", "latex", "rate"),
    [
        ("q1", "q_{1}", r"\dot{q}_{1}"),
        ("theta", r"\theta", r"\dot{\theta}"),
        ("l_a", "l_{a}", r"\dot{l}_{a}"),
        ("rod", r"\mathit{rod}", r"\dot{\mathit{rod}}"),
        ("arm_reach", r"\mathit{arm\_reach}", r"\dot{\mathit{arm\_reach}}"),
    ],
)
def test_latex(name: str, latex: str, rate: str) -> None:
    text = render(derive(slide(name)), "latex")
    assert rf"x_{{2}} ={{}}& {latex}, \quad y_{{2}} = {rate} \quad" in text
