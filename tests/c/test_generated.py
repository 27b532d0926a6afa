"""generated/ holds the C of every model, byte for byte; `--update-generated` rewrites it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import kanegen as kg
from tests.support.paths import MODEL_FILES, ROOT


@pytest.mark.parametrize("model", MODEL_FILES, ids=lambda path: path.stem)
def test_generated_is_current(model: Path, request: pytest.FixtureRequest) -> None:
    source = kg.generate(kg.load(model))
    folder = ROOT / "generated" / model.stem
    if request.config.getoption("--update-generated"):
        source.write(folder)
    committed = {path.name: path.read_text(encoding="utf-8") for path in folder.iterdir()}
    assert committed == dict(source.files), "run `make generated` if the change is meant"


def test_no_model_is_missing_and_none_is_left_over() -> None:
    assert {path.name for path in (ROOT / "generated").iterdir()} == {path.stem for path in MODEL_FILES}


HASHES = """
import hashlib, sys
import kanegen as kg
for path in sys.argv[1:]:
    for name, text in kg.generate(kg.load(path)).files.items():
        print(name, hashlib.sha256(text.encode()).hexdigest())
"""


def test_same_bytes_for_every_hash_seed() -> None:
    models = [str(ROOT / "models" / name) for name in ("gantry_crane.toml", "scara.toml")]
    printed = {
        subprocess.run(
            [sys.executable, "-c", HASHES, *models],
            env={"PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("0", "4242")
    }
    assert len(printed) == 1
    assert "gantry_crane.c" in printed.pop()
