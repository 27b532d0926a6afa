"""acados from the package index, in a folder of its own.

Its package comma-deps-acados brings a reduced CasADi under the name casadi, which would replace the whole
one, so it is unpacked beside and only the part of acados is used.
"""

from __future__ import annotations

import os
import subprocess
import sys
import zipfile
from pathlib import Path

PACKAGE = "comma-deps-acados==0.2.2.post92"
"""Requirement that pip resolves; acados itself is on no package index."""


def environment(folder: Path) -> dict[str, str]:
    """Unpack acados into a folder and return the environment of processes that use it.

    Raises:
        AssertionError: If pip cannot download the package.
    """
    command = [
        sys.executable,
        "-m",
        "pip",
        "download",
        "--quiet",
        "--no-deps",
        "--dest",
        str(folder),
        PACKAGE,
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"acados is not installed: pip download --no-deps {PACKAGE}\n{done.stderr}"
    (wheel,) = folder.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder)
    (acados,) = folder.glob("*.data/purelib/acados")
    source = folder / "source"
    (source / "interfaces" / "acados_template").mkdir(parents=True)
    (source / "interfaces" / "acados_template" / "acados_template").symlink_to(acados / "acados_template")
    for part in ("lib", "include", "bin"):
        (source / part).symlink_to(acados / "install" / part)
    renderer = acados / "install" / "bin" / "t_renderer"
    renderer.chmod(0o755)
    return {
        **os.environ,
        "ACADOS_SOURCE_DIR": str(source),
        "LD_LIBRARY_PATH": str(acados / "install" / "lib"),
        "PYTHONPATH": str(acados),
        "TERA_PATH": str(renderer),
    }
