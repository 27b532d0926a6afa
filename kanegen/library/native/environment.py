"""Limits that environment variables set."""

from __future__ import annotations

import math
import os

from kanegen.errors import BuildError

COMPILE_SECONDS = "KANEGEN_COMPILE_SECONDS"
"""Variable with the time limit of a compiler, s."""

CACHE_MEGABYTES = "KANEGEN_CACHE_MB"
"""Variable with the size, in MB, beyond which the cache drops what was not used for the longest time."""

_DEFAULTS = {COMPILE_SECONDS: 1800.0, CACHE_MEGABYTES: 1024.0}
"""Value of each variable where it is not set."""


def limit(variable: str) -> float:
    """Return the limit that a variable sets; "inf" is none.

    Raises:
        BuildError: If the variable holds no number, or a negative one.

    Example:
        >>> limit(COMPILE_SECONDS)
        1800.0
    """
    text = os.environ.get(variable, "").strip()
    if not text:
        return _DEFAULTS[variable]
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not value >= 0.0:
        raise BuildError(f"${variable}: {text!r} is not a number from 0 to inf.")
    return value


def compile_seconds() -> float | None:
    """Return the time limit of a compiler, s; None is no limit.

    Raises:
        BuildError: If the variable holds no limit.
    """
    seconds = limit(COMPILE_SECONDS)
    return seconds if math.isfinite(seconds) else None
