"""The machine on which times are taken: processor, compiler and package versions, but not its name."""

from __future__ import annotations

import os
import platform
import re
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Self

from kanegen.library.native import compilers

PACKAGES = (
    "libpinocchio",
    "cmeel-eigen",
    "cmeel-cppadcodegen",
    "casadi",
    "mujoco",
    "frax",
    "jaxlib",
    "pydy",
    "sympy",
    "numpy",
)
"""Packages whose versions a description names, because programs that are timed depend on them."""

INSTRUCTION_SETS = ("avx2", "fma", "avx512f")
"""Vector instruction sets that a description names where the processor has them."""

AVX512, AVX2 = "AVX-512", "AVX2"
"""Names of vector instructions of x86-64 that not all of its processors have."""

_BASELINES = {"x86_64": "SSE2", "amd64": "SSE2", "aarch64": "NEON", "arm64": "NEON"}
"""Vector instructions that all processors of an architecture have."""


@dataclass(frozen=True)
class Machine:
    """A machine and its programs, in words.

    Attributes:
        processor: Name, family, model and vector instruction sets of the processor, and the number of cores.
        system: Operating system and kind of processor.
        libc: Name and version of the C library.
        compiler: Name and version of the C compiler that kanegen uses by default.
        versions: Versions of Python and of `PACKAGES`.
    """

    processor: str
    system: str
    libc: str
    compiler: str
    versions: str

    @classmethod
    def here(cls) -> Self:
        """Return the machine on which this process runs.

        Raises:
            BuildError: If there is no C compiler.
        """
        return cls(
            processor=f"{_processor()}, {os.cpu_count()} cores",
            system=f"{platform.system()} {platform.machine()}",
            libc=" ".join(platform.libc_ver()),
            compiler=compilers.find().version,
            versions=f"Python {platform.python_version()}, {', '.join(map(_package_version, PACKAGES))}",
        )

    def lines(self) -> list[str]:
        """Return three lines: processor and operating system, C compiler, versions."""
        return [f"{self.processor}, {self.system}", self.compiler, self.versions]


def baseline() -> str:
    """Return the vector instructions of every processor of this architecture; "" if they are not known."""
    return _BASELINES.get(platform.machine().lower(), "")


def widest() -> str:
    """Return the widest vector instructions of this processor, for which -march=native makes code.

    Example:
        >>> widest()
        'AVX-512'
    """
    present = _fields().get("flags", "").split()
    if "avx512f" in present:
        return AVX512
    return AVX2 if {"avx2", "fma"} <= set(present) else baseline()


def _fields() -> dict[str, str]:
    """Return the lines about the last processor in /proc/cpuinfo; empty where there is no such file."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return {}
    return dict(re.findall(r"^(model name|cpu family|model|flags)\s*: (.*)$", text, flags=re.MULTILINE))


def _processor() -> str:
    """Return the name, family, model and vector instruction sets of the processor."""
    fields = _fields()
    if not fields:
        return platform.processor() or "unknown processor"
    present = fields.get("flags", "").split()
    name = fields.get("model name", platform.processor())
    sets = " ".join(name for name in INSTRUCTION_SETS if name in present)
    return f"{name} (family {fields.get('cpu family')}, model {fields.get('model')}; {sets})"


def _package_version(package: str) -> str:
    """Return a package's name and version, or its name and "missing"."""
    try:
        return f"{package} {metadata.version(package)}"
    except metadata.PackageNotFoundError:
        return f"{package} missing"
