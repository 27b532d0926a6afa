"""Equations as text, Markdown, LaTeX and Python."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from kanegen import Body, Joint, Parameter, System
from kanegen.errors import OptionError
from kanegen.readers import load
from kanegen.reference import equations as reference
from kanegen.symbolic import derive
from kanegen.symbolic.printing.formats import FORMATS, render
from tests.support.paths import MODELS
from tests.support.systems import chain, eight_body, flags, random_system

PENDULUM = load(MODELS / "double_pendulum.toml")
CRANE = load(MODELS / "gantry_crane.toml")
ARM = load(MODELS / "six_revolute_arm.toml")

RUN = """
import json, sys
import numpy as np
import equations
given = json.load(sys.stdin)
A = equations.mass_matrix(given["x"], **given["changed"])
f = equations.forcing(given["x"], given["y"], given["force"], given["torque"], **given["changed"])
at_rest = equations.forcing(given["x"], given["y"])
json.dump([A.tolist(), f.tolist(), at_rest.tolist()], sys.stdout)
"""


def python(folder: Path, code: str, stdin: str = "", **environment: str) -> str:
    command = [sys.executable, "-W", "error", "-c", code]
    done = subprocess.run(
        command,
        cwd=folder,
        input=stdin,
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | environment,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def system_with_reserved_names() -> System:
    """A system whose parameters have names of Python or of the module, and whose numbers have 17 digits."""
    names = "lambda x A sin parameters pass np np_".split()
    parameters = {name: Parameter(name, 0.1 * (i + 1)) for i, name in enumerate(names)}
    joint = Joint(
        position=(parameters["lambda"], 1 / 3, parameters["np"]),
        free=(True, False, False, False, True, False),
        locked=(0.0, parameters["pass"], 0.0, parameters["parameters"], 0.0, 2 / 3),
    )
    hinge = Joint(free=(False, False, True, False, False, False))
    inertia = ((parameters["A"], 0, 0), (0, parameters["A"], 0), (0, 0, parameters["A"]))
    first = Body("first", 0, parameters["x"], inertia, (1 / 7, 0, parameters["sin"]), joint, loads=True)
    return System("awkward", (first, Body("second", 1, parameters["np_"], inertia, (0, 0.3, 0), hinge)))


@pytest.mark.parametrize("closed", [True, False])
@pytest.mark.parametrize(
    "system", [PENDULUM, CRANE, system_with_reserved_names()], ids=lambda system: system.name
)
def test_python_module_gives_the_values_of_the_reference(
    system: System, closed: bool, tmp_path: Path
) -> None:
    _run(system, closed, tmp_path)


@pytest.mark.slow
def test_python_module_of_a_big_tree(tmp_path: Path) -> None:
    _run(eight_body(), None, tmp_path)


def _run(system: System, closed: bool | None, folder: Path) -> None:
    (folder / "equations.py").write_text(render(derive(system), "python", closed), encoding="utf-8")
    rng = np.random.default_rng(0)
    x, y = rng.uniform(-1, 1, (2, len(system.freedoms)))
    loaded = np.array([body.loads for body in system.bodies])[:, None]
    force, torque = rng.uniform(-1, 1, (2, system.number_of_bodies, 3)) * loaded
    changed = {parameter.name: parameter.value + 0.25 for parameter in system.parameters}
    given = {"x": x, "y": y, "force": force, "torque": torque}
    data = {name: array.tolist() for name, array in given.items()} | {"changed": {"parameters": changed}}
    A, f, without_loads = map(np.array, json.loads(python(folder, RUN, json.dumps(data))))
    heavier = system.with_parameters(changed)
    for actual, expected in (
        (A, reference.mass_matrix(heavier, x)),
        (f, reference.forcing(heavier, x, y, force, torque)),
        (without_loads, reference.forcing(system, x, y)),
    ):
        assert actual.shape == expected.shape
        assert np.abs(actual - expected).max() <= 1e-12 * np.abs(expected).max()


def test_text() -> None:
    assert render(derive(PENDULUM)) == (
        """\
double_pendulum: 2 bodies, 2 freedoms
Equations of motion [A]{ydot} = {f}, with {xdot} = {y}. SI units.

Coordinates and speeds. Eq. (1).
  x[1] = q1, y[1] = q1_dot: q1 (rad)
  x[2] = q2, y[2] = q2_dot: q2 (rad)

Parameters. Default values.
  g = 9.81
  m1 = 1
  l1 = 1
  m2 = 0.5
  l2 = 0.7

Mass matrix. [A] of Eq. (43); it is symmetric.
  A[1,1] = l1**2*(m1 + m2) + 2*l1*l2*m2*cos(q2) + l2**2*m2
  A[1,2] = l2*m2*(l1*cos(q2) + l2)
  A[2,2] = l2**2*m2

Forcing. {f} of Eq. (44).
  f[1] = -g*l1*(m1 + m2)*sin(q1) - g*l2*m2*sin(q1 + q2) + l1*l2*m2*q2_dot*(2*q1_dot + q2_dot)*sin(q2)
  f[2] = -l2*m2*(g*sin(q1 + q2) + l1*q1_dot**2*sin(q2))
