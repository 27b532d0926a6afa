"""Mutants of model files, expressions and arrays, made from seeds by a numbered random generator.

A mutant is a text, or arguments, with a few faults in it: numbers, names, values of other types, keys, lines
and characters are replaced, removed, doubled or exchanged. Mutant n of a kind is the same on every machine.
"""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

import kanegen as kg
from tests.support.paths import FROM_REPORTS, MODEL_FILES, ROOT

NUMBERS = (
    *("0", "1", "-1", "-0.0", "1e155", "-1e155", "1e308", "1e-308", "5e-324", "1e400", "nan", "inf", "-inf"),
    *(
        "1.5707963267948966",
        "3.141592653589793",
        "1e16",
        "0.1",
        "2",
        "9",
        "1e-9",
        "0x10",
        "1_000",
        "1__0",
        "07",
    ),
    *("7" * 3600, "9" * 5000, "1." + "3" * 400, "1e999999999", "true", "false", '""', '"a"', '"m"', "[]"),
    *("{}", "[1, 2, 3]", "[[1, 0, 0], [0, 1, 0], [0, 0, 1]]", "[" * 300 + "]" * 300, "1979-05-27", "'t'"),
)
"""Values that take the place of a number."""

NAMES = (
    *(
        "t",
        "x",
        "y",
        "sin",
        "pi",
        "tau",
        "force",
        "F_1_1",
        "theta_1_1",
        "epsilon_1_0",
        "ground",
        "all",
        "none",
    ),
    *(
        "lambda",
        "double",
        "main",
        "",
        " ",
        "a b",
        "a\tb",
        "\x1b[31m",
        "\u202e",
        "é",
        "名",
        "a" * 64,
        "b" * 100_000,
    ),
    *(
        "a.b",
        "a..b",
        "." * 20_000,
        "-",
        "a-b",
        "a:b",
        "A",
        "../../etc/passwd",
        "%s%n",
        "${x}",
        "$(id)",
        "'",
        "\\",
    ),
    *("body1", "body2", "arm", "quaternion", "angular_velocity", "3-1-3", "theta3", "s1"),
)
"""Names that take the place of a name."""

PLAIN_NUMBERS = (*NUMBERS[:22], "1", "0.5", "-2", "1e-12", "3.14159", "0.7854", "${x}", "1 2", "")
"""Numbers that take the place of a number of a robot file."""

TYPES = (
    "revolute",
    "continuous",
    "prismatic",
    "fixed",
    "floating",
    "planar",
    "spherical",
    "ball",
    "0 0 1",
    "0 0 0",
    "1 1 1",
    "1",
)
"""Types of joints and axes that take the place of an attribute of a robot file."""

TAGS = (
    "link",
    "joint",
    "inertial",
    "Inertial",
    "mass",
    "origin",
    "orgin",
    "axis",
    "visual",
    "xacro:if",
    "x:y",
)
"""Tags that take the place of a tag of a robot file."""

QUOTED = re.compile(r'"[^"\n]*"')
TAG = re.compile(r"(?<=<)[A-Za-z_:]+(?=[^<>]*/>)")
TOKEN = re.compile(r'"[^"\n]*"|[A-Za-z_][\w.-]*|[-+]?\d[\w.+-]*|\S')
NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
NAME = re.compile(r'"[^"\n]*"|[A-Za-z_]\w*')

