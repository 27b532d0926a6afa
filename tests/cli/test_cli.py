"""The command line: output, exit status, and errors of one line."""

from __future__ import annotations

import io
import json
import math
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

import kanegen as kg
from kanegen.cli.loading import load_system, with_places
from kanegen.cli.summary import summarize
from kanegen.cli.summary_text import show
from kanegen.model.numbers import value_of
from kanegen.options import quiet
from tests.support import systems
from tests.support.command import kanegen, process
from tests.support.paths import MODELS, PENDULUM


def test_help_names_every_command() -> None:
    text = process("--help").stdout
    for command in ("generate", "verify", "check", "bound", "equations", "info", "bench", "tradeoff"):
        assert command in text
    assert "--version" in text
    assert "Exit status" in text


@pytest.mark.parametrize("command", ["generate", "check", "bound", "equations", "info", "bench", "tradeoff"])
def test_every_command_has_help(command: str) -> None:
    assert "MODEL" in kanegen(command, "--help").stdout


def test_version() -> None:
    assert process("--version").stdout.startswith("kanegen 0.")


@pytest.mark.parametrize(
    "arguments",
    [
        ("info",),
        pytest.param(("equations",), marks=pytest.mark.slow),
        pytest.param(("equations", "--format", "latex"), marks=pytest.mark.slow),
    ],
)
def test_a_terminal_without_unicode(arguments: tuple[str, ...]) -> None:
    text = process(*arguments, PENDULUM, PYTHONIOENCODING="ascii").stdout
    assert text.isascii()


def test_info_draws_every_body_of_a_long_chain() -> None:
    """Operation counts are those of one body, so that only the drawing of the tree is long."""
    screen = Console(width=60, file=io.StringIO())
    costs = summarize(systems.chain(1, ["theta2"]), quiet)
    show(replace(costs, system=systems.chain(24, ["theta2"])), screen)
    text = screen.file.getvalue()
    assert text.count("└── ") == 24
    assert f"{' ' * 4 * 23}└── 24 body24  theta2" in text


