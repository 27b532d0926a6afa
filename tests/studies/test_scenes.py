"""The models in models/ have the properties that they describe, and docs/models shows their present costs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

import kanegen as kg
from benchmarks import cost_reports, scenes
from kanegen.cli.app import app
from kanegen.compiler import compile_module
from kanegen.model.limits import NO_LIMITS
from kanegen.studies.explain import cost_report
from kanegen.studies.explain.tables import markdown
from tests.support.cases import slow_among
from tests.support.robots import robot_file

LARGE = {"eight_body", "front_of_eight", "panda_arm", "six_revolute_arm"}
"""Models whose general programs take seconds each."""

SMALL = [model for model in cost_reports.MODELS if model.stem not in LARGE]
MEDIUM = [model for model in SMALL if model.stem in ("scara", "gantry_crane", "cart_two_poles")]
FIXED = (False,) * 6


def written(name: str) -> str:
    return (cost_reports.DOCS / name).read_text(encoding="utf-8")


def index_row(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |\n"


def require_current(model: Path) -> None:
    found = cost_report(kg.load(model), cost_reports.outputs(model))
    assert written(f"{model.stem}.md") == cost_reports.page(model, found), (
        "run `make cost-reports`, if that is meant"
    )
    assert index_row(cost_reports.line(model, found)) in written("README.md")


@pytest.mark.parametrize("model", slow_among(SMALL, *MEDIUM), ids=lambda path: path.stem)
def test_pages_are_current(model: Path) -> None:
    require_current(model)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(LARGE))
def test_large_pages_are_current(name: str) -> None:
    require_current(cost_reports.ROOT / "models" / f"{name}.toml")


@pytest.mark.parametrize("name", sorted(LARGE))
def test_large_pages_count_what_the_scene_costs(name: str) -> None:
    """Count the operations of the specialised program alone."""
    model = cost_reports.ROOT / "models" / f"{name}.toml"
    operations = compile_module(kg.load(model), cost_reports.outputs(model)).operations
    total = sum(operations.values()) - operations["prepare"]
    assert f"**{total} operations** where" in written(f"{name}.md")


def test_every_model_has_a_page_and_every_scene_a_model() -> None:
    pages = {path.stem for path in cost_reports.DOCS.glob("*.md")} - {"README"}
    assert pages == {model.stem for model in cost_reports.MODELS}
    assert len(scenes.SCENES) == 5
    assert {scene.name for scene in scenes.SCENES} <= pages
    for model in cost_reports.MODELS:
        paragraph, *_ = cost_reports.description(model)
        assert len(paragraph) > 80  # says what it is
        assert paragraph in written(f"{model.stem}.md")


def test_the_command_writes_the_same_page(tmp_path: Path) -> None:
    model = cost_reports.ROOT / "models" / "satellite.toml"
    options = ("--output", "momentum", "--output", "kinetic_energy", "--markdown", str(tmp_path / "page.md"))
    done = CliRunner().invoke(app, ["explain", str(model), *options])
    assert done.exit_code == 0
    found = cost_report(kg.load(model), cost_reports.outputs(model))
    assert (tmp_path / "page.md").read_text() == markdown(found)
    assert markdown(found).split("\n\n")[-1] in written("satellite.md")
    for option in ("--html", "--markdown"):
        refused = CliRunner().invoke(app, ["explain", str(model), option, "page.txt"])
        assert isinstance(refused.exception, kg.OptionError)
        assert f"{option}: page.txt does not end in ." in str(refused.exception)


@pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")
def test_the_panda_arm_is_the_robot_with_a_locked_gripper() -> None:
    """The models agree to the last bit."""
    robot = kg.load(robot_file("panda")).with_locked({"panda_finger_joint1": 0.0})
    bodies = tuple(replace(body, joint=replace(body.joint, limits=NO_LIMITS)) for body in robot.bodies)
    arm = replace(robot, name="panda_arm", bodies=bodies, frames=())
    arm = arm.with_points({"tool": ("panda_link7", (0.0, 0.0, 0.21))})
    assert kg.load("models/panda_arm.toml") == arm
    assert len(arm.freedoms) == 7


def test_the_front_of_eight_is_the_tree_of_the_notes() -> None:
    eight = kg.load("models/eight_body.toml")
    welded = tuple(
        replace(body, loads=False, joint=body.joint if k < 3 else replace(body.joint, free=FIXED))
        for k, body in enumerate(eight.bodies)
    )
    assert kg.load("models/front_of_eight.toml") == replace(eight, name="front_of_eight", bodies=welded)
