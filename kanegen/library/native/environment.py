"""The floating-point environment of the process, which loading a library must leave as it is.

gcc before 13 links code into shared libraries made with -ffast-math that switches subnormal numbers off for
whoever loads them. `kanegen.library.native.build` links without it; what somebody else has linked is caught
here.
"""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from kanegen.errors import BuildError

_ROOM = 512
"""Bytes, more than any `fenv_t`."""

_HALF_ULP = sys.float_info.epsilon / 2.0


@contextmanager
def unchanged(path: Path) -> Iterator[None]:
    """Load the library `path` inside; put the environment back if that changes it.

    Raises:
        BuildError: If it did.
    """
    before, saved = _arithmetic(), _saved()
    yield
    if _arithmetic() != before:
        if saved is not None:
            _libm().fesetenv(saved)
        raise BuildError(
            f"{path}: loading it changes the floating-point arithmetic of the whole process, which has been "
            "undone. Build it without -ffast-math and -Ofast, or name the flags that they stand for."
        )


def _arithmetic() -> tuple[float, ...]:
    """Results that tell whether subnormal numbers are kept and how is rounded."""
    tiny, one = sys.float_info.min, 1.0
    return (
        tiny * 0.5,
        (tiny * 0.5) * 2.0,
        one + 0.6 * _HALF_ULP,
        one - 0.3 * _HALF_ULP,
        -one - 0.6 * _HALF_ULP,
    )


def _saved() -> ctypes.Array[ctypes.c_char] | None:
    """The environment as C keeps it; None where there is no way to ask."""
    room = ctypes.create_string_buffer(_ROOM)
    try:
        return room if _libm().fegetenv(room) == 0 else None
    except (OSError, TypeError, AttributeError):
        return None


def _libm() -> ctypes.CDLL:
    """The process itself, in which the interpreter has libm."""
    return ctypes.CDLL(None)