def test_generate_writes_and_names_the_files(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    text = process("generate", PENDULUM, "-o", str(folder)).stdout
    assert "double_pendulum: 2 freedoms, mass_matrix and forcing" in text
    assert "operations: add" in text
    assert {"double_pendulum.h", "double_pendulum.c", "main.c", "README.md"} <= {
        p.name for p in folder.iterdir()
    }
    kanegen("generate", PENDULUM, "-o", str(folder))  # its own files may be renewed


def test_generate_one_output(tmp_path: Path) -> None:
    kanegen("generate", PENDULUM, "-o", str(tmp_path / "a"), "--output", "forcing")
    header = (tmp_path / "a" / "double_pendulum.h").read_text()
    assert "double_pendulum_forcing" in header
    assert "double_pendulum_mass_matrix" not in header


def test_outputs_are_separated_by_commas_or_repeated(tmp_path: Path) -> None:
    texts = ("--output", "forcing,kinetic_energy", "--output", "momentum")
    kanegen("generate", PENDULUM, "-o", str(tmp_path), *texts)
    header = (tmp_path / "double_pendulum.h").read_text()
    for name in ("forcing", "kinetic_energy", "momentum"):
        assert f"double_pendulum_{name}(" in header
    assert "double_pendulum_mass_matrix(" not in header


def test_lock_takes_freedoms_out_of_the_model() -> None:
    found = json.loads(kanegen("info", PENDULUM, "--lock", "q1 = -0.3", "--json").stdout)
    assert [freedom["name"] for freedom in found["freedoms"]] == ["q2"]


def test_locks_and_points_are_expressions_of_numbers_and_parameters() -> None:
    system = with_places(
        load_system(Path(PENDULUM), lock=["q1=-atan2(1, l1)/2"]), ["tip=lower:l2,0,-1/10"], None
    )
    joint = system.bodies[0].joint
    assert [value_of(one) for one in joint.locked if value_of(one)] == [-math.atan2(1, 1.0) / 2]
    ((_, tip),) = system.points
    assert [value_of(one) for one in tip.position] == [0.7, 0.0, -0.1]


@pytest.mark.parametrize(
    ("lock", "message"),
    [
        (("q1",), "--lock: 'q1' is not NAME=VALUE, such as elbow=0.3."),
        (("q1=",), "--lock: 'q1=' is not NAME=VALUE"),
        (("q1=a",), "--lock q1: expression 'a': there is no parameter of this name"),
        (("q1=x.q2",), "--lock q1: expression 'x.q2': a number of a model depends on parameters"),
        (("q1=1/0",), "--lock q1: '1 / 0' divides by zero"),
        (("q1=1", "q1=2"), "--lock: 'q1' is locked twice. Lock it once."),
        (("q3=1",), "locked: there is no freedom 'q3'. Known are 'q1', 'q2'."),
        (("q1=1", "q2=1"), "has no free freedom: every joint is locked"),
    ],
)
def test_a_wrong_lock_is_one_line(lock: tuple[str, ...], message: str) -> None:
    options = [word for text in lock for word in ("--lock", text)]
    result = kanegen("info", PENDULUM, *options, status=2)
    assert message in result.stderr
    assert result.stderr.count("\n") == 1


def test_check_passes_and_prints_json() -> None:
    assert "passed" in process("check", PENDULUM, "--states", "50").stdout
    report = json.loads(kanegen("check", PENDULUM, "--states", "50", "--json").stdout)
    assert report["passed"] is True


def test_check_draws_all_programs(tmp_path: Path) -> None:
    file = tmp_path / "programs.svg"
    text = kanegen("check", PENDULUM, "--states", "8", "--plot", str(file)).stdout
    for name in ("closed form", "definitions in NumPy", "reference", "C in single precision"):
        assert name in text and name in file.read_text(encoding="utf-8")
    report = kanegen("check", PENDULUM, "--states", "8", "--plot", str(file), "--json").stdout
    assert json.loads(report)["passed"] is True
    wrong = kanegen("check", PENDULUM, "--plot", str(tmp_path / "a.png"), status=2)
    assert "a.png does not end in .svg" in wrong.stderr
    missing = kanegen("check", PENDULUM, "--plot", str(tmp_path / "no" / "a.svg"), status=2)
    assert "cannot be written" in missing.stderr


WRONG = """
import sys, kanegen.compiler as compiler
from kanegen.cli import main
from kanegen.reference import equations as reference
right = reference.forcing
import kanegen.library as library
forcing = library.Library.forcing
library.Library.forcing = lambda self, *args, **keys: forcing(self, *args, **keys) * (1 + 1e-9)
sys.argv = ["kanegen", "check", sys.argv[1], "--states", "20"]
main()
"""


def test_check_fails_with_status_1() -> None:
    done = subprocess.run(
        [sys.executable, "-c", WRONG, PENDULUM], capture_output=True, text=True, check=False
    )
    assert done.returncode == 1, done.stderr
    assert "failed" in done.stdout.lower()


@pytest.mark.parametrize(
    ("form", "expected"),
    [("text", "A"), ("markdown", "$$"), ("latex", r"\begin{"), ("python", "import numpy")],
)
def test_equations(form: str, expected: str) -> None:
    assert expected in kanegen("equations", PENDULUM, "--format", form).stdout


def test_info_draws_the_tree() -> None:
    text = kanegen("info", PENDULUM).stdout
    for part in (
        "ground",
        "q1 (rad)",
        "mass_matrix",
        "forcing",
        "this after prune",
        "mass_matrix by composite bodies",
        "m1",
    ):
        assert part in text


def test_info_says_what_passes_save_and_leaves_them_out() -> None:
    assert "passes saved: fold " in kanegen("info", PENDULUM).stdout
    text = kanegen("info", PENDULUM, "--without", "fold", "--without", "prune").stdout
    assert "this after factor" in text
    assert "this after fold" not in text
    facts = json.loads(kanegen("info", PENDULUM, "--without", "factor", "--json").stdout)
    assert set(facts["saved"]) == {"fold", "prune"}
    totals = [sum(stage["operations"].values()) for stage in facts["passes"]]
    assert totals[0] - totals[-1] == sum(facts["saved"].values())


def test_info_as_json() -> None:
    facts = json.loads(kanegen("info", str(MODELS / "six_revolute_arm.toml"), "--json").stdout)
    assert [body["connection"] for body in facts["bodies"]] == [0, 1, 2, 3, 4, 5]
    assert len(facts["freedoms"]) == 6
    operations = facts["operations"]["mass_matrix + forcing"]
    assert operations["add"] + operations["multiply"] <= 1000


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("info", "nowhere.toml"), "nowhere.toml"),
        (("info", "model.yaml"), "reads .toml, .urdf and .xml"),
        (("equations", PENDULUM, "--format", "word"), "format"),
        (("generate", PENDULUM, "-o", "x", "--output", "forcin"), "Did you mean 'forcing'"),
        (("generate", PENDULUM, "-o", "/proc/nowhere/x"), "/proc/nowhere"),
        (("generate", PENDULUM, "-o", "x", "--without", "factr"), "Did you mean 'factor'?"),
        (("check", PENDULUM, "--floating-base"), "floating_base"),
        (("generate", PENDULUM, "-o", "x", "--poses", "lower"), "--frames: only with --output body_poses or"),
        (("check", PENDULUM, "--points", "tip=lower"), "--points: 'tip=lower' is not NAME=FRAME:X,Y,Z"),
        (("check", PENDULUM, "--points", "tip=lower:1,2,h"), "--points tip: expression 'h': there is no"),
        (("check", PENDULUM, "--points", "tip=lower:1,2"), "point 'tip': expected 3 numbers, got 2 entries"),
        (("check", PENDULUM, "--points", "tip=hand:1,2,3"), "point 'tip': there is no body or frame 'hand'"),
        (
            ("check", PENDULUM, "--loads", ""),
            "loads: none is chosen. Name one, or leave the choice out to add none",
        ),
        (
            ("explain", PENDULUM, "--output", "frame_jacobians", "--frames", "loer"),
            "error: frames: there is no",
        ),
        (("check", PENDULUM, "--loads", "tip"), "loads: there is no body or frame 'tip'"),
        (("explain", PENDULUM, "--output", "body_poses", "--poses", "lwer"), "Did you mean 'lower'?"),
        (
            ("generate", PENDULUM, "-o", "x", "--output", "reaction_loads", "--reactions", "lower.theta3"),
            "'lower.theta3' is free",
        ),
        (
            ("generate", PENDULUM, "-o", "x", "--output", "contact_forces", "--contacts", "lowr"),
            "contacts: there is no contact, point, frame or body 'lowr'. Did you mean 'lower'?",
        ),
        (
            ("generate", PENDULUM, "-o", "x", "--output", "contact_forces", "--contacts", "lower"),
            "contacts: 'lower.moment1' cannot be held, because in every state, but for rounding errors, no",
        ),
        (
            ("generate", PENDULUM, "-o", "x", "--contacts", "lower"),
            "--contacts: only with --output contact_d",
        ),
    ],
)
def test_bad_input_is_one_line_and_status_2(arguments: tuple[str, ...], message: str) -> None:
    done = kanegen(*arguments, status=2)
    assert message in done.stderr
    assert done.stderr.count("\n") == 1


