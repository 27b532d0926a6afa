"""The joint as an extension point: one description, which a few modules turn into mathematics.

A new kind of joint is a class beside `AxisRotations` and `QuaternionRotation`, the coordinates that it adds
to `COORDINATE_KINDS`, and one formula in each independent derivation. All other modules read tables.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from kanegen.model.coordinates import COORDINATE_KINDS, FREEDOMS, SEQUENCES, SPEED_KINDS
from kanegen.model.joint import Joint
from tests.support.joint_kinds import JOINT_KINDS
from tests.support.paths import ROOT

ELSEWHERE = {
    "model/rotations.py": "quaternions in a robot file, which become a constant orientation",
    "readers/urdf_elements.py": "the same",
    "interop/orientations.py": "quaternions of other programs",
    "readers/mjcf_compiled.py": "the same in a model that MuJoCo has compiled",
    "readers/mjcf_tree.py": "names of the coordinates in such a model",
}
"""Modules that are about quaternions, but not about a kind of joint."""

_IDENTIFIER = re.compile("quaternion", re.IGNORECASE)
_CHOICES = {"quaternion", "angles", "angle_rates", "angular_velocity"}


def _identifiers(tree: ast.AST) -> Iterator[str]:
    for node in ast.walk(tree):
        for field in ("id", "attr", "name", "asname", "arg"):
            name = getattr(node, field, None)
            if isinstance(name, str):
                yield name


def _compared_strings(tree: ast.AST) -> Iterator[str]:
    """Yield the strings that a comparison, a pattern or an argument of `count` or `index` contains."""
    for node in ast.walk(tree):
        inspected: list[ast.AST] = []
        if isinstance(node, ast.Compare | ast.MatchValue):
            inspected = [node]
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            inspected = list(node.args) if node.func.attr in ("count", "index") else []
        for part in inspected:
            yield from (
                one.value
                for one in ast.walk(part)
                if isinstance(one, ast.Constant) and isinstance(one.value, str)
            )


def knows_a_kind(path: Path) -> bool:
    """Return whether a module names a kind of joint or branches on the choice of one."""
    tree = ast.parse(path.read_text())
    named = any(_IDENTIFIER.search(name) for name in _identifiers(tree))
    return named or not _CHOICES.isdisjoint(_compared_strings(tree))


def test_at_most_ten_modules_know_a_kind_of_joint() -> None:
    package = ROOT / "kanegen"
    found = {str(p.relative_to(package)) for p in package.rglob("*.py") if knows_a_kind(p)}
    # The table of meanings has lines of text for the names of a kind, where nothing branches on it.
    assert found - ELSEWHERE.keys() == JOINT_KINDS.keys() - {"recursion/meanings.py"}
    assert len(JOINT_KINDS) <= 10


def test_the_documentation_lists_these_modules() -> None:
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    table = text[text.index("**Joint**") : text.index("**Output**")]
    assert re.findall(r"^\| `kanegen/([\w/]+\.py)` \|", table, re.MULTILINE) == list(JOINT_KINDS)


@pytest.mark.parametrize(
    "source",
    [
        "from kanegen.model.coordinates import QuaternionRotation",
        "turn = by_quaternion(x) if joint.rotation else None",
        "if joint.coordinates == 'quaternion': pass",
        "m = n + system.coordinates.count('quaternion')",
        "match joint.speeds:\n    case 'angular_velocity': pass",
    ],
)
def test_the_search_finds_what_branches_on_a_kind(source: str, tmp_path: Path) -> None:
    path = tmp_path / "module.py"
    path.write_text(source)
    assert knows_a_kind(path)


def test_the_tables_hold_each_symbol_once() -> None:
    symbols = [(kind.symbol, kind.number) for kind in COORDINATE_KINDS]
    speeds = [(kind.symbol, kind.number) for kind in SPEED_KINDS]
    assert len(set(symbols)) == len(symbols)
    assert len(set(speeds)) == len(speeds)
    assert [kind.name for kind in COORDINATE_KINDS[:6]] == list(FREEDOMS)
    assert [kind.name for kind in SPEED_KINDS[:6]] == list(FREEDOMS)
    assert all(kind.is_rate for kind in SPEED_KINDS[:6])


def test_a_joint_says_what_stands_in_x_and_y() -> None:
    angles = Joint(free=(True, True, True, False, True, False))
    assert angles.coordinate_kinds == (0, 1, 2, 3, 4, 5)
    assert angles.free_coordinate_kinds == (0, 1, 2, 4)
    assert angles.speed_kinds == (0, 1, 2, 3, 4, 5)
    quaternion = Joint(free=angles.free, coordinates="quaternion")
    assert quaternion.free_coordinate_kinds == (6, 7, 8, 9, 4)
    assert quaternion.speed_kinds == (6, 7, 8, 3, 4, 5)
    assert [COORDINATE_KINDS[kind].name for kind in quaternion.free_coordinate_kinds][:4] == [
        "e0",
        "e1",
        "e2",
        "e3",
    ]


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_gimbal_lock_is_where_the_first_axis_meets_the_last(sequence: str) -> None:
    first, _, last = SEQUENCES[sequence]
    joint = Joint(sequence=sequence)
    assert joint.gimbal_lock == ("sin" if first == last else "cos")
    assert joint.mass_matrix_singularity == joint.gimbal_lock
    assert Joint(sequence=sequence, speeds="angular_velocity").mass_matrix_singularity is None
    assert Joint(sequence=sequence, free=(True, True, False) * 2).gimbal_lock is None


def test_a_quaternion_has_no_gimbal_lock() -> None:
    assert Joint(coordinates="quaternion").gimbal_lock is None
