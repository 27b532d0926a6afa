"""The machine on which times are taken: processor, compiler and package versions, but not its name."""

from __future__ import annotations

import os
import platform
import re
from importlib import metadata
from pathlib import Path

from kanegen.library.native import compilers

PACKAGES = ("libpinocchio", "cmeel-eigen", "casadi", "mujoco", "pydy", "sympy", "numpy")
"""Packages whose versions a description names, because programs that are timed depend on them."""

INSTRUCTION_SETS = ("avx2", "fma", "avx512f")
"""Vector instruction sets that a description names where the processor has them."""


def description() -> list[str]:
    """Describe the machine in three lines: processor, C compiler, versions of Python and packages.

    Raises:
        BuildError: If there is no C compiler.
    """
    return [
        f"{_processor()}, {os.cpu_count()} cores, {platform.system()} {platform.machine()}",
        compilers.find().version,
        f"Python {platform.python_version()}, {', '.join(map(_package_version, PACKAGES))}",
    ]


def _processor() -> str:
    """Return the name, family, model and vector instruction sets of the processor."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return platform.processor() or "unknown processor"
    fields = dict(re.findall(r"^(model name|cpu family|model|flags)\s*: (.*)$", text, flags=re.MULTILINE))
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
