"""What facades say on the rows of arrays of loads that functions read."""

from pathlib import Path

import pytest

import kanegen as kg
from kanegen.artifacts.loads import with_rows_read
from kanegen.c.interface import Function
from tests.support.paths import MODELS

FILES = {
    "cpp": "satellite.hpp",
    "rust": "rust/src/model.rs",
    "octave": "+satellite/forcing.m",
    "wasm": "wasm/satellite.d.ts",
}


@pytest.fixture(scope="module")
def satellite() -> kg.Source:
    """Code of a satellite, of which the bus takes loads and both panels take none."""
    return kg.generate(kg.load(MODELS / "satellite.toml"), outputs="forcing", artifacts=list(FILES))


@pytest.mark.parametrize("target", FILES)
def test_comments_name_the_rows_that_are_read(target: str, satellite: kg.Source) -> None:
    words = satellite.files[FILES[target]].replace("/", " ").replace("*", " ").replace("%", " ").split()
    text = " ".join(words)
    for unit in ("N", "N m"):
        assert f"Eq. (37); only the row of 'bus' is read ({unit})" in text


def forcing_of(folder: Path, loaded: str, name: str = "bus") -> Function:
    """Return the forcing function of the satellite with loads on some bodies, whose first has a name."""
    text = (MODELS / "satellite.toml").read_text().replace("loads = true ", " ")
    for body in loaded.split():
        text = text.replace(f'name = "{body}"\n', f'name = "{body}"\nloads = true\n')
    file = folder / "satellite.toml"
    file.write_text(text.replace('"bus"', f'"{name}"'))
    source = kg.generate(kg.load(file), outputs="forcing")
    return with_rows_read(source.functions[0], source.model, lambda text: text.replace("*/", ""))


@pytest.mark.parametrize(
    ("loaded", "end"),
    [
        ("bus left_panel", "; the row of 'right_panel' is not read"),
        ("right_panel", "; only the row of 'right_panel' is read"),
        ("bus left_panel right_panel", ", body components, Eq. (37)"),
    ],
)
def test_the_shorter_list_of_rows_is_named(loaded: str, end: str, tmp_path: Path) -> None:
    force = next(one for one in forcing_of(tmp_path, loaded).inputs if one.name == "force")
    assert force.doc.endswith(end)


def test_names_become_parts_of_the_other_language(tmp_path: Path) -> None:
    force = next(one for one in forcing_of(tmp_path, "bus", name="a*/b").inputs if one.name == "force")
    assert force.doc.endswith("; only the row of 'ab' is read")
