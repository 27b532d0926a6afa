"""`kanegen info` on robot files: links, frames, limits, massless bodies, and what the reader left out."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

from kanegen import KanegenWarning, generate
from kanegen.cli.model_facts import model_facts
from kanegen.readers import load
from tests.support.command import kanegen
from tests.support.paths import PENDULUM
from tests.support.robots import robot_file
from tests.support.urdf import BASE, joint, link

LIMIT = '<limit lower="-1.5" upper="2" velocity="3" effort="87"/>'
ROBOT = f"""<robot name="r">{BASE}{link("a")}{link("b")}{link("tool", 0.5)}<link name="plate"/>
{joint("j", "base", "a", '<axis xyz="0 1 1"/>' + LIMIT)}
{joint("k", "a", "b", '<axis xyz="0 0 1"/><limit lower="0" upper="0" velocity="0" effort="5"/>')}
{joint("weld", "b", "tool", "", "fixed")}{joint("l", "b", "plate", '<axis xyz="1 0 0"/>', "continuous")}
</robot>"""


@pytest.fixture
def robot(tmp_path: Path) -> str:
    path = tmp_path / "r.urdf"
    path.write_text(ROBOT)
    return str(path)


def test_info_says_what_the_file_has_beside_the_equations(robot: str) -> None:
    done = kanegen("info", robot)
    text = done.stdout
    assert "2 frames fixed in bodies or in the ground: base in ground, tool in b" in text
    assert "1 body has another frame in the equations than in the file" in text
    assert "points and loads are in that of the file: a\n" in text
    assert "1 body has no mass: plate" in text
    assert "limits on 1 of 3 coordinates, 1 of 3 speeds, 2 of 3 efforts" in text
    assert (
        "limits that leave no motion or no effort are taken for none: 'k' (lower and upper, velocity)" in text
    )
    assert "warning" not in done.stderr


def test_what_is_selected_is_counted() -> None:
    """The operations are those of the output for these frames, contacts, points and loads alone."""
    options = ["--frames", "lower", "--contacts", "end:force1", "--points", "end=lower:0.3,0,0"]
    facts = json.loads(kanegen("info", PENDULUM, *options, "--loads", "end", "--json").stdout)
    system = load(PENDULUM).with_points({"end": ("lower", (0.3, 0, 0))}).with_loads("end")
    system = system.with_poses(["lower"]).with_contacts(["end:force1"])
    for output in ("body_poses", "forcing", "point_positions", "contact_forces"):
        assert facts["operations"][output] == dict(generate(system, (output,)).operations)
    assert "no body or frame 'lowe'" in kanegen("info", PENDULUM, "--frames", "lowe", status=2).stderr


def test_verbose_names_every_limit(robot: str) -> None:
    assert (
        "  j: position -1.5 to 2, speed 3, effort 87\n  k: effort 5\n"
        in kanegen("info", robot, "--verbose").stdout
    )


def test_json_has_all_of_it(robot: str) -> None:
    facts = json.loads(kanegen("info", robot, "--json").stdout)
    assert facts["frames"] == {"ground": ["base"], "b": ["tool"]}
    assert facts["turned"] == ["a"]
    assert facts["bodies_without_mass"] == ["plate"]
    assert facts["limits"] == {"j": {"position": [-1.5, 2], "speed": 3, "effort": 87}, "k": {"effort": 5}}
    assert any("taken for none" in line for line in facts["left_out"])


def test_every_name_of_a_frame_is_listed(robot: str) -> None:
    facts = json.loads(kanegen("info", robot, "--json").stdout)
    assert facts["other_names_of_frames"] == {"j": "a", "k": "b", "l": "plate", "weld": "tool"}
    named = {*facts["other_names_of_frames"], *(name for found in facts["frames"].values() for name in found)}
    with pytest.warns(KanegenWarning):
        system = load(robot)
    assert named | {body.name for body in system.bodies} == set(system.frame_names)
    text = kanegen("info", robot, "--verbose").stdout
    assert "4 frames have the place of another frame" in text
    assert "  weld is tool\n" in text


def test_a_narrow_terminal_cuts_no_name_in_a_table(tmp_path: Path) -> None:
    long_name = "the body at the end of the chain with a name of more than sixty letters"
    path = tmp_path / "m.toml"
    path.write_text(
        f'[[body]]\nname = "{long_name}"\nconnection = "ground"\nmass = 1\ninertia = [1, 1, 1]\n'
        "mass_center = [0.5, 0, 0]\njoint.orientation_angles = [0, 0, 1.5708]\n"
        "[[joint_friction]]\nfriction = 1\nsmoothing = 0.01\n"
        f'freedom = "{long_name}.theta1"\n'
    )
    lines = kanegen("info", str(path), COLUMNS="60").stdout.splitlines()
    assert any(re.match(r"\s*frame_bias_accelerations(\s+\d+){6}", line) for line in lines)
    assert any(re.match(rf"\s*{long_name}\s+\d\.\de", line) for line in lines)


@pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")
def test_a_humanoid_takes_a_few_lines_and_names_all_with_verbose() -> None:
    facts = model_facts(load(robot_file("talos_reduced"), floating_base=True), ())
    names = [name for found in facts.frames.values() for name in found]
    assert len(names) > 20
    short = list(facts.lines(verbose=False))
    assert len(short) <= 4
    assert max(map(len, short)) < 300
    assert not any(name in short[0] for name in names)
    every = "\n".join(facts.lines(verbose=True))
    assert all(name in every for name in names)


def test_outputs_that_are_counted_on_request_are_named() -> None:
    facts = json.loads(kanegen("info", PENDULUM, "--json").stdout)
    assert {"error_bound", "forward_dynamics_derivatives"} <= set(facts["outputs"]) - facts[
        "operations"
    ].keys()
    text = kanegen("info", PENDULUM).stdout
    assert "further outputs, counted with --all: error_bound, " in text
    counted = json.loads(kanegen("info", PENDULUM, "--json", "--all").stdout)
    assert counted["outputs"] == facts["outputs"]
    assert counted["operations"]["error_bound"]["multiply"] > 0
    assert counted["operations"]["forward_dynamics_derivatives"]["divide"] > 0


def test_an_error_comes_after_the_warnings_of_its_file(robot: str) -> None:
    done = kanegen("info", robot, "--lock", "nothing=1", status=2)
    assert "warning: " in done.stderr
    assert done.stderr.splitlines()[-1].startswith("error: locked: there is no freedom 'nothing'")


def test_functions_and_comparisons_are_counted_in_columns_of_their_own(tmp_path: Path) -> None:
    path = tmp_path / "m.toml"
    path.write_text(
        '[[body]]\nname = "arm"\nconnection = "ground"\nmass = 1\nmass_center = [0.5, 0, 0]\n'
        'joint.free = ["theta2"]\n[[joint_friction]]\nfreedom = "arm.theta2"\nfriction = 1\n'
        'smoothing = 0.01\n[[drive]]\nfreedom = "arm.theta2"\neffort = "max(0, -x.arm.theta2)"\n'
    )
    lines = kanegen("info", str(path)).stdout.splitlines()
    counts = json.loads(kanegen("info", str(path), "--json").stdout)["operations"]
    (head,) = (line.split() for line in lines if "multiply" in line)
    assert head == ["add", "multiply", "divide", "sqrt", "sincos", "compare", "function", "prepare"]
    for name in ("mass_matrix", "forcing"):
        (row,) = (line.split()[1:] for line in lines if re.match(rf"\s*{name}\s+\d", line))
        assert row == [str(counts[name].get(kind, 0)) for kind in head]
    assert counts["forcing"]["function"] == counts["forcing"]["compare"] == 1
    passes = [line.split() for line in lines if "this after" in line]
    assert passes
    assert all(row[-2:] == ["1", "1"] for row in passes)


@pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")
def test_freedoms_have_the_names_of_the_file_everywhere(tmp_path: Path) -> None:
    path = tmp_path / "m.toml"
    path.write_text(
        "".join(
            f'[[body]]\nname = "{body}"\nconnection = "{lower}"\nmass = 1\nmass_center = [0.5, 0, 0]\n'
            f'inertia = [0.1, 0.1, 0.1]\njoint.free = ["theta2"]\njoint.name = "{joint}"\n'
            for body, lower, joint in (
                ("arm", "ground", "q"),
                ("hand", "arm", "my wrist"),
                ("tip", "hand", "r"),
            )
        )
        + '[[rotor]]\nname = "motor"\nfreedom = "arm.theta2"\naxis = [0, 1, 0]\ninertia = 1e-4\nratio = 100\n'
        '[[joint_spring]]\nfreedom = "q"\nstiffness = 2\n[[joint_friction]]\nfreedom = "my wrist"\n'
        'friction = 1\nsmoothing = 0.01\n[[drive]]\nfreedom = "arm.theta2"\n'
        """effort = 'sin(x["my wrist"]) + y.hand.theta2 + t'\n"""
        '[[coupling]]\nfreedom = "tip.theta2"\nterms = {q = 2}\n'
    )
    done = kanegen("info", str(path))
    facts = json.loads(kanegen("info", str(path), "--json").stdout)
    for text in (done.stdout, json.dumps([facts[key] for key in ("rotors", "couplings", "force_elements")])):
        assert not any(f"{body}.theta2" in text for body in ("arm", "hand", "tip"))
    assert "turns 100.0 times q\n" in done.stdout
    assert 'drive: freedom = q, effort = sin(x["my wrist"]) + y["my wrist"] + t' in done.stdout
    assert "joint_friction: freedom = my wrist" in done.stdout
    assert "r = 2.0 q" in done.stdout
    assert facts["couplings"] == [{"freedom": "r", "terms": {"q": 2.0}}]
    system = load(path)
    assert system == replace(system, force_elements=system.named_force_elements, rotors=system.named_rotors)