"""
    )


def test_markdown_holds_the_matrices() -> None:
    text = render(derive(PENDULUM), "markdown")
    assert r"- $x_{2} = q_{2}, \quad y_{2} = \dot{q}_{2} \quad \text{q2 (rad)}$" in text
    assert "- $m_{2} = 0.5$" in text
    corner = r"l_{2} m_{2} \left(l_{1} \cos {q_{2}} + l_{2}\right)"
    assert re.search(
        rf"\$\$\nA = \\begin{{bmatrix}}.*{re.escape(corner)} \\\\ {re.escape(corner)} & .*\n\$\$", text
    )
    assert re.search(r"\$\$\nf = \\begin\{bmatrix\}- g l_\{1\} .*\n\$\$", text)
    assert r"Equations of motion $[A]\lbrace \dot{y}\rbrace  = \lbrace f\rbrace$" in text
    assert text.count("$$") % 2 == 0


def test_big_trees_print_blocks_and_definitions() -> None:
    text = render(derive(eight_body()))
    assert "      = [[^7R_8][^1R_7][P̂_1], [0], [0], [0], [0], [0], [^7R_8][P̂_7], [P̂_8]]" in text
    assert "Body 8: rotation from the lower body, Eq. (4).\n  R_7_8_11 = C_8_2*C_8_3\n" in text
    assert "f[48] = Fnet_8_1*R_7_8_13 + Fnet_8_2*R_7_8_23 + Fnet_8_3*R_7_8_33" in text


def test_rows_of_very_many_blocks_are_not_printed() -> None:
    assert "in blocks" in render(derive(chain(16, ["s1"])), closed=False)
    assert "in blocks" not in render(derive(chain(17, ["s1"])), closed=False)


@pytest.mark.parametrize(
    "system", [PENDULUM, CRANE, ARM, system_with_reserved_names()], ids=lambda system: system.name
)
@pytest.mark.parametrize("form", ["latex", "markdown"])
def test_latex_is_balanced(system: System, form: str) -> None:
    text = render(derive(system), form)
    plain = re.sub(r"\\[{}]", "", text)
    depth = np.cumsum([(c == "{") - (c == "}") for c in plain])
    assert depth.min() >= 0
    assert depth[-1] == 0
    assert text.count(r"\left") == text.count(r"\right")
    open_environments: list[str] = []
    for kind, name in re.findall(r"\\(begin|end)\{([a-z*]+)\}", text):
        if kind == "begin":
            open_environments.append(name)
        else:
            assert open_environments.pop() == name
    assert not open_environments
    assert not re.search(r"'_\{[^{}]*\}\^", text)  # a prime is a superscript: a second one is an error
    assert max(map(len, text.splitlines())) < 3000


def test_latex_is_a_document() -> None:
    text = render(derive(CRANE), "latex")
    assert text.startswith("\\documentclass{article}\n")
    assert text.endswith("\\end{document}\n")
    assert r"gantry\_crane" in text
    assert r"\mathit{load\_mass}" in text
    assert r"\ddot" not in text


@cache
def printed_by_a_process(hash_seed: str) -> dict[str, str]:
    """Every format of two documents, printed by a process with this seed of its hashes."""
    code = (
        "import json, sys\n"
        "from kanegen.readers import load\n"
        "from kanegen.symbolic import derive\n"
        "from kanegen.symbolic.printing.formats import FORMATS, render\n"
        "found = {form: '' for form in FORMATS}\n"
        "for name, closed in (('gantry_crane', True), ('gantry_crane', False)):\n"
        f"    equations = derive(load({str(MODELS)!r} + f'/{{name}}.toml'))\n"
        "    for form in FORMATS:\n"
        "        found[form] += render(equations, form, closed)\n"
        "print(json.dumps(found))\n"
    )
    printed = python(MODELS.parent, code, PYTHONHASHSEED=hash_seed, PYTHONIOENCODING="utf-8")
    documents: dict[str, str] = json.loads(printed)
    return documents


@pytest.mark.parametrize("form", FORMATS)
def test_same_input_same_bytes(form: str) -> None:
    first, second = (printed_by_a_process(seed)[form] for seed in ("1", "2"))
    assert first
    assert first == second


def test_no_digit_is_lost() -> None:
    mass, length = 0.1 + 0.2, 1e-7 / 3
    slider = Joint(free=(False, False, False, True, True, True))
    body = Body("box", 0, mass, ((1, 0, 0), (0, 1, 0), (0, 0, 1)), (length, 0, 0), slider)
    system = System("box", (body,))
    for form in FORMATS:
        assert repr(mass) in render(derive(system), form)
    tilt = System("tilt", (Body("box", 0, 1.0, body.inertia, (length, 0, 0), Joint()),))
    assert repr(length) in render(derive(tilt), "text", closed=False)
    assert r"3.3333333333333334 \cdot 10^{-8}" in render(derive(tilt), "latex", closed=False)


def test_errors() -> None:
    with pytest.raises(
        OptionError, match=r"unknown format 'word'. Known are 'text', 'markdown', 'latex', 'python'."
    ):
        render(derive(PENDULUM), "word")
    long = random_system(np.random.default_rng(0), 6, connection=range(6), free=flags(6, ["theta1"]))
    with pytest.raises(OptionError, match="more than 500 terms"):
        render(derive(long), closed=True)
    assert "Fnet_6_1" in render(derive(long))