TOML = (
    """name = "crane"
gravity = [0, 0, "g"]
[parameters]
g = -9.81
m = 2.0
k = 30.0
[[body]]
name = "trolley"
connection = "ground"
mass = "m"
inertia = [0.1, 0.2, 0.3]
joint.free = ["s1"]
points = {hook = [0, 0, -0.1], lamp = {position = [0.1, 0, 0], loads = true}}
[[body]]
name = "load"
connection = "trolley"
mass = 1.5
mass_center = [0, 0.1, -0.5]
inertia = {xx = 0.1, yy = 0.1, zz = 0.05, xy = 0.01}
loads = true
[body.joint]
name = "swing"
position = [0, 0, -0.1]
orientation_angles = [0.1, 1.5707963267948966, 0]
free = ["theta1", "theta2"]
locked = {theta3 = 0.3, s2 = 0.1}
[[joint_spring]]
freedom = "trolley.s1"
stiffness = "k"
damping = 0.5
[[drive]]
freedom = "load.theta1"
effort = "k*sin(t) - 0.1*y.load.theta1**3/(1 + x.load.theta2**2)"
[[potential]]
energy = "0.5*k*x.trolley.s1**2 + sqrt(1 + x.load.theta1**2)*cos(x.load.theta2)"
""",
    """[[body]]
connection = 0
mass = 3
inertia = [[1, 0.1, 0], [0.1, 2, 0], [0, 0, 2]]
joint.coordinates = "quaternion"
joint.position = [0, 0, 1]
points.a = [0, 1, 0]
[[body]]
connection = "body1"
mass = 0.5
mass_center = [0.2, 0, 0]
joint.free = ["theta2"]
joint.sequence = "3-1-3"
points.b = [1, 0, 0]
[[body]]
connection = 1
mass = 0.25
joint = {free = ["s3"], prescribed = ["theta1"]}
mass_center = [0, 0, 0.1]
[[spring]]
between = ["b", [0, 0, 2]]
stiffness = 10
rest_length = 0.5
damping = 0.1
[[point_load]]
point = "a"
force = ["0", "tan(0.1*t)", "abs(x.body3.s3)"]
[outputs]
body_poses = ["body2", 1]
""",
    """[parameters]
ratio = -0.4
[[body]]
name = "arm"
connection = "ground"
mass = 2
inertia = [0.1, 0.2, 0.2]
mass_center = [0.2, 0, 0]
joint = {name = "elbow", free = ["theta3"]}
[[body]]
name = "left"
connection = "arm"
mass = 0.5
inertia = [0.01, 0.02, 0.03]
joint = {position = [0.4, 0, 0], free = ["theta1", "s2"], armature = {s2 = 0.3}}
[[body]]
name = "right"
connection = "arm"
mass = 0.5
inertia = [0.01, 0.02, 0.03]
mass_center = [0, 0.1, 0]
joint = {name = "finger", position = [0.4, 0, 0], free = ["s2"]}
[[coupling]]
freedom = "finger"
terms = {"left.s2" = -1.0, elbow = 0.1}
offset = 0.02
[[coupling]]
freedom = "left.theta1"
terms = {elbow = "ratio"}
[[joint_spring]]
freedom = "right.s2"
stiffness = 3
""",
)
"""Three small model files with every kind of entry."""

URDF = """<robot name="rig">
  <link name="base"/>
  <link name="arm">
    <inertial><origin xyz="0.1 -0.2 0.05" rpy="0.3 0 0"/><mass value="3.5"/>
      <inertia ixx="0.11" iyy="0.13" izz="0.17" ixy="0.01" ixz="-0.02" iyz="0.015"/></inertial>
  </link>
  <link name="hand">
    <inertial><mass value="0.5"/>
      <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="arm"/><origin xyz="0 0 1" rpy="0 1.5708 0"/><axis xyz="0 1 0"/>
  </joint>
  <joint name="wrist" type="prismatic">
    <parent link="arm"/><child link="hand"/><origin xyz="0.4 0 0"/><axis xyz="1 0 0"/>
  </joint>
</robot>
"""
"""A small robot file."""

EXPRESSIONS = (
    "k*x.b.theta3 - 0.3*y.b.theta3*abs(y.b.theta3)",
    "sin(x.b.theta3)**2/(1 + cos(x.b.s1)**2) + sqrt(1 + t**2)",
    "tan(0.1*x.b.s1) - (2 - 3*(x.b.theta3 + 1))**-3",
    "sqrt(sqrt(1 + x.b.s1**2)*(2 + sin(x.b.theta3)))**3 + 1e-3",
    "y.b.s1/sqrt(y.b.s1**2 + 0.01) + k**2*t - -x.b.s1",
)
"""Expressions of the body `b` with the freedoms theta3 and s1, and of the parameter k."""

WORDS = (
    *(
        "x.b.theta3",
        "x.b.s1",
        "y.b.s1",
        "y.b.theta3",
        "x.b.s2",
        "t",
        "k",
        "x",
        "y",
        "z",
        "pi",
        "sin(",
        "cos(",
    ),
    *(
        "tan(",
        "sqrt(",
        "abs(",
        "exp(",
        "(",
        ")",
        "+",
        "-",
        "*",
        "/",
        "**",
        "**2",
        "**-3",
        "**0",
        "**64",
        "**65",
    ),
    *(
        "**0.5",
        "0",
        "1",
        "2",
        "1e155",
        "1e308",
        "1e-308",
        "0.5",
        "lambda:",
        "[",
        "]",
        ",",
        "'",
        '"',
        "\\",
        "#",
    ),
    *(
        " ",
        "\n",
        "\x00",
        "é",
        "if",
        "x.",
        '["',
        "1j",
        "~",
        "//",
        "==",
        ":=",
        "sqrt(1+" * 40,
        "sin(" * 90,
        "(" * 199,
    ),
)
"""Parts that are put into expressions."""


def small_models() -> tuple[str, ...]:
    """Return the texts of small model files: two made for mutants, and those of the repository up to 3 kB."""
    texts = [file.read_text(encoding="utf-8") for file in MODEL_FILES]
    return (*TOML, *(text for text in texts if len(text) <= 3000))


