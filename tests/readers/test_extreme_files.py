"""Model files with huge, deep or strange parts: one error in one bounded line, in bounded time."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

import kanegen as kg
from kanegen.errors import LONGEST_MESSAGE

BODY = """[[body]]
name = "b"
connection = 0
mass = 1
inertia = [1, 1, 1]
joint.free = ["theta3"]
"""
PLACES = {
    "mass": BODY.replace("mass = 1", "mass = @"),
    "inertia": BODY.replace("[1, 1, 1]", "@"),
    "free": BODY.replace('["theta3"]', "@"),
    "name": BODY.replace('"b"', "@"),
    "connection": BODY.replace("connection = 0", "connection = @"),
    "locked": f"{BODY}joint.locked.theta1 = @",
    "sequence": f"{BODY}joint.sequence = @",
    "points": f"{BODY}points = @",
    "effort": f"{BODY}[[drive]]\nfreedom = 'b.theta3'\neffort = @",
    "ends": f"{BODY}[[spring]]\nstiffness = 1\nbetween = @",
    "gravity": f"gravity = @\n{BODY}",
    "parameter": f"parameters.k = @\n{BODY}",
    "outputs": f"outputs.body_poses = @\n{BODY}",
    "system": f"name = @\n{BODY}",
    "unknown key": f"zzz = @\n{BODY}",
}
VALUES = {
    **{f"arrays {depth} deep": "[" * depth + "1" + "]" * depth for depth in (5, 200, 320, 340, 500, 5000)},
    **{f"tables {depth} deep": "{a = " * depth + "1" + "}" * depth for depth in (5, 200, 320, 340, 900)},
    "3600 digits": "7" * 3600,
    "5000 digits": "7" * 5000,
    "a megabyte": f'"{"a" * 10**6}"',
    "control characters": r'"\u001b[31m\n\u202e"',
    "a date": "1979-05-27T07:32:00Z",
    "a long list": f"[{'1, ' * 10**4}]",
}
KEYS = {
    "dots": f"a{'.a' * 20_000} = 1\n{BODY}",
    "dots in a joint": f"{BODY}joint{'.a' * 20_000} = 1",
    "dots in points": f"{BODY}points{'.a' * 20_000} = [0, 0, 0]",
    "dots between quotation marks": f"""a{'."a"' * 20_000} = 1\n{BODY}""",
    "dots and spaces": f"a{' . a' * 20_000} = 1\n{BODY}",
    "a table": f"[{'a.' * 20_000}a]\nx = 1",
    "an array of tables": f"[[{'a.' * 20_000}a]]\nx = 1",
    "a megabyte": f'"{"k" * 10**6}" = 1\n{BODY}',
}
TAGS = {
    "robot": f'<robot name="{"n" * 10**6}"><link name="a"/></robot>',
    "links": f'<robot><link name="{"n" * 10**6}"/><link name="{"n" * 10**6}"/></robot>',
    "tag": f"<{'n' * 10**6}/>",
    "mass": f'<robot><link name="a"><inertial><mass value="{"1" * 10**6}"/></inertial></link></robot>',
    "vector": f'<robot><link name="a"><inertial><origin xyz="{"1 " * 10**5}"/></inertial></link></robot>',
    "depth": f"<robot>{'<link>' * 20_000}{'</link>' * 20_000}</robot>",
}
SECONDS = 10.0
"""Limit of the processor time of one file: a megabyte takes a second or less."""


def message(file: Path) -> str:
    """Return the error that a file raises, which must be one bounded line."""
    began = time.process_time()
    with pytest.raises(kg.ReadError) as caught:
        kg.generate(kg.load(file))
    assert time.process_time() - began < SECONDS
    text = str(caught.value)
    assert text.startswith(str(file))
    assert text.isprintable()
    assert len(text) <= LONGEST_MESSAGE // 4
    return text


@pytest.mark.parametrize("place", PLACES)
def test_values(place: str, tmp_path: Path) -> None:
    for name, value in VALUES.items():
        file = tmp_path / "model.toml"
        file.write_text(PLACES[place].replace("@", value), encoding="utf-8")
        assert message(file), name


@pytest.mark.parametrize("name", KEYS)
def test_keys(name: str, tmp_path: Path) -> None:
    file = tmp_path / "model.toml"
    file.write_text(KEYS[name], encoding="utf-8")
    assert ("more than 100 dots" in message(file)) == (name != "a megabyte")


def test_dots_elsewhere_are_no_keys(tmp_path: Path) -> None:
    """Numbers, names and expressions may have any number of dots."""
    effort = " + ".join(f'0.1*x.b.theta3 - 1.5*x["b.theta3"]*{k}.5' for k in range(60))
    file = tmp_path / "model.toml"
    file.write_text(f"# {'1.2 ' * 200}\n{BODY}[[drive]]\nfreedom = 'b.theta3'\neffort = '{effort}'\n")
    assert len(kg.load(file).force_elements) == 1


@pytest.mark.parametrize("name", TAGS)
def test_robots(name: str, tmp_path: Path) -> None:
    file = tmp_path / "robot.urdf"
    file.write_text(TAGS[name], encoding="utf-8")
    assert message(file)
