"""Errors in TOML model files: one message for each, beginning with the file."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from kanegen.errors import OptionError, ReadError
from kanegen.readers import load
from tests.support.toml_models import ONE_BODY, read_toml


def with_joint(line: str) -> str:
    return f"{ONE_BODY}joint.{line}\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"a model needs bodies: begin each with a line \[\[body\]\]"),
        ("[body]\nmass = 1\n", r"a model needs bodies"),
        ("body = [1]\n", r"a model needs bodies"),
        ("nme = 'a'\n" + ONE_BODY, r"unknown key 'nme'\. Did you mean 'name'\?"),
        ("name = ' '\n" + ONE_BODY, r"system name: ' ' is blank"),
        ("gravity = [0, 1]\n" + ONE_BODY, r"gravity: expected 3 numbers, got 2 entries"),
        ("parameters = 3\n" + ONE_BODY, r"parameters: write a table, \[parameters\]"),
        ("parameters = {a-b = 1}\n" + ONE_BODY, r"parameter name: 'a-b' cannot be used"),
        (
            "parameters = {a = 'x'}\n" + ONE_BODY,
            r"parameter 'a': a string stands for .*there is no 'x'",
        ),
        ("outputs = ['body_poses']\n" + ONE_BODY, r"outputs: write a table, \[outputs\]"),
        ("[outputs]\nbodyposes = []\n" + ONE_BODY, r"outputs: unknown key .* Did you mean 'body_poses'\?"),
        (
            "[outputs]\nbody_poses = ['c']\n" + ONE_BODY,
            r"frames: there is no body or frame 'c'\. Known are 'b'",
        ),
        ("[outputs]\nbody_poses = []\n" + ONE_BODY, r"frames: none is chosen"),
        ("[outputs]\nreaction_loads = ['b.s1']\n" + ONE_BODY, r"reaction loads: 'b\.s1' is free; its effort"),
        (ONE_BODY + "inertai = 1\n", r"body 'b': unknown key 'inertai'\. Did you mean 'inertia'\?"),
        (ONE_BODY + "q = 1\n", r"body 'b': unknown key 'q'\. Known are 'name', 'connection', 'mass', "),
        ("[[body]]\nmass = 1\n", r"body 'body1': connection is missing"),
        ("[[body]]\nconnection = 0\n", r"body 'body1': mass is missing"),
        ("[[body]]\nname = 'a\tb'\nconnection = 0\nmass = 1\n", r"body name: 'a\\tb' contains the invisible"),
        ("[[body]]\nname = 3\nconnection = 0\nmass = 1\n", r"body name: 3 is not a string"),
        (ONE_BODY + ONE_BODY, r"body name 'b' is used twice"),
        (
            "[[body]]\nconnection = 'a'\nmass = 1\n",
            r"connection: 'a' is no earlier body\. Known are 'ground'",
        ),
        (ONE_BODY + "[[body]]\nconnection = 'bb'\nmass = 1\n", r"body 'body2': .* Known are 'ground', 'b'\."),
        ("[[body]]\nconnection = 1\nmass = 1\n", r"body 1 is connected to the ground"),
        (ONE_BODY + "[[body]]\nconnection = 3\nmass = 1\n", r"lower body 3 of body 2 is out of range 0\.\.1"),
        ("[[body]]\nconnection = 0.0\nmass = 1\n", r"body 'body1': connection: 0\.0 is not an integer"),
        ("[[body]]\nconnection = true\nmass = 1\n", r"connection: True is not an integer"),
        ("[[body]]\nconnection = 0\nmass = -1\n", r"body 'body1': mass -1\.0 kg is negative"),
        ("[[body]]\nconnection = 0\nmass = nan\n", r"body 'body1': mass: nan is not finite"),
        ("[[body]]\nconnection = 0\nmass = 'm'\n", r"mass: a string .* no 'm'\. None is known"),
        ("parameters = {mass1 = 1}\n" + ONE_BODY.replace("= 1", "= 'mas1'"), r"Did you mean 'mass1'\?"),
        (ONE_BODY + "mass_center = [1, 2]\n", r"body 'b': mass centre: expected 3 numbers, got 2 entries"),
        (ONE_BODY + "inertia = [1, 2]\n", r"body 'b': inertia: expected 3 numbers, got 2 entries"),
        (ONE_BODY + "inertia = 1\n", r"body 'b': inertia: expected 3 x 3 table of numbers, got 1"),
        (ONE_BODY + "inertia = {xx = 1, yy = 1}\n", r"body 'b': zz is missing"),
        (ONE_BODY + "inertia = {xx = 1, yy = 1, zz = 1, yx = 1}\n", r"unknown key 'yx'"),
        (ONE_BODY + "inertia = [[1, 2, 0], [3, 1, 0], [0, 0, 1]]\n", r"body 'b': inertia is not symmetric"),
        (ONE_BODY + "inertia = [1, -1, 1]\n", r"body 'b': inertia is not positive semidefinite"),
        (ONE_BODY + "loads = 1\n", r"body 'b': loads: 1 is not true or false"),
        (ONE_BODY + "joint = 'hinge'\n", r"body 'b': joint: write a table \[body\.joint\]"),
        (with_joint("fre = 'all'"), r"body 'b': joint: unknown key 'fre'\. Did you mean 'free'\?"),
        (
            with_joint('name = "a\\n"'),
            r"body 'b': joint name: 'a\\n' contains the invisible character U\+000A",
        ),
        (with_joint("position = 1"), r"body 'b': joint position: expected 3 numbers, got 1"),
        (with_joint("free = 'theta1'"), r"free: 'theta1' is neither \"all\" nor \"none\" nor a list"),
        (with_joint("free = ['theta4']"), r"free: 'theta4' is no freedom\. Known are 'theta1', "),
        (with_joint("free = [5]"), r"free: 5 is no freedom\. Known are 'theta1', "),
        (with_joint("free = ['s1', 's1']"), r"free: freedom 's1' is used twice"),
        (with_joint("free = 'none'"), r"system 'model' has no free freedom"),
        (with_joint("locked = 1"), r"locked: write a table such as"),
        (with_joint("locked = {thta1 = 1}"), r"locked: unknown key 'thta1'\. Did you mean 'theta1'\?"),
        (with_joint("locked = {s1 = 1}"), r"locked: 's1' is free\. Delete it here"),
        (with_joint("orientation = [0, 0, 1]"), r"orientation\[0\]: expected 3 numbers, got 0"),
        (with_joint("orientation = [[1,0,0],[0,1,0],[0,0,2]]"), r"joint orientation is not a rotation"),
        (
            with_joint("orientation_angles = [[1,0,0],[0,1,0],[0,0,1]]"),
            r"orientation_angles\[0\]: .* not a number",
        ),
        ("gravity = 'non'\n" + ONE_BODY, r"gravity: a string stands for a parameter, but there is no 'non'"),
        (ONE_BODY + "points = {p = {position = [0, 0, 0], load = true}}\n", r"point 'p': unknown key 'load'"),
        (ONE_BODY + "points = {p = {loads = true}}\n", r"point 'p': position is missing"),
        (
            ONE_BODY + "points = {p = {position = [0, 0, 0], loads = 1}}\n",
            r"point 'p': 1 is not true or false",
        ),
        (ONE_BODY + "[spring]\n", r"spring: begin each with a line \[\[spring\]\]"),
        (ONE_BODY + "[[spring]]\nstiffness = 1\n", r"spring 1: between is missing"),
        (
            ONE_BODY + "[[spring]]\nbetween = ['p', 'p']\nstiffness = 1\n",
            r"spring 1: spring between 'p' and itself",
        ),
        (
            ONE_BODY
            + "points = {p = [0, 0, 0], q = [1, 0, 0]}\n[[spring]]\nbetween = ['p', 'q']\nstiffness = 1\n",
            r"spring 1 between 'p' and 'q': both ends are on one body",
        ),
        (
            ONE_BODY + "[[spring]]\nbetween = ['p', [0, 0, 0]]\nstiffness = 1\n",
            r"there is no point or frame 'p'",
        ),
        (
            ONE_BODY + "[[spring]]\nbetween = [[0, 0, 1], [0, 0, 'h']]\nstiffness = 1\n",
            r"spring 1: .* no 'h'",
        ),
        (ONE_BODY + "[[joint_spring]]\nfreedom = 'b.s1'\nstifness = 1\n", r"Did you mean 'stiffness'"),
        (
            ONE_BODY + "[[joint_spring]]\nfreedom = 'b.s1'\nstiffness = 'k'\n",
            r"joint_spring 1: stiffness: .*'k'",
        ),
        (ONE_BODY + "[[joint_spring]]\nfreedom = 'c.s1'\nstiffness = 1\n", r"there is no coordinate 'c\.s1'"),
        (
            ONE_BODY + "[[drive]]\nfreedom = 'b.s1'\neffort = 'sinh(t)'\n",
            r"drive 1: .*there is no function 'sinh'",
        ),
        (
            ONE_BODY + "[[drive]]\nfreedom = 'b.s1'\neffort = 'k*t'\n",
            r"drive 1: expression 'k' in expression 'k\*t': the name is not known",
        ),
        (ONE_BODY + "[[drive]]\nfreedom = 'b.s1'\neffort = 't.real'\n", r"only x and y have elements"),
        (ONE_BODY + "[[drive]]\nfreedom = 'b.s1'\neffort = 't**999'\n", r"drive 1: .*a huge power"),
        (
            ONE_BODY + "[[drive]]\nfreedom = 'b.s1'\neffort = [1]\n",
            r"drive 1: expression: \[.*is not a number",
        ),
        (
            ONE_BODY + "[[point_load]]\npoint = 'q'\nforce = [1, 2, 3]\n",
            r"point_load 1: there is no point or frame 'q'",
        ),
        (
            ONE_BODY + "[[potential]]\nenergy = 'y.b.s1'\n",
            r"potential 1: potential energy 'y\.b\.s1' depends on",
        ),
        (ONE_BODY + "joint.orientation_angles = [0,0,1]\njoint.orientation = 1\n", r"Keep one"),
    ],
)
def test_errors(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(ReadError, match=message) as caught:
        read_toml(tmp_path, text)
    assert re.match(rf"{re.escape(str(tmp_path / 'model.toml'))}(:\d+)?: ", str(caught.value))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("name = 'a'\nmass = \n", r"model\.toml:2: not valid TOML: Invalid value\."),
        ("name = 'a'\nname = 'b'\n", r"model\.toml:2: not valid TOML: Cannot overwrite a value\."),
        ("name = 'a'\nx.ö = 1\n", r"model\.toml:2: .*for a key part\. A key with .* between \"quotes\"\."),
        ("name = 'a'\n\nx = [1,", r"model\.toml:3: not valid TOML: "),
        (f"mass = {'1' * 5000}\n", r"model\.toml: not valid TOML: Exceeds the limit"),
        (f"mass = {'[' * 20000}\n", r"model\.toml: its arrays are nested too deeply"),
    ],
)
def test_syntax_errors(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(ReadError, match=message):
        read_toml(tmp_path, text)


def test_file_errors(tmp_path: Path) -> None:
    with pytest.raises(ReadError, match=r"nowhere\.toml: there is no such file"):
        load(tmp_path / "nowhere.toml")
    folder = tmp_path / "folder.toml"
    folder.mkdir()
    with pytest.raises(ReadError, match=r"folder\.toml: this is a folder"):
        load(str(folder))
    with pytest.raises(ReadError, match=r"cannot be read: .*null"):
        load("a\0.toml")
    latin = tmp_path / "latin.toml"
    latin.write_bytes(b"# ok\n# caf\xe9\n")
    with pytest.raises(ReadError, match=r"latin\.toml:2: byte 0xe9 is not UTF-8"):
        load(latin)
    with pytest.raises(ReadError, match=r"model\.json: kanegen reads \.toml, \.urdf and \.xml files\.$"):
        load("model.json")
    with pytest.raises(ReadError, match=r"arm\.xacro: .* Run xacro on it first"):
        load("arm.xacro")
    with pytest.raises(ReadError, match=r"None is not the path of a file"):
        load(None)  # type: ignore[arg-type]  # what a user may pass
    with pytest.raises(OptionError, match=r"floating_base is for URDF files"):
        load("model.toml", floating_base=True)
