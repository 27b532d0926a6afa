"""What notebooks show of every class: well-formed, escaped, without a script, cut where it is long."""

from __future__ import annotations

import re
from collections.abc import Callable
from html.parser import HTMLParser
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import sympy
from website.mathml import mathml

import kanegen as kg
from kanegen.pictures.html import MOST_ROWS
from kanegen.symbolic.printing import Blocks
from tests.support.paths import MODELS, ROOT
from tests.support.random_trees import everything

HOSTILE = "<script>alert('1')</script> & \"Ωメカ\" مفصل"
"""A name that is code in HTML, with letters of several scripts."""

VOID = {"br", "hr", "img", "input", "meta", "link", "path", "circle", "rect"}
"""Elements that close themselves."""


class Reader(HTMLParser):
    """Reads HTML strictly: every element that is opened is closed, in order."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[str] = []
        self.attributes: list[tuple[str, str | None]] = []
        self.text = ""
        self.feed(text)
        self.close()
        assert not self.open, self.open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes += attrs
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes += attrs

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data


def read(text: str) -> Reader:
    """Read HTML, and make sure that it runs nothing and loads nothing."""
    reader = Reader(text)
    assert not {"script", "iframe", "object", "embed", "style", "link", "foreignobject"} & {*reader.tags}
    for name, value in reader.attributes:
        assert not name.startswith("on") and name not in {"href", "src", "xlink:href"}, name
        assert "url(" not in (value or "") and "javascript:" not in (value or "")
    return reader


def model(name: str) -> kg.System:
    return kg.load(MODELS / f"{name}.toml")


def hostile_system() -> kg.System:
    """A pendulum on a cart whose names are code."""
    slide = kg.Joint(name=f"{HOSTILE} slide", free=(False, False, False, True, False, False))
    turn = kg.Joint(name=f"{HOSTILE} turn", free=(False, True, False, False, False, False))
    tip = kg.Point(f"{HOSTILE} tip", (0, 0, -1))
    cart = kg.Body(f"{HOSTILE} cart", 0, kg.Parameter("M", 2.0), np.eye(3), joint=slide)
    bob = kg.Body(f"{HOSTILE} bob", 1, 1.5, np.eye(3), (0, 0, -0.5), turn, loads=True, points=(tip,))
    return kg.System(HOSTILE, (cart, bob))


def _library(system: kg.System) -> kg.Library:
    return kg.build(system, outputs=("mass_matrix", "forcing", "forward_dynamics"))


SHOWN: dict[str, Callable[[kg.System], Any]] = {
    "System": lambda system: system,
    "Source": kg.generate,
    "Library": _library,
    "Report": lambda system: kg.compare(system, states=10),
    "LinearModel": kg.linearize,
    "Equilibria": lambda system: kg.equilibria(system, starts=8),
    "Bounds": lambda system: kg.bound(kg.generate(system)),
    "BaseParameters": kg.base_parameters,
    "Programs": lambda system: kg.compare(system, states=10).programs(states=4),
}


@pytest.mark.parametrize("name", SHOWN)
def test_html_is_well_formed_and_escapes_names(name: str) -> None:
    reader = read(SHOWN[name](hostile_system())._repr_html_())
    if name not in {"BaseParameters"}:  # which names nothing but parameters
        assert HOSTILE in reader.text
    if name in {"System", "LinearModel", "Equilibria", "Library"}:
        assert f"{HOSTILE} slide" in reader.text


@pytest.mark.parametrize("seed", range(2))
def test_html_of_random_systems(seed: int) -> None:
    system = everything(seed)
    text = read(system._repr_html_()).text
    for name in (
        *system.coordinate_names,
        *(one.name for one in system.parameters[:MOST_ROWS]),
        *system.prescribed_names,
    ):
        assert name in text


def test_the_report_says_what_failed() -> None:
    report = kg.compare(model("double_pendulum"), states=20)
    assert "FAILED" not in report._repr_html_()
    strict = report.accuracies[0].__class__(**{**vars(report.accuracies[0]), "bound": 0.0})
    text = read(report.__class__(**{**vars(report), "accuracies": (strict,)})._repr_html_()).text
    assert "FAILED" in text
    assert f"x = {strict.worst.x!r}" in text


def test_long_tables_are_cut_with_a_hint() -> None:
    count = 300
    system = kg.System.from_arrays(
        range(count), np.ones(count), [np.eye(3)] * count, np.zeros((count, 3)), np.zeros((count, 3))
    )
    text = read(system._repr_html_()).text
    assert "260 more bodies: system.picture()" in text
    assert "1760 more rows: system.coordinate_names" in text
    assert len(system._repr_html_()) < 40_000
    assert system.picture().svg.count("<text") > count


def test_a_large_linear_model_says_where_its_matrices_are() -> None:
    n = 10
    names = [f"joint{k}" for k in range(n)]
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.diag(np.arange(1.0, n + 1)), np.zeros((n, n))]])
    model = kg.LinearModel(
        name="ten springs",
        state_names=tuple(f"{kind}.{name}" for kind in "xy" for name in names),
        input_names=(),
        output_names=(),
        A=A,
        B=np.zeros((2 * n, 0)),
        C=np.zeros((0, 2 * n)),
        D=np.zeros((0, 0)),
        **{name: np.zeros(n) for name in ("x", "y", "tau", "xdot", "ydot")},
        rate_map=np.eye(n),
        rate_map_rate=np.zeros((n, n)),
    )
    text = read(model._repr_html_()).text
    assert "20 by 20 numbers in model.A" in text
    assert f"{np.sqrt(10) / (2 * np.pi):.6g} Hz" in text


def formulas(text: str) -> str:
    """Return a formula for a notebook, after the converter of the site has read it and lost nothing."""
    assert text.startswith("$$\n\\begin{aligned}\n") and text.endswith("\n\\end{aligned}\n$$")
    assert text.count("$") == 4
    assert "<" not in text
    printed = mathml(text.strip("$\n"), as_block=True)
    for function in ("sin", "cos"):
        assert len(re.findall(rf"\\{function}(?![a-z])", text)) == printed.count(f">{function}<")
    assert text.count(r"\dot{") == printed.count(">˙<")
    aligned = ElementTree.fromstring(printed).findall(".//*[@class='ams-align']")
    assert max(map(len, aligned)) == text.count("\n") - 3  # rows and lines
    return text


def test_equations_are_the_closed_form_of_a_small_tree() -> None:
    equations = kg.derive(model("double_pendulum"))
    shown, form = formulas(equations._repr_latex_()), equations.closed_form()
    assert shown.split("[A] &= ")[1] == form._repr_latex_().split("[A] &= ")[1]
    names = equations.latex_names
    q2, l1, l2, m2 = (sympy.Symbol(name, real=True) for name in ("q2", "l1", "l2", "m2"))
    assert form.A[0, 1].equals(l2 * m2 * (l1 * sympy.cos(q2) + l2))
    assert r"l_{2} m_{2} \left(l_{1} \cos {q_{2}} + l_{2}\right)" in shown
    assert names[q2] == "q_{2}"


@pytest.mark.parametrize(("name", "n"), [("panda_arm", 7), ("six_revolute_arm", 6)])
def test_long_equations_are_cut_with_a_hint(name: str, n: int) -> None:
    shown = formulas(kg.derive(model(name))._repr_latex_())
    assert rf"\mathbb{{R}}^{{{n} \times {n}}}" in shown
    assert re.search(r"\\text\{… \d+ more entries that are not zero: equations\.A\}", shown)
    assert shown.count("\n") < 60


def test_a_closed_form_says_where_it_holds() -> None:
    shown = formulas(kg.derive(model("quarter_car")).closed_form()._repr_latex_())
    assert r"\text{where }" in shown and "> 0" in shown


def test_no_line_of_a_long_entry_is_lost() -> None:
    shown = formulas(kg.derive(kg.load(ROOT / "examples" / "arm.urdf"))._repr_latex_())
    assert shown.count(r"\dot") > 10 and "more" not in shown


def test_blocks_and_their_rows() -> None:
    blocks = Blocks(model("eight_body"))
    shown = formulas(blocks._repr_latex_())
    assert r'more lines: print(render(equations, only="blocks"))}' in shown
    row = formulas(blocks.partial_angular_velocity(3)._repr_latex_())
    assert r"[{}^{2}R_{3}][{}^{1}R_{2}][\hat{P}_{1}]" in row


def test_linear_models_and_integrals_in_symbols() -> None:
    equations = kg.derive(model("cart_pole"))
    shown = formulas(equations.linearize(inputs=["cart_position"])._repr_latex_())
    assert shown.count(r"\begin{bmatrix}") == 2
    for one in kg.derive(model("spinning_top")).integrals_of_motion():
        assert r"\text{is constant: " in formulas(one._repr_latex_())
        assert r"\dot{\theta}_{1,3}" in one._repr_latex_()


def test_text_in_formulas_keeps_special_characters_outside() -> None:
    slide = kg.Joint(
        freedom_names=("", "", "", "a_b & 50% {x} \\ ^~ #$<i>", "", ""),
        free=(False, False, False, True, False, False),
    )
    system = kg.System("slide", (kg.Body("b", 0, 1.0, np.eye(3), joint=slide),), (0, 0, 0))
    for one in kg.derive(system).integrals_of_motion():
        inside = re.findall(r"\\text\{([^}]*)\}", one._repr_latex_())
        assert not set("_&%\\^~#$<{") & set("".join(inside))


def test_motions_and_sweeps_are_short() -> None:
    """Arrays are not printed: shapes and spans are, and a notebook shows a few rows."""
    system = kg.load(MODELS / "double_pendulum.toml")
    outputs = ("forward_dynamics", "rollout_rk4", "step_rk4_derivatives")
    library = kg.build(system, outputs, flags="-O0")
    rollout = library.rollout(np.zeros((3, 2)), np.zeros((3, 2)), steps=1000, step=1e-3, every=10)
    assert repr(rollout) == "<Rollout: 101 times from 0 to 1 s, x (3, 101, 2), y (3, 101, 2)>"
    one = library.step_derivatives(np.zeros(2), np.zeros(2), step=1e-3)
    assert repr(one) == "<LinearStep: x (2,), y (2,), A (4, 4), B (4, 2), P (4, 5)>"
    motion = kg.simulate(library, {"q1": 0.3}, None, 1.0, step=0.01, events=["x.q1 < 0"])
    text = read(motion._repr_html_()).text
    assert "RK4, step 0.01 s" in text and "x.q2 in rad" in text and "x.q1 < 0" in text
    assert f"{motion.x[-1, 1]:.6g}" in text
    found = kg.sweep(system, {"x.q1": np.linspace(0.1, 0.3, 20)}, kg.RolloutJob(0.1, 0.01, bands=("x.q1",)))
    text = read(found._repr_html_()).text
    assert "20 of 20 rows, 0 with a reason" in text and "… 12 more rows: found.table" in text
    assert repr(found.bands("x.q1")) == "<Band of x.q1: 11 times from 0 to 0.1 s>"