def toml_mutant(number: int) -> str:
    """Return mutant `number` of the model files."""
    return _text_mutant(small_models(), _TOML_CHANGES, f"toml {number}")


def urdf_mutant(number: int) -> str:
    """Return mutant `number` of the robot files."""
    every_joint = (ROOT / "tests/readers/data/every_joint.urdf").read_text(encoding="utf-8")
    reports = [
        path.read_text(encoding="utf-8", errors="replace") for path in sorted(FROM_REPORTS.glob("*.urdf"))
    ]
    return _text_mutant((every_joint, every_joint, URDF, URDF, *reports), _URDF_CHANGES, f"urdf {number}")


def mjcf_mutant(number: int) -> str:
    """Return mutant `number` of the models of MuJoCo."""
    files = ("every_force.xml", "equalities.xml", "mjcf/gymnasium/hopper.xml", "mjcf/gymnasium/ant.xml")
    seeds = [(ROOT / "tests/readers/data" / file).read_text(encoding="utf-8") for file in files]
    return _text_mutant(seeds, _URDF_CHANGES, f"mjcf {number}")


def _text_mutant(seeds: Sequence[str], changes: Sequence[Change], number: str) -> str:
    """Return a mutant of one of the seeds, with one change or several."""
    rng = random.Random(number)
    text = rng.choice(seeds)
    for _ in range(rng.choice((1, 1, 1, 2, 3, 8))):
        text = rng.choice(changes)(rng, text)
    return text


def expression_mutant(number: int) -> str:
    """Return mutant `number` of one of the expressions."""
    rng = random.Random(f"expression {number}")
    if rng.random() < 0.5:
        return _grown(rng, rng.choice((2, 3, 4, 6)))
    text = rng.choice(EXPRESSIONS)
    for _ in range(rng.choice((1, 1, 2, 3, 6))):
        words = TOKEN.findall(text) or [text]
        at = rng.randrange(len(words))
        change = rng.randrange(4)
        if change == 0:
            words[at] = rng.choice(WORDS)
        elif change == 1:
            words.insert(at, rng.choice(WORDS))
        elif change == 2:
            del words[at]
        else:
            begin, end = sorted(rng.randrange(len(words) + 1) for _ in range(2))
            part = "".join(words[begin:end])
            words[at:at] = [rng.choice(("sin(", "sqrt(", "abs(", "tan(", "-(", "1/(")), part, ")*"]
        text = "".join(words)
    return text


def _grown(rng: random.Random, depth: int) -> str:
    """Return a random expression that follows the grammar, of some depth."""
    if depth == 0 or rng.random() < 0.1:
        leaves = ("x.b.theta3", "x.b.s1", "k", "2", "0.3", "1", "0", "1e-3", "1e155", "7")
        return rng.choice((*leaves[:6], *leaves, "t", "y.b.s1", "y.b.theta3"))
    a = _grown(rng, depth - 1)
    match rng.randrange(10):
        case 0:
            return f"({a})**{rng.choice((-3, -2, -1, 0, 1, 2, 3, 4))}"
        case 1:
            return f"sqrt({a})**{rng.choice((-3, -1, 1, 3, 5))}"
        case 2 | 3:
            return f"{rng.choice(('sin', 'cos', 'tan', 'sqrt', 'abs'))}({a})"
        case 4:
            return f"-({a})"
    return f"({a}) {rng.choice('++--**/')} ({_grown(rng, depth - 1)})"


Change = Callable[[random.Random, str], str]
"""A change of a text by a random generator."""


def _replaced(pattern: re.Pattern[str], values: Sequence[str]) -> Change:
    """Return a change that replaces one place where a pattern fits by one of some values."""

    def change(rng: random.Random, text: str) -> str:
        places = list(pattern.finditer(text))
        if not places:
            return text
        place = rng.choice(places)
        value = rng.choice(values)
        if place[0].startswith('"') and not value.startswith(('"', "[", "{")):
            value = f'"{value}"'
        return text[: place.start()] + value + text[place.end() :]

    return change


def _another(pattern: re.Pattern[str]) -> Change:
    """Return a change that puts one place where a pattern fits in the place of another."""

    def change(rng: random.Random, text: str) -> str:
        places = list(pattern.finditer(text))
        if not places:
            return text
        one, two = rng.choice(places), rng.choice(places)
        return text[: one.start()] + two[0] + text[one.end() :]

    return change


def _lines(rng: random.Random, text: str) -> str:
    """Remove, double, move or cut lines."""
    lines = text.split("\n")
    at = rng.randrange(len(lines))
    change = rng.randrange(5)
    if change == 0:
        del lines[at]
    elif change == 1:
        lines.insert(at, rng.choice(lines))
    elif change == 2:
        lines.insert(rng.randrange(len(lines)), lines.pop(at))
    elif change == 3:
        lines[at] = lines[at][: rng.randrange(len(lines[at]) + 1)]
    else:
        lines[at:at] = lines[: rng.randrange(len(lines))]
    return "\n".join(lines)


