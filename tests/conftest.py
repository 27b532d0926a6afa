"""Options and the browser of the whole suite, and what keeps it quick: its own cache, cheap compilation."""

from __future__ import annotations

import gc
import importlib
import os
import signal
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

from tests.support.browser import chromium
from tests.support.paths import ROOT

os.environ["KANEGEN_CACHE"] = str(ROOT / ".pytest_cache" / "kanegen")
os.environ.setdefault("SYMPY_CACHE_SIZE", "100000")  # read when SymPy is imported

# A shell without job control starts background processes that ignore SIGINT, and so would all their children.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

gc.set_threshold(100_000, 50, 50)  # derivations make millions of small objects, hardly any of them in circles

# How long an example takes says how busy a machine is, not what is wrong.
settings.register_profile("any machine", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("any machine")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--update-generated", action="store_true", help="rewrite generated/ instead of comparing with it"
    )


def pytest_configure() -> None:
    """Compile what keeps strict semantics at -O0, unless a test names flags of its own.

    No bit depends on the level, as tests/c shows with levels of its own, and compilation takes a sixth of the
    time. Commands that tests run as processes compile as a user's do.
    """
    ownership: Any = importlib.import_module("kanegen.library.native.ownership")
    if ownership.objection(ROOT):  # the checkout belongs to somebody else than the user who tests it
        os.environ["KANEGEN_CACHE"] = str(Path(tempfile.gettempdir()) / f"kanegen-tests-{os.getuid()}")
    selftest: Any = importlib.import_module("kanegen.library.native.selftest")
    sound_flags = selftest.sound_flags

    def unoptimised(compiler: Any, source: Any) -> tuple[str, ...]:
        flags: tuple[str, ...] = sound_flags(compiler, source)
        is_strict = source.variant.is_strict
        return tuple("-O0" if flag == "-O2" and is_strict else flag for flag in flags)

    selftest.sound_flags = unoptimised


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """One browser for all tests of pages in a process."""
    with chromium() as found:
        yield found