def test_frames_points_and_loads(tmp_path: Path) -> None:
    outputs = ("--output", "forcing", "--output", "frame_jacobians", "--output", "point_positions")
    about = ("--frames", "lower", "--points", "tip=lower:0.7,0,0", "--loads", "tip, upper")
    kanegen("generate", PENDULUM, "-o", str(tmp_path), *outputs, *about)
    header = (tmp_path / "double_pendulum.h").read_text()
    for array in (
        "frame_jacobians[1 * 6 * 2]",
        "point_positions[1 * 3]",
        "point_force[1 * 3]",
        "force[2 * 3]",
    ):
        assert array in header


def test_poses_and_reactions_are_selected(tmp_path: Path) -> None:
    outputs = ("--output", "body_poses", "--output", "reaction_loads")
    about = ("--poses", "lower", "--reactions", "lower.s1, upper.s2")
    kanegen("generate", PENDULUM, "-o", str(tmp_path), *outputs, *about)
    header = (tmp_path / "double_pendulum.h").read_text()
    assert "0  lower.s1  N\n *     1  upper.s2  N\n" in header
    assert "double body_poses[1 * 4 * 3]" in header
    rest = json.loads(kanegen("explain", PENDULUM, *outputs, *about, "--json").stdout)["steps"][-1]["total"]
    assert rest < json.loads(kanegen("explain", PENDULUM, *outputs, "--json").stdout)["steps"][-1]["total"]


