"""Names in any script: shown as they are, harmless wherever they are printed, and their identifiers."""

from __future__ import annotations

import json
import random
import re
import string
import unicodedata
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import kanegen as kg
from kanegen.cli.app import app
from kanegen.model.names import FILES_OF_C, KEYWORDS, MAX_LABEL, check_label, identifier
from kanegen.model.quoting import c_comment, c_name, markdown, markdown_code, python_text
from kanegen.studies.explain import cost_report
from kanegen.studies.explain.page import html as html_page
from kanegen.symbolic.printing import render
from tests.support.c_compilers import WARNINGS, C, code, run
from tests.support.cases import slow_except
from tests.support.paths import FROM_REPORTS

SCRIPTS = ("左腿", "Fuß links", "нога", "👩‍🔧 arm", "رِجل", "पैर", "joint(1)", "a/b\\c", "int", "x" * 64)
"""Names as robot files have them."""

ATTACKS = (
    "*/ int evil; /*", "\\", "??/", "/*", "*/", "a\\u{2a}", '"""; import os', "'; rm -rf /", "$(id)", "`id`",
    "${x}", "%s%n", "<script>alert(1)</script>", "[bold]", "[/]", "a|b", "\\end{document}", "#include <x>",
    "@param", "../../etc/passwd", "a,b", "a=b", " a ", "-n", "a.b", "..", "{{ 7 * 7 }}", "{% x %}",
)  # fmt: skip
"""Names that would be read as instructions by something, if they were not quoted."""


def armed(names: tuple[str, ...], title: str) -> kg.System:
    """Return sliding hinges on the ground: bodies and points with these names, and forces between them."""
    bodies = []
    for k, name in enumerate(names):
        hinge = kg.Joint(free=(False, True, False, k % 2 == 0, False, False), position=(0.1, 0, 1))
        mass = kg.Parameter("m", 2.0) if k == 0 else 1.0 + k
        point = kg.Point(f"tip of {name}", (0, 0, 1), loads=k == 0)
        inertia = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
        bodies.append(kg.Body(name, 0, mass, inertia, (0, 0, 0.5), hinge, loads=True, points=(point,)))
    last = json.dumps(f"{names[-1]}.theta2", ensure_ascii=False)
    return kg.System(title, tuple(bodies)).with_force_elements(
        kg.JointSpring(f"{names[-1]}.theta2", stiffness=3.0),
        kg.Drive(f"{names[0]}.theta2", kg.parse(f"2*x[{last}]")),
        kg.PointLoad(f"tip of {names[0]}", force=(0, 0, 1)),
    )  # fmt: skip


@pytest.mark.parametrize("names", [SCRIPTS, ATTACKS], ids=["scripts", "attacks"])
def test_c_compiles_and_computes_under_every_name(names: tuple[str, ...], tmp_path: Path) -> None:
    """Every file is ASCII, free of warnings, and computes what the same system with plain names computes."""
    system = armed(names, names[0])
    plain = armed(tuple(f"b{k}" for k in range(len(names))), "plain")
    source, other = (kg.generate(one, ("forcing", "body_poses")) for one in (system, plain))
    source.write(tmp_path)
    for name, text in source.files.items():
        assert text.isascii() or name == "README.md", name
        assert re.fullmatch(r"[A-Za-z0-9_.]+", name)
    bare = [_without_comments(made.files[f"{made.model.name}.c"]) for made in (source, other)]
    assert bare[0].replace(source.model.name, "plain").replace(source.model.prefix, "PLAIN") == bare[1]
    for compiler in C.values():
        files = (*code(source.model.name), "main.c")
        run(*compiler, "-std=c99", *WARNINGS, "-fsyntax-only", *files[:2], "main.c", folder=tmp_path)
    run(*C["gcc"], "-std=c99", *WARNINGS, "main.c", *code(source.model.name), "-o", "main", folder=tmp_path)
    run("./main", folder=tmp_path)


