"""Scripts that run in Octave."""

from __future__ import annotations

import subprocess
from pathlib import Path


def octave(code: str, folder: Path) -> str:
    """Run code in Octave in a folder and return what it prints."""
    (folder / "script_of_test.m").write_text(f"{code}\ndisp('done')\n")
    done = subprocess.run(
        ["octave", "--no-gui", "--norc", "--quiet", "script_of_test.m"],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
        timeout=300,
    )
    printed = done.stdout
    assert "done" in printed.splitlines(), printed  # its status may be 1 at the end of a good run
    return printed