def test_contacts_are_selected(tmp_path: Path) -> None:
    """A contact of the model keeps its directions, and its rows stand in the header."""
    model = tmp_path / "held.toml"
    system = kg.load(PENDULUM).with_points({"tip": ("lower", (0.7, 0, 0)), "middle": ("lower", (0.3, 0, 0))})
    held = [kg.Contact(name, point=name, directions=("force1",)) for name in ("middle", "tip")]
    system.with_contacts(held).save(model)
    outputs = ("--output", "contact_dynamics", "--output", "contact_forces")
    kanegen("generate", str(model), "-o", str(tmp_path / "c"), *outputs, "--contacts", "tip")
    header = (tmp_path / "c" / "double_pendulum.h").read_text()
    assert "tip: holds point tip by force1\n" in header
    assert "0  tip.force1  N\n" in header
    assert "middle.force1" not in header
    assert "double contact_force[1]" in header
    told = kanegen("info", str(model)).stdout
    assert "middle: holds point middle by force1" in told
    assert json.loads(kanegen("info", str(model), "--json").stdout)["operations"]["contact_forces"]


def test_unknown_command_and_missing_folder_get_usage() -> None:
    assert "No such command" in kanegen("generat", status=2).stderr
    assert "--output-dir" in kanegen("generate", PENDULUM, status=2).stderr


def test_missing_compiler() -> None:
    done = process("check", PENDULUM, status=2, KANEGEN_CC="no-such-compiler")
    assert "no-such-compiler" in done.stderr


def test_an_error_is_not_lost_below_long_warnings(tmp_path: Path) -> None:
    names = [f"body_with_a_long_name_{k}" for k in range(20)]
    model = tmp_path / "m.toml"
    model.write_text(
        f"[parameters]\n{''.join(f'{name} = 1.0' + chr(10) for name in names)}"
        '[[body]]\nname = "b"\nconnection = "ground"\nmass = 1\n'
    )
    failed = kanegen("equations", str(model), "--lock", "c=0", status=2)
    warning, error = failed.stderr.splitlines()
    assert warning.startswith("warning: ")
    assert len(warning) < 140
    assert error.startswith("error: locked: there is no freedom 'c'")
    (warning,) = kanegen("equations", str(model)).stderr.splitlines()
    assert all(name in warning for name in names)


def test_warnings_are_one_line(tmp_path: Path) -> None:
    model = tmp_path / "rod.toml"
    model.write_text(
        'name = "rod"\n[[body]]\nname = "rod"\nconnection = 0\nmass = 1.0\ninertia = [1.0, 1.0, 3.0]\n'
    )
    done = kanegen("info", str(model))
    assert "triangle inequality" in done.stderr
    assert done.stderr.count("warning: body 'rod'") == 1