def equipped(names: tuple[str, ...], title: str) -> kg.System:
    """Return the hinges with frames, rotors, limits, couplings and whatever else has the names."""
    system = armed(names, title)
    first, second, last = names[0], names[1], names[-1]
    system = system.with_prescribed(f"{names[2]}.s1").with_limits({f"{last}.theta2": {"effort": 3.0}})
    system = system.with_frames({f"tool of {name}": (name, (0, 0, 0.1), (0.1, 0, 0)) for name in names})
    system = system.with_poses([f"tool of {name}" for name in names])
    system = system.with_rotors(
        kg.Rotor(first, f"{last}.theta2", (0, 0, 1), 1e-3, 20.0, body=f"tool of {last}")
    )
    system = system.with_couplings(kg.Coupling(f"{second}.theta2", {f"{last}.theta2": -1.0}))
    return system.with_force_elements(
        kg.JointFriction(f"{last}.theta2", 0.4, 0.1),
        kg.Spring((f"tip of {first}", f"tool of {last}"), 3.0, 0.1, 0.2),
        kg.Potential(kg.parse(f"cos(x[{json.dumps(f'{last}.theta2', ensure_ascii=False)}])")),
    )


@pytest.mark.parametrize("names", [SCRIPTS, ATTACKS], ids=["scripts", "attacks"])
def test_c_compiles_with_everything_that_has_a_name(names: tuple[str, ...], tmp_path: Path) -> None:
    outputs = ("forcing", "reaction_loads", "frame_jacobians", "point_jacobians", "prescribed_efforts")
    source = kg.generate(equipped(names, names[-1]), outputs)
    source.write(tmp_path)
    assert all(text.isascii() or name == "README.md" for name, text in source.files.items())
    for compiler in C.values():
        files = (*code(source.model.name)[:2], "main.c")
        run(*compiler, "-std=c99", *WARNINGS, "-fsyntax-only", *files, folder=tmp_path)
    equipped(names, names[-1]).save(tmp_path / "saved.toml")
    assert kg.load(tmp_path / "saved.toml") == equipped(names, names[-1])
    readme = source.files["README.md"]
    assert all(f"tool of {name}".replace("|", r"\|") in readme for name in names)


def _without_comments(text: str) -> str:
    return re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)


def test_names_are_those_of_the_file_everywhere(tmp_path: Path) -> None:
    """Results, messages, tables and pages have the names, and no page or module is broken by them."""
    names = (*SCRIPTS, *ATTACKS)
    system = armed(names, "左腿 */")
    library = kg.build(system, ("forcing", "body_poses"))
    assert library.name == "左腿 */"
    assert library.pose_names == names
    assert library.freedom_names == system.freedom_names
    assert [name.removesuffix(".theta2") for name in library.freedom_names[: len(names)]] == [*names]
    system.save(tmp_path / "saved.toml")
    assert kg.load(tmp_path / "saved.toml") == system
    readme = library.source.files["README.md"]
    for name in names:
        assert markdown_code(f"{name}.theta2") in readme


def test_the_summary_on_a_terminal(tmp_path: Path) -> None:
    names = ("左腿", "[bold]", "[/]", "a b")
    armed(names, "[red]x[/]").save(tmp_path / "model.toml")
    shown = CliRunner().invoke(app, ["info", str(tmp_path / "model.toml")], catch_exceptions=False)
    assert shown.stdout.startswith("[red]x[/]: 4 bodies")
    assert all(f"{name}.theta2" in shown.stdout for name in names)


def test_the_page_of_a_cost_report() -> None:
    page = html_page(cost_report(armed(("<script>x</script>", "a&b", "左腿"), "<b>")))
    assert "<script>" not in page and "<b>" not in page
    assert "&lt;script&gt;x&lt;/script&gt;" in page and "a&amp;b" in page and "左腿" in page


