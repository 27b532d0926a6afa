"""OpenMP in processes that were forked: the threads of the process before the fork are not in the new one.

gcc's OpenMP runtime does not notice a fork and waits for those threads for ever. It never waits where it uses
one thread, so batches use one thread in a process that was forked from one with OpenMP threads.
"""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Callable
from pathlib import Path

import cffi

_RUNTIME = "libgomp.so.1"
"""gcc's OpenMP runtime, which other libraries may also use."""

_IMPORTED_IN = os.getpid()
"""The process in which this module was imported."""

_started_in: list[int] = []
"""The process, or one before a fork of it, in which OpenMP may have started threads; empty if none has."""


def before_batch(path: Path) -> Callable[[], None] | None:
    """Return a function to call before each batch of a loaded library, or None if it has no OpenMP.

    Args:
        path: Path of the shared library.

    Raises:
        OSError: If the library cannot be loaded.
    """
    ffi = cffi.FFI()
    ffi.cdef("void omp_set_num_threads(int);")
    try:
        set_threads: Callable[[int], None] = ffi.dlopen(str(path), ffi.RTLD_NOW).omp_set_num_threads
    except AttributeError:
        return None
    if not _started_in:
        _started_in.append(_IMPORTED_IN if _is_running() else os.getpid())

    def use_one_thread_after_a_fork() -> None:
        if os.getpid() != _started_in[0]:
            set_threads(1)

    return use_one_thread_after_a_fork


def _is_running() -> bool:
    """Return whether this process was forked and had the runtime before it loaded a library of kanegen."""
    return os.getpid() != _IMPORTED_IN and _is_loaded(_RUNTIME)


def _is_loaded(library: str) -> bool:
    """Return whether this process has loaded a library."""
    if sys.platform == "win32":
        return False
    try:
        ctypes.CDLL(library, mode=os.RTLD_NOLOAD | os.RTLD_NOW)
    except OSError:
        return False
    return True
