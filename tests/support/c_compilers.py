"""C and C++ compilers that tests call, their flags, and what compiled examples print."""

import os
import shutil
import subprocess
import sys

WARNINGS = """-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wdouble-promotion -Wmissing-prototypes
-Wstrict-prototypes -Werror""".split()
ZIG = (sys.executable, "-m", "ziglang")
"""clang as a package; stands in where the machine has none of its own."""

SANITIZERS = "-g -ffp-contract=off -fsanitize=address,undefined -fno-sanitize-recover=all".split()
C = {"gcc": ("gcc",), "clang": ("clang",) if shutil.which("clang") else (*ZIG, "cc")}
"""Commands of the C compilers by name."""

CPP = {"g++": ("g++",), "clang++": ("clang++",) if shutil.which("clang++") else (*ZIG, "c++")}
"""Commands of the C++ compilers by name."""


def run(*command, folder, **environment):
    """Return what a command prints in `folder`; it must succeed."""
    result = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, env={**os.environ, **environment}, check=False
    )
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


def code(name):
    """Return the files and libraries that are compiled and linked with a program."""
    return f"{name}.c", f"{name}_batch.c", "-lm"


def printed(text):
    """Return the numbers that the example prints, by function and array."""
    found = {}
    for line in text.splitlines():
        if "=" not in line:
            function = line
            continue
        target, value = line.split(" = ")
        found.setdefault((function, target.split("[")[0]), []).append(float(value))
    return found
