"""Options of the whole suite, and a cache of compiled libraries of its own."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

os.environ["KANEGEN_CACHE"] = str(Path(__file__).parent.parent / ".pytest_cache" / "kanegen")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--update-generated", action="store_true", help="rewrite generated/ instead of comparing with it"
    )