def _characters(rng: random.Random, text: str) -> str:
    """Remove, double or replace characters, or cut the end off."""
    if not text:
        return text
    at = rng.randrange(len(text))
    change = rng.randrange(4)
    if change == 0:
        return text[:at] + text[at + rng.randrange(1, 4) :]
    if change == 1:
        return text[:at] + rng.choice("\x00\x07\x7f\x85\u2028\ufeff\"'[]{}<>=#&;.,-0\\\n\r\t") + text[at:]
    if change == 2:
        return text[:at]
    return text[:at] + chr(rng.randrange(32, 0x250)) + text[at + 1 :]


_TOML_CHANGES: tuple[Change, ...] = (
    *[_replaced(NUMBER, NUMBERS)] * 4,
    *[_replaced(NAME, NAMES)] * 2,
    *(_another(NUMBER), _another(NAME), _another(TOKEN), _lines, _lines, _characters),
)

_URDF_CHANGES: tuple[Change, ...] = (
    *[_replaced(NUMBER, PLAIN_NUMBERS)] * 6,
    *[_replaced(QUOTED, NAMES)] * 3,
    *[_replaced(QUOTED, TYPES)] * 2,
    *(_replaced(TAG, TAGS), _another(TAG)),
    *(_another(NUMBER), _another(NUMBER), _another(QUOTED), _another(QUOTED), _lines, _lines, _characters),
)

VALUES: tuple[Any, ...] = (
    *(
        None,
        True,
        "x",
        "",
        b"x",
        1j,
        [],
        {},
        object,
        np.nan,
        np.inf,
        -np.inf,
        0,
        -1,
        1,
        2.5,
        1e155,
        1e308,
        5e-324,
    ),
    *(10**3600, "a" * 10**5, np.array(1.0), np.zeros(3), np.zeros((2, 3)), np.array(["a"]), np.array([None])),
    *([1, [2]], [[1, 2], [3]], np.eye(3), np.eye(3, dtype=int), np.eye(3) * 1j, range(3), (1, 2, 3), {1, 2}),
    *(
        kg.Parameter("k", 2.0),
        kg.Parameter("t", 0.0),
        np.float32(1.5),
        np.int8(1),
        np.bool_(True),
        "quaternion",
    ),
    *("angular_velocity", "3-1-3", [0, 1], [0, 5], [1, 0], np.array([0, 1]), np.array([0.0, 1.0])),
)
"""Values that take the place of an argument or of an entry of one."""


def array_mutant(number: int) -> Mapping[str, Any]:
    """Return mutant `number` of the arguments of `System.from_arrays`."""
    rng = random.Random(f"arrays {number}")
    hinge = [False, False, True, False, False, rng.random() < 0.5]
    arguments: dict[str, Any] = {
        "connection": [0, 1],
        "mass": [1.0, 2.0],
        "inertia": [np.eye(3).tolist(), np.diag([0.1, 0.2, 0.3]).tolist()],
        "mass_center": [[0.1, 0, 0.2], [0, 0.3, 0.1]],
        "joint_position": [[0, 0, 0], [0.5, 0, 0.1]],
        "joint_orientation": [np.eye(3).tolist()] * 2,
        "free": [hinge, [True] * 6 if rng.random() < 0.3 else hinge],
        "locked": [[0.1, 0, 0, 0, 0, 0], [0, 0, 0, 0.2, 0, 0]],
        "gravity": [0, 0, -9.81],
        "loads": [False, True],
        "name": "arrays",
        "sequence": "1-2-3",
        "speeds": "angle_rates",
        "coordinates": "angles",
        "prescribed": [[False] * 6] * 2,
    }
    for _ in range(rng.choice((1, 1, 2, 3))):
        name = rng.choice(list(arguments))
        if rng.random() < 0.3:
            arguments[name] = rng.choice(VALUES)
        elif rng.random() < 0.2 and isinstance(arguments[name], list) and arguments[name]:
            arguments[name] = (
                arguments[name][:-1] if rng.random() < 0.5 else [*arguments[name], arguments[name][0]]
            )
        else:
            arguments[name] = _with_entry(rng, arguments[name])
    return arguments


def _with_entry(rng: random.Random, value: Any) -> Any:
    """Return nested lists with one entry replaced."""
    if not isinstance(value, list) or not value or rng.random() < 0.1:
        if isinstance(value, bool) and rng.random() < 0.8:
            return not value
        return rng.choice(VALUES if rng.random() < 0.3 else (0.0, 1.0, -1.0, 0.3, 1e-3, 100.0, 1e9))
    at = rng.randrange(len(value))
    return [_with_entry(rng, item) if i == at else item for i, item in enumerate(value)]