@pytest.mark.parametrize("name", slow_except((*SCRIPTS, *ATTACKS), *SCRIPTS[::4], *ATTACKS[::4]))
def test_one_hinge_with_the_name(name: str, tmp_path: Path) -> None:
    """The printed equations, the summary and the selection by name work with each name."""
    system = armed((name,), name)
    x, y = np.array([0.3, 0.1]), np.array([0.2, 0.5])
    load = {"point_force": np.ones((1, 3)), "point_moment": np.zeros((1, 3))}
    expected = kg.build(system).forcing(x, y, **load)
    module: dict[str, object] = {}
    exec(render(kg.derive(system), "python"), module)
    assert system.freedom_names[0] in str(module["__doc__"])
    found = module["forcing"](x, y, **load)  # type: ignore[operator]
    np.testing.assert_allclose(found, expected, rtol=1e-13)
    latex = render(kg.derive(system), "latex")
    assert latex.count(r"\end{document}") == 1 and latex.endswith("\\end{document}\n")
    system.save(tmp_path / "model.toml")
    assert kg.load(tmp_path / "model.toml") == system
    assert system.with_poses([name]).poses == (name,)


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("", "is empty"),
        ("  ", "is blank"),
        ("\u3000", "is blank"),
        ("a\n", r"contains the invisible character U\+000A\. Delete it"),
        ("a\tb", r"U\+0009"),
        ("a\x1b[31m", r"U\+001B"),
        ("a\u202eb", r"U\+202E"),
        ("a\u2028b", r"U\+2028"),
        ("\ud800", r"U\+D800"),
        ("x" * (MAX_LABEL + 1), f"longer than {MAX_LABEL} characters"),
        (3, "is not a string"),
    ],
)
def test_names_that_no_line_of_text_can_show(name: object, reason: str) -> None:
    with pytest.raises(kg.ModelError, match=rf"^body name.*{reason}"):
        check_label(name, "body name")
    for make in (lambda: kg.System(name, ()), lambda: kg.Body(name, 0, 1.0, ((1, 0, 0),) * 3)):  # type: ignore[arg-type]
        with pytest.raises(kg.ModelError):
            make()


def test_identifiers() -> None:
    """A derived identifier is readable, differs where the name differs, and never is a keyword."""
    assert [identifier(name) for name in ("arm", "a_1", "x" * 63)] == ["arm", "a_1", "x" * 63]
    names = [
        "a-b",
        "a b",
        "a.b",
        "a/b",
        "2dof-planar rig",
        "左腿",
        "右腿",
        "Größe",
        "x" * 64,
        "x" * 65,
        *KEYWORDS,
        "math",
        "Time",
    ]
    made = [identifier(name) for name in names]
    assert len({*made, "a_b"}) == len(names) + 1
    for one in made:
        assert (
            re.fullmatch(r"[A-Za-z][A-Za-z0-9_]{0,62}", one)
            and one not in KEYWORDS
            and one.lower() not in FILES_OF_C
        )
    assert made[0][:4] == "a_b_" and made[4].startswith("model_2dof_planar_rig_")
    assert made[5].startswith("model_") and identifier("Größe").startswith("Groe_")
    assert (
        identifier("a-b") == "a_b_" + identifier("a-b")[-6:] == "a_b_a3a5d4" or len(identifier("a-b")) == 10
    )


def test_models_with_similar_names_can_be_in_one_program(tmp_path: Path) -> None:
    """Their files, functions and constants have different names."""
    made = [kg.generate(armed(("a",), name)) for name in ("a-b", "a b", "a_b")]
    text = "".join(f'#include "{one.model.name}.h"\n' for one in made)
    for one in made:
        one.write(tmp_path / one.model.name)
        for file in (tmp_path / one.model.name).glob(f"{one.model.name}*"):
            file.rename(tmp_path / file.name)
    (tmp_path / "all.c").write_text(text + "int main(void) { return 0; }\n")
    sources = [f"{one.model.name}.c" for one in made]
    for one in made:
        for file in (tmp_path / one.model.name).glob("kanegen*.h"):
            file.replace(tmp_path / file.name)
    run(*C["gcc"], "-std=c99", *WARNINGS, "all.c", *sources, "-lm", "-o", "all", folder=tmp_path)


