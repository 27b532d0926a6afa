"""What the times were taken on, without the name of the machine."""

from __future__ import annotations

import os
import platform
import re
from importlib import metadata
from pathlib import Path

from kanegen.library.native import compilers

PACKAGES = ("libpinocchio", "cmeel-eigen", "casadi", "mujoco", "pydy", "sympy", "numpy")


def description() -> list[str]:
    """A line each: processor, compiler, versions.

    Raises:
        BuildError: If there is no C compiler.
    """
    return [
        f"{_processor()}, {os.cpu_count()} cores, {platform.system()} {platform.machine()}",
        compilers.find().version,
        f"Python {platform.python_version()}, {', '.join(map(_version, PACKAGES))}",
    ]


def _processor() -> str:
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return platform.processor() or "unknown processor"
    facts = dict(re.findall(r"^(model name|cpu family|model|flags)\s*: (.*)$", text, flags=re.MULTILINE))
    vectors = [flag for flag in ("avx2", "fma", "avx512f") if flag in facts.get("flags", "").split()]
    name = facts.get("model name", platform.processor())
    return f"{name} (family {facts.get('cpu family')}, model {facts.get('model')}; {' '.join(vectors)})"


def _version(package: str) -> str:
    try:
        return f"{package} {metadata.version(package)}"
    except metadata.PackageNotFoundError:
        return f"{package} missing"
