"""Programs and packages that tests of embedding need, which are not those of every test.

A test names what it needs: `@pytest.mark.embed("cargo", "jax")`. Where one is missing the test fails with the
line that installs it; `python -m tests.embedding` installs them first.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import dataclass
from importlib import metadata, util


@dataclass(frozen=True)
class Program:
    """A command of the system.

    Attributes:
        command: Its name on the path.
        debian: Packages of Debian that bring it.
        version: Arguments with which it prints its version.
    """

    command: str
    debian: tuple[str, ...]
    version: tuple[str, ...] = ("--version",)

    @property
    def install(self) -> str:
        """The line that installs it."""
        return f"apt-get install -y --no-install-recommends {' '.join(self.debian)}"

    def is_missing(self) -> bool:
        """Return whether it is not on the path."""
        return shutil.which(self.command) is None

    def describe(self) -> str:
        """Return its name and version; versions differ in form from program to program."""
        command = [self.command, *self.version]
        printed = subprocess.run(command, capture_output=True, text=True, check=False)
        line = re.search(r"^.*\d\.\d.*$", printed.stdout + printed.stderr, flags=re.MULTILINE)
        return f"{self.command}: {line[0].strip() if line else 'unknown version'}"


@dataclass(frozen=True)
class Package:
    """A Python package.

    Attributes:
        module: Its name in `import`.
        extra: Extra of kanegen that brings it.
        distribution: Its name in the package index, where it is another one.
    """

    module: str
    extra: str
    distribution: str = ""

    @property
    def install(self) -> str:
        """The line that installs it."""
        return f"pip install 'kanegen[{self.extra}]'"

    def is_missing(self) -> bool:
        """Return whether it cannot be imported."""
        return util.find_spec(self.module) is None

    def describe(self) -> str:
        """Return its name and version."""
        name = self.distribution or self.module
        return f"{name}: {metadata.version(name)}"


def _programs() -> dict[str, Program]:
    cortex = ("gcc-arm-none-eabi", "libnewlib-arm-none-eabi")
    return {
        program.command: program
        for program in (
            Program("aarch64-linux-gnu-gcc", ("gcc-aarch64-linux-gnu", "libc6-dev-arm64-cross")),
            Program("arm-none-eabi-gcc", cortex),
            Program("avr-gcc", ("gcc-avr", "avr-libc", "arduino-core-avr")),
            Program("cargo", ("cargo",)),
            Program("cppcheck", ("cppcheck",)),
            Program("mkoctfile", ("octave-dev",)),
            Program("node", ("nodejs",)),
            Program("npm", ("npm",)),
            Program("octave", ("octave",)),
            Program("qemu-aarch64", ("qemu-user",)),
            Program("qemu-system-arm", ("qemu-system-arm",)),
            Program("qemu-x86_64", ("qemu-user",)),
            Program("rustup", ("rustup",)),
            Program("simavr", ("simavr",)),
            Program("wine", ("wine", "wine64")),
        )
    }


def _packages() -> dict[str, Package]:
    return {
        package.module: package
        for package in (
            Package("fmu_manipulation_toolbox", "fmi-importers", "fmu-manipulation-toolbox"),
            Package("jax", "jax"),
            Package("libcosimpy", "fmi-importers"),
            Package("numba", "numba"),
            Package("torch", "torch"),
        )
    }


TOOLS: dict[str, Program | Package] = {**_programs(), **_packages()}
"""Every tool that a test may name."""


def missing(name: str) -> str:
    """Return one line that says that a tool is missing and how to install it, "" if it is there."""
    tool = TOOLS[name]
    return f"{name} is not installed: {tool.install}" if tool.is_missing() else ""
