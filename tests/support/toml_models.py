"""Models as the text of TOML files."""

from __future__ import annotations

from pathlib import Path

from kanegen.model.system import System
from kanegen.readers import load

ONE_BODY = '[[body]]\nname = "b"\nconnection = 0\nmass = 1\n'
"""The table of one body on the ground."""


def read_toml(folder: Path, text: str) -> System:
    """Write `text` to a file `model.toml` in `folder` and load it."""
    file = folder / "model.toml"
    file.write_text(text, encoding="utf-8")
    return load(file)
