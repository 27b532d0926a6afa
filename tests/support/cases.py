"""Cases of a test of which few run on every change and the others only in `make slow`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest


def slow_except(cases: Iterable[Any], *fast: Any) -> list[Any]:
    """Return all `cases` for `pytest.mark.parametrize`, those that are not among `fast` marked as slow."""
    return [case if case in fast else pytest.param(case, marks=pytest.mark.slow) for case in cases]


def slow_among(cases: Iterable[Any], *slow: Any) -> list[Any]:
    """Return all `cases` for `pytest.mark.parametrize`, those that are among `slow` marked as slow."""
    return [pytest.param(case, marks=pytest.mark.slow) if case in slow else case for case in cases]
