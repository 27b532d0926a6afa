"""Options of the whole suite, and what keeps it quick: a cache of its own, cheap compilation, rare collection."""

from __future__ import annotations

import gc
import os
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

ROOT = Path(__file__).parents[1]

os.environ["KANEGEN_CACHE"] = str(ROOT / ".pytest_cache" / "kanegen")
os.environ.setdefault("SYMPY_CACHE_SIZE", "100000")  # read when SymPy is imported; a process derives many systems

gc.set_threshold(100_000, 50, 50)  # derivations make millions of small objects, hardly any of them in circles

# How long an example takes says how busy a machine is, not what is wrong.
settings.register_profile("any machine", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("any machine")


def compile_without_optimisation() -> None:
    """Let every library that is built with the flags of its variant compile at -O0 instead of -O2.

    With strict semantics no bit depends on the level, which tests/c proves with flags of its own. Compilation
    then takes a sixth of the time. Commands that tests run as processes keep the flags of a user.
    """
    from kanegen.library.native import selftest

    sound_flags = selftest.sound_flags

    def flags(compiler: object, source: object) -> tuple[str, ...]:
        return tuple("-O0" if flag == "-O2" else flag for flag in sound_flags(compiler, source))

    selftest.sound_flags = flags


compile_without_optimisation()


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--update-generated", action="store_true", help="rewrite generated/ instead of comparing with it"
    )
