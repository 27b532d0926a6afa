"""The floating-point environment of the process, which loading a library must leave as it is.

gcc before 13 links code into shared libraries made with -ffast-math that switches subnormal numbers off for
the whole process. `kanegen.library.native.build` links without that code; this module finds libraries that
others have linked with it.
"""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from kanegen.errors import BuildError

_SIZE = 512
"""Bytes for a `fenv_t`, more than any C library needs."""

_HALF_ULP = sys.float_info.epsilon / 2.0
"""Half the distance from 1 to the next double."""


@contextmanager
def unchanged(path: Path) -> Iterator[None]:
    """Return a context in which the library `path` is loaded without a change of the environment.

    Raises:
        BuildError: If loading it changed the environment, which is then restored.
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
    """Return results that show whether subnormal numbers are kept and in which direction is rounded."""
    tiny, one = sys.float_info.min, 1.0
    return (
        tiny * 0.5,
        (tiny * 0.5) * 2.0,
        one + 0.6 * _HALF_ULP,
        one - 0.3 * _HALF_ULP,
        -one - 0.6 * _HALF_ULP,
    )


def _saved() -> ctypes.Array[ctypes.c_char] | None:
    """Return the environment as C keeps it, or None where C cannot be asked."""
    environment = ctypes.create_string_buffer(_SIZE)
    try:
        return environment if _libm().fegetenv(environment) == 0 else None
    except (OSError, TypeError, AttributeError):
        return None


def _libm() -> ctypes.CDLL:
    """Return the functions of this process, among which the interpreter has those of libm."""
    return ctypes.CDLL(None)
