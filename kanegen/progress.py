"""Who is told how far the pipeline is."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[str], None]
"""Told the name of each stage as it begins."""


def quiet(stage: str) -> None:
    """Progress that nobody watches."""