@pytest.mark.parametrize("name", ["chinese", "blank_and_underscore", "64_characters"])
def test_names_of_public_reports(name: str) -> None:
    """Names of links and joints stay as they are, and [A] is that of two equal links 1 m apart."""
    system = kg.load(FROM_REPORTS / f"{name}.urdf")
    expected = {
        "chinese": (("左腿", "右腿"), ("左髋", "右髋")),
        "blank_and_underscore": (("a b", "a_b"), ("j 1", "j_1")),
        "64_characters": (("a" * 64, "b"), ("j1", "j2")),
    }[name]
    assert tuple(body.name for body in system.bodies) == expected[0]
    assert system.freedom_names == expected[1]
    library = kg.build(system, ("mass_matrix", "body_poses"))
    assert (library.freedom_names, library.pose_names) == expected[::-1]
    np.testing.assert_allclose(library.mass_matrix([0.4, 0.3]), [[1.2, 0.1], [0.1, 0.1]], rtol=1e-15)


def test_random_text_is_harmless() -> None:
    """Quoted text of any characters ends no comment, no code span and no string."""
    draw = random.Random(5)
    pieces = [*string.punctuation, "*/", "/*", "??/", '"""', "\\", "`", "|", " ", "é", "左", "a"]
    for _ in range(3000):
        text = "".join(draw.choices(pieces, k=draw.randint(1, 12)))
        for made in (c_comment(text), c_name(text)):
            assert made.isascii() and "\\\n" not in made
            around = f"*{made}*"  # the neighbours of a comment
            assert "/*" not in made and "*/" not in made and "??" not in made, text
            assert around
        assert eval(f'"{python_text(text)}"') == text
        assert eval(f'"""a {python_text(text)} b"""') == f"a {text} b"
        code_span = markdown_code(text)
        fence = re.match("`+", code_span)
        assert fence and fence[0] not in code_span[len(fence[0]) : -len(fence[0])].replace(fence[0] + "`", "")
        assert not re.search(r"(?<!\\)[<>|`]", markdown(text))


def test_plain_names_stay_as_they_are() -> None:
    for text in ("arm.theta1", "l::x..y", "panda_joint1", "left leg (2)", "x**2/y + 3*z"):
        assert c_comment(text) == c_name(text) == text
        assert markdown_code(text) == f"`{text}`"
    assert markdown("eight_body") == "eight_body"
    assert c_name("y" * 1000) == f"{'y' * 240}...{'y' * 240}"
    assert unicodedata.category("\u200d") == "Cf" and check_label("a\u200db", "x") == "a\u200db"


def test_identifiers_in_the_documentation() -> None:
    text = Path("docs/model-files.md").read_text()
    name, made = re.findall(r"`(2dof-planar)` becomes `(\w+)`", text)[0]
    assert identifier(name) == made


def test_another_name(tmp_path: Path) -> None:
    armed(("a",), "2-link arm").save(tmp_path / "model.toml")
    arguments = ["generate", str(tmp_path / "model.toml"), "-o", str(tmp_path / "out")]
    done = CliRunner().invoke(app, [*arguments, "--name", "arm"], catch_exceptions=False)
    assert done.stdout.startswith("arm: 2 freedoms")
    assert (tmp_path / "out" / "arm.h").exists()
    assert kg.load(tmp_path / "model.toml").with_name("arm").identifier == "arm"
    with pytest.raises(kg.ModelError, match="system name: ' ' is blank"):
        kg.load(tmp_path / "model.toml").with_name(" ")
