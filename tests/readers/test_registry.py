"""The registry of readers: a further format is one module and one entry."""

from __future__ import annotations

from pathlib import Path

import pytest

import kanegen as kg
from kanegen.errors import OptionError, ReadError
from kanegen.model.body import Body
from kanegen.model.system import System
from kanegen.readers import load, registry
from kanegen.readers.reader import ModelFile, Reader, ReadOptions

INERTIA = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def read_masses(file: ModelFile, options: ReadOptions) -> System:
    """Read one free body for each line that contains a mass."""
    masses = [float(line) for line in file.text.split()]
    return System(file.path.stem, tuple(Body(f"b{k}", k, mass, INERTIA) for k, mass in enumerate(masses)))


def read_worldbody(file: ModelFile, options: ReadOptions) -> System:
    """Read the masses of the `<body>` elements of a chain."""
    masses = [element.number("mass") for element in file.root.all("body")]
    return System("chain", tuple(Body(f"b{k}", k, mass, INERTIA) for k, mass in enumerate(masses)))


@pytest.fixture
def toys(monkeypatch: pytest.MonkeyPatch) -> None:
    """Register a text format, and an XML format that shares its suffix with URDF."""
    toys = (Reader("masses", ".masses", read_masses), Reader("CHAIN", ".urdf", read_worldbody, root="chain"))
    monkeypatch.setattr(registry, "READERS", (*registry.READERS, *toys))


@pytest.mark.usefixtures("toys")
def test_a_registered_reader_is_found_by_suffix(tmp_path: Path) -> None:
    file = tmp_path / "three.masses"
    file.write_text("1.0\n2.0\n3.0\n")
    system = kg.load(file)
    assert (system.name, [body.mass for body in system.bodies]) == ("three", [1.0, 2.0, 3.0])


@pytest.mark.usefixtures("toys")
def test_readers_of_one_suffix_are_told_apart_by_root_elements(tmp_path: Path) -> None:
    file = tmp_path / "one.urdf"
    file.write_text('<chain><body mass="2"/></chain>')
    assert [body.mass for body in load(file).bodies] == [2.0]
    file.write_text('<robot><link name="a"/></robot>')
    with pytest.raises(ReadError, match="no joint of this robot moves"):
        load(file)
    file.write_text("\n<sdf/>")
    message = (
        r"one\.urdf:2: the top element is <sdf>, but URDF files have <robot> and CHAIN files have <chain>\."
    )
    with pytest.raises(ReadError, match=message):
        load(file)


@pytest.mark.usefixtures("toys")
def test_the_message_for_an_unknown_suffix_names_every_format(tmp_path: Path) -> None:
    with pytest.raises(ReadError, match=r"kanegen reads \.toml, \.urdf, \.xml and \.masses files\."):
        load(tmp_path / "model.sdf")


def test_every_reader_has_a_lower_case_suffix_and_a_format_of_its_own() -> None:
    assert all(reader.suffix == reader.suffix.lower() for reader in registry.READERS)
    keys = [(reader.suffix, reader.root) for reader in registry.READERS]
    assert len(set(keys)) == len(keys) == len({reader.format for reader in registry.READERS})


def test_a_floating_base_is_for_robot_files(tmp_path: Path) -> None:
    with pytest.raises(OptionError, match=r"model\.toml: floating_base is for URDF files"):
        load(tmp_path / "model.toml", floating_base=True)
