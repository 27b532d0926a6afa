"""Python's search for cyclic garbage, paused during long work that makes many objects and no cycles of them.

The search looks at all objects again and again while programs grow, which took a fifth of the time of
generating code. Objects outside of cycles are freed at once all the same.
"""

from __future__ import annotations

import gc
import os
from collections.abc import Iterator
from contextlib import contextmanager

_PAUSES: list[object] = []
"""One entry for every pause that has turned the search off and not on again yet."""


@contextmanager
def paused_search() -> Iterator[None]:
    """Pause the search for cyclic garbage in this process, unless it is off already."""
    if not gc.isenabled():
        yield
        return
    gc.disable()
    pause = object()
    _PAUSES.append(pause)
    try:
        yield
    finally:
        if pause in _PAUSES:
            _PAUSES.remove(pause)
            gc.enable()


def _resume() -> None:
    """Turn the search on in a forked process, which lacks the thread that would do so."""
    if _PAUSES:
        _PAUSES.clear()
        gc.enable()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_resume)
