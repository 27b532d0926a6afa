"""The machine on which code is compiled and runs, as far as code may depend on it."""

from __future__ import annotations

import functools
import os
import platform
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

_LINUX_FIELDS = frozenset(
    {
        *("vendor_id", "cpu family", "model", "flags"),  # x86
        *("CPU implementer", "CPU architecture", "CPU variant", "CPU part", "Features"),  # Arm
        *("isa", "uarch", "mmu", "cpu", "machine"),  # RISC-V, POWER, S/390
    }
)
"""Fields of /proc/cpuinfo that say which instructions a processor has and how a compiler tunes for it."""

_TIME_LIMIT = 10.0
"""Time limit of a command that says which processor there is, s."""


@functools.cache
def fingerprint() -> str:
    """Return the operating system, the architecture, the C library and the features of the processor.

    Code that was compiled with `-march=native`, by whatever way the compiler was told so, and results of
    programs that ran here hold for machines with the same fingerprint only. The name of the machine is no
    part of it: a name may move to another processor.
    """
    parts = (platform.system(), platform.machine(), *platform.libc_ver(), features())
    return "\n".join(parts)


def usable() -> int:
    """Return the number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def features() -> str:
    """Return a text that differs between processors with different instructions, in no certain format."""
    if sys.platform == "linux":
        with suppress(OSError):
            return _linux_features(Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace"))
    if sys.platform == "darwin":
        with suppress(OSError, subprocess.SubprocessError):
            command = ["/usr/sbin/sysctl", "machdep.cpu.brand_string", "hw.optional"]
            return subprocess.run(
                command, capture_output=True, text=True, timeout=_TIME_LIMIT, check=False
            ).stdout
    return f"{platform.processor()} {platform.node()}"


def _linux_features(text: str) -> str:
    """Return the different lines of /proc/cpuinfo about instructions; cores of several kinds give several."""
    lines = (line.partition(":") for line in text.splitlines())
    found = {(name.strip(), " ".join(sorted(value.split()))) for name, _, value in lines}
    return "\n".join(f"{name}: {value}" for name, value in sorted(found) if name in _LINUX_FIELDS)
