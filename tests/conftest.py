"""Options of the whole suite, and a cache of compiled libraries of its own."""

from __future__ import annotations

import os

import pytest
from hypothesis import HealthCheck, settings

from tests.support.paths import ROOT

# How long an example takes says how busy a machine is, not what is wrong.
settings.register_profile("any machine", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("any machine")

os.environ["KANEGEN_CACHE"] = str(ROOT / ".pytest_cache" / "kanegen")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--update-generated", action="store_true", help="rewrite generated/ instead of comparing with it"
    )
