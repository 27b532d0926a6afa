"""Tests of embedding with the marker `embed` fail, and do not skip, where what they need is missing."""

from __future__ import annotations

import pytest

from tests.support.tools import TOOLS, missing


def needs(item: pytest.Item) -> list[str]:
    """Return the tools that the markers of a test name."""
    return [str(name) for marker in item.iter_markers("embed") for name in marker.args]


def pytest_itemcollected(item: pytest.Item) -> None:
    """Refuse tools that tests.support.tools does not know how to install."""
    unknown = [name for name in needs(item) if name not in TOOLS]
    if unknown:
        names = ", ".join(unknown)
        raise pytest.UsageError(f"{item.nodeid}: no such tool in tests/support/tools.py: {names}")


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Fail before fixtures of a test use what is missing."""
    lines = [line for name in needs(item) if (line := missing(name))]
    if lines:
        pytest.fail("; ".join(lines), pytrace=False)
