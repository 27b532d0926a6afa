"""Static analysis of generated C: clang-tidy finds nothing in any variant.

Five checks are left out. Functions take several arrays of one type, as C has no other way to name states.
Shifts have counts that are literals of type int. A source includes its header, not again what that includes.
The running minimum of the margins of accuracy is stored after the last of them, too, where nothing reads it.
What the operating system saves of a processor's registers is read by the one instruction that tells it.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import kanegen as kg
from kanegen.library.native.build import write
from tests.battery import bits, targets
from tests.support import systems

CHECKS = (
    *("bugprone-*", "cert-*", "clang-analyzer-*", "concurrency-*"),
    *("misc-*", "performance-*", "portability-*"),
)
LEFT_OUT = (
    *("bugprone-easily-swappable-parameters", "bugprone-signed-bitwise"),
    *("misc-include-cleaner", "clang-analyzer-deadcode.DeadStores", "portability-no-assembler"),
)
TIDY = shutil.which("clang-tidy", path=str(Path(sys.executable).parent)) or shutil.which("clang-tidy")


def findings(folder: Path, file: str) -> list[str]:
    """Return the lines that clang-tidy prints about a file and the headers that it includes."""
    checks = ",".join(["-*", *CHECKS, *(f"-{name}" for name in LEFT_OUT)])
    command = [str(TIDY), "--quiet", f"--checks={checks}", "--header-filter=.*", file, "--", "-std=c99"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    lines = (done.stdout + done.stderr).splitlines()
    return [line for line in lines if "warning:" in line or "error:" in line]


@pytest.mark.slow
@pytest.mark.parametrize("name", targets.VARIANTS)
def test_clang_tidy_finds_nothing(name: str, tmp_path: Path) -> None:
    assert TIDY, "clang-tidy comes with the extra test"
    system = systems.chain(6, ("theta1", "s2"))
    source = kg.generate(system, bits.OUTPUTS, tier=targets.VARIANTS[name])
    write({file: text for file, text in source.files.items() if file.endswith((".c", ".h"))}, tmp_path)
    for file in ("chain.c", "chain_batch.c", "main.c"):
        assert findings(tmp_path, file) == [], file


@pytest.mark.slow
def test_clang_tidy_sees_what_is_wrong(tmp_path: Path) -> None:
    assert TIDY, "clang-tidy comes with the extra test"
    text = "int read(int i);\nint read(int i)\n{\n    int a[3] = {0};\n    return a[i - i + 3];\n}\n"
    (tmp_path / "wrong.c").write_text(text)
    assert findings(tmp_path, "wrong.c")
