"""Regions from files and from the command line; errors name the file and the key."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import kanegen as kg
from kanegen.errors import OptionError, ReadError
from kanegen.studies.budget.region import Region, read_region, region_from_table, require_no_gimbal_lock
from kanegen.studies.budget.sampling import in_region, random_stream, sample_region
from kanegen.studies.tradeoff.exact_results import ExactResults
from tests.support import systems
from tests.support.paths import MODELS


@pytest.fixture(scope="module")
def pendulum() -> kg.System:
    return kg.load(MODELS / "double_pendulum.toml")


@pytest.fixture(scope="module")
def loaded() -> kg.System:
    """Return two bodies with an angle and a translation each, both with loads."""
    rng = np.random.default_rng(4)
    free = systems.flags(2, ["theta3", "s1"])
    return systems.random_system(rng, 2, connection=[0, 1], free=free, loads=True)


def range_of(found: Region, item: str, name: str) -> list[float]:
    return found.as_table()[item][name]


def test_a_file_with_everything(tmp_path: Path, pendulum: kg.System) -> None:
    file = tmp_path / "domain.toml"
    file.write_text(
        """
        [x]
        angles = [-1, 1]
        q2 = [0.25, 0.5]
        [y]
        q1 = 0.0
        [parameters]
        m1 = 3
        [exclude]
        cancellation = 1e4
        """
    )
    found = read_region(str(file), pendulum)
    assert range_of(found, "x", "q1") == [-1.0, 1.0]
    assert range_of(found, "x", "q2") == [0.25, 0.5]
    assert range_of(found, "y", "q1") == [0.0, 0.0]
    assert found.cancellation == 1e4
    assert {p.name: p.value for p in found.system.parameters}["m1"] == 3.0
    default = read_region(None, pendulum)
    assert range_of(found, "y", "q2") == range_of(default, "y", "q2")
    assert range_of(default, "x", "q1") == pytest.approx([-math.pi, math.pi])


def test_a_region_on_the_command_line(pendulum: kg.System) -> None:
    found = read_region("x.q1 = [0, 1]; exclude.cancellation = 100", pendulum)
    assert range_of(found, "x", "q1") == [0.0, 1.0]
    assert found.cancellation == 100.0


def test_ranges_of_loads(loaded: kg.System) -> None:
    table = {"force": {"all": [-1.0, 1.0], "body2": [[-1.0, 0.0], 2.0, [0.0, 3.0]]}}
    found = region_from_table(loaded, table).as_table()
    assert found["force"] == {
        "body1": [[-1.0, 1.0]] * 3,
        "body2": [[-1.0, 0.0], [2.0, 2.0], [0.0, 3.0]],
    }
    assert region_from_table(loaded, {}).as_table()["torque"] == found["torque"]
    only = region_from_table(loaded, {"x": {"translations": [-0.5, 0.5]}}).as_table()["x"]
    assert [name for name, ends in only.items() if ends == [-0.5, 0.5]] == ["body1.s1", "body2.s1"]


def test_a_table_makes_the_same_region_again(pendulum: kg.System, loaded: kg.System) -> None:
    tables = {
        pendulum.name: {"x": {"q1": [0.1, 0.7]}, "parameters": {"m2": 0.1}},
        loaded.name: {"exclude": {"cancellation": 10.0}, "torque": {"body1": [-0.1, 0.3]}},
    }
    for system in (pendulum, loaded):
        first = region_from_table(system, tables[system.name])
        again = region_from_table(system, first.as_table())
        assert again.as_table() == first.as_table()
        assert again.system == first.system
        assert (again.domain.low == first.domain.low).all()
        assert (again.domain.high == first.domain.high).all()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x.q1 = [1, 0]", r"x\.q1: the range \[1\.0, 0\.0\] is inverted\. Write \[0\.0, 1\.0\]"),
        ("x.q3 = 1", r"x: unknown key 'q3'.*'q1'"),
        ("z.q1 = 1", "unknown key 'z'"),
        ("x = 5", r"x: write a table \[x\]"),
        ("x.q1 = [0, 1, 2]", r"x\.q1: a range is \[low, high\]"),
        ("x.q1 = []", r"x\.q1: a range is \[low, high\]"),
        ("x.q1 = 'wide'", r"x\.q1: 'wide' is not a number"),
        ("x.q1 = [true, 1]", r"x\.q1: True is not a number"),
        ("x.q1 = [0, inf]", r"x\.q1: inf is not a finite number"),
        ("x.q1 = nan", r"x\.q1: nan is not a finite number"),
        ("x.q1 = 1" + "0" * 400, r"x\.q1: inf is not a finite number"),
        ("y.q1 = 1e60", r"y\.q1: 1e\+60 is beyond single precision"),
        ("x.translations = [0, 1]", r"x\.translations: system 'double_pendulum' has no translations"),
        ("force.upper = [0, 1]", "force: unknown key 'upper'"),
        ("parameters.m7 = 1", "parameters: unknown parameter 'm7'"),
        ("parameters.m1 = -1", "parameters: body 'upper': mass m1 = -1.0 kg is negative"),
        ("parameters.m1 = 'm2'", r"parameters\.m1: 'm2' is not a number"),
        ("exclude.everything = 1", "exclude: unknown key 'everything'"),
        ("exclude.clearance = -1", r"exclude\.clearance: -1\.0 is negative"),
        ("exclude.clearance = 1", r"exclude\.clearance: 1\.0 is not below 1"),
        ("x.q1 = [0, 1", "--domain:1: not valid TOML"),
        ("x.q1 = [0, 1]; x.q1 = 2", "--domain:2: not valid TOML"),
    ],
)
def test_texts_that_describe_no_region(text: str, message: str, pendulum: kg.System) -> None:
    with pytest.raises((OptionError, ReadError), match=message) as error:
        read_region(text, pendulum)
    assert str(error.value).startswith("--domain")


def test_errors_name_the_file(tmp_path: Path, pendulum: kg.System) -> None:
    file = tmp_path / "box.toml"
    with pytest.raises(ReadError, match=r"box\.toml: there is no such file"):
        read_region(str(file), pendulum)
    file.write_text("[x]\nq1 = [3, 1]\n")
    with pytest.raises(OptionError, match=r"box\.toml: x\.q1: the range"):
        read_region(str(file), pendulum)
    file.write_text("[x]\nq1 = = 1\n")
    with pytest.raises(ReadError, match=r"box\.toml:2: not valid TOML"):
        read_region(str(file), pendulum)
    file.write_bytes(b"\xff")
    with pytest.raises(ReadError, match=r"box\.toml:1: byte 0xff"):
        read_region(str(file), pendulum)
    file.write_text("x = " + "[" * 5000 + "]" * 5000)
    with pytest.raises(ReadError, match=r"box\.toml.*(nested|not valid)"):
        read_region(str(file), pendulum)


def test_gimbal_lock_must_be_excluded_unless_speeds_are_regular_there() -> None:
    body = kg.load(MODELS / "free_body.toml")
    name = body.freedom_names[1]
    with pytest.raises(OptionError, match=rf"cos\({name}\) = 0.*exclude\.clearance.*angular_velocity"):
        require_no_gimbal_lock(region_from_table(body, {}))
    require_no_gimbal_lock(region_from_table(body, {"exclude": {"clearance": 0.01}}))
    require_no_gimbal_lock(region_from_table(body, {"x": {name: [-1.5, 1.5]}}))
    with pytest.raises(OptionError, match=r"4\.5 to 5 meets"):
        require_no_gimbal_lock(region_from_table(body, {"x": {name: [4.5, 5.0]}}))
    require_no_gimbal_lock(region_from_table(body.with_speeds("angular_velocity"), {}))


def test_gimbal_lock_of_a_sequence_that_ends_as_it_begins() -> None:
    body = kg.load(MODELS / "free_body.toml")
    euler = replace(
        body, bodies=tuple(replace(b, joint=replace(b.joint, sequence="3-1-3")) for b in body.bodies)
    )
    name = euler.freedom_names[1]
    with pytest.raises(OptionError, match=rf"sin\({name}\) = 0"):
        require_no_gimbal_lock(region_from_table(euler, {"x": {name: [-1.0, 1.0]}}))
    require_no_gimbal_lock(region_from_table(euler, {"x": {name: [0.5, 2.5]}}))


def test_a_clearance_that_leaves_nothing_is_refused() -> None:
    body = kg.load(MODELS / "free_body.toml")
    name = body.freedom_names[1]
    with pytest.raises(OptionError, match="nothing of the box is left"):
        region_from_table(body, {"x": {name: [1.5, 1.6]}, "exclude": {"clearance": 0.5}})


def test_states_that_cancel_are_excluded(pendulum: kg.System) -> None:
    found = read_region("exclude.cancellation = 1.5", pendulum)
    exact = ExactResults(found.system)
    sample = sample_region(found, exact, 12, random_stream(0, "select", 0))
    assert len(sample) == 12
    assert max(state.conditioning.chi for state in exact.states(sample)) <= 1.5
    free = sample_region(read_region(None, pendulum), exact, 30, random_stream(0, "select", 0))
    assert 0 < sum(in_region(found, exact, free)) < 30
    with pytest.raises(OptionError, match=r"cancel less than 0\.5. Raise exclude\.cancellation"):
        sample_region(
            read_region("exclude.cancellation = 0.5", pendulum), exact, 4, random_stream(0, "select", 0)
        )


def test_random_streams_differ() -> None:
    numbers = {
        (seed, item, k): random_stream(seed, item, k).random()
        for seed in (0, 1)
        for item in ("select", "validate", "verify")
        for k in (0, 1)
    }
    assert len(set(numbers.values())) == len(numbers)
