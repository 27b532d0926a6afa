"""Platforms on which compiled code runs, and the compilers that make code for them."""

from __future__ import annotations

import platform as machine
import shlex
import sys
from collections.abc import Iterable
from dataclasses import dataclass

from kanegen.choices import chosen, several
from kanegen.errors import BuildError, OptionError, quoted
from kanegen.extras import is_installed
from kanegen.library.native import compilers


@dataclass(frozen=True)
class Platform:
    """An operating system on a kind of processor.

    Attributes:
        name: Its name in FMI 3.0, such as "x86_64-linux".
        target: Its name for the compiler of the package ziglang.
        suffix: End of the names of its shared libraries.
    """

    name: str
    target: str
    suffix: str


PLATFORMS = {
    platform.name: platform
    for platform in (
        Platform("x86_64-linux", "x86_64-linux-gnu.2.17", ".so"),
        Platform("aarch64-linux", "aarch64-linux-gnu.2.17", ".so"),
        Platform("x86_64-windows", "x86_64-windows-gnu", ".dll"),
        Platform("aarch64-windows", "aarch64-windows-gnu", ".dll"),
        Platform("x86_64-darwin", "x86_64-macos", ".dylib"),
        Platform("aarch64-darwin", "aarch64-macos", ".dylib"),
    )
}
"""The platforms by name. Code for Linux needs version 2.17 of the GNU C library, of 2012, or a later one."""

_PROCESSORS = {"amd64": "x86_64", "arm64": "aarch64"}
"""Further names of processors, as operating systems use them."""

_SYSTEMS = {"win32": "windows"}
"""Names of operating systems in Python that differ from those of FMI."""

_OTHER_SYSTEMS = {"macos": "darwin", "osx": "darwin", "mac": "darwin", "win": "windows", "win64": "windows"}
"""Further names of operating systems, as users write them."""


def host() -> Platform:
    """Return the platform of this machine.

    Raises:
        BuildError: If it is none of `PLATFORMS`.

    Example:
        host().name  # "x86_64-linux"
    """
    processor = machine.machine().lower()
    name = f"{_PROCESSORS.get(processor, processor)}-{_SYSTEMS.get(sys.platform, sys.platform)}"
    if name not in PLATFORMS:
        raise BuildError(f"this machine, {name}, is none of {', '.join(PLATFORMS)}. Name some of them.")
    return PLATFORMS[name]


def chosen_platforms(names: Iterable[str] | str | None = None) -> tuple[Platform, ...]:
    """Return platforms by their names, each once; without names that of this machine.

    Raises:
        OptionError: If there is no such platform.
        BuildError: If there are no names, and this machine has none in `PLATFORMS`.

    Example:
        chosen_platforms(["x86_64-windows", "x86_64-linux"])
    """
    for name in chosen(names) or ():
        _require_processor(name)
    found = several("platforms", "platform", names, PLATFORMS) if names is not None else ()
    return tuple(PLATFORMS[name] for name in found) or (host(),)


def _require_processor(name: object) -> None:
    """Make sure that the name of a platform is not that of an operating system alone.

    Raises:
        OptionError: If it is one; the message names its platforms.
    """
    text = str(name).lower()
    system = _OTHER_SYSTEMS.get(text, _SYSTEMS.get(text, text))
    known = [quoted(one) for one in PLATFORMS if one.partition("-")[2] == system]
    if known:
        raise OptionError(f"unknown platform {quoted(name)}. Did you mean {' or '.join(known)}?")


def compiler_for(platform: Platform) -> compilers.Compiler:
    """Return the C compiler that makes code for a platform, and the arguments that make it do so.

    Code for this machine is compiled by the compiler of `kanegen.build`, code for others by that of the
    package ziglang.

    Raises:
        BuildError: If there is none; the message says how to get it.
    """
    if is_host(platform):
        return compilers.find()
    if not is_installed("ziglang"):
        raise BuildError(
            f"platform {quoted(platform.name)}: there is no compiler for it. Do `pip install ziglang`."
        )
    return compilers.find(shlex.join((sys.executable, "-m", "ziglang", "cc", "-target", platform.target)))


def is_host(platform: Platform) -> bool:
    """Return whether a platform is that of this machine."""
    try:
        return platform == host()
    except BuildError:
        return False
