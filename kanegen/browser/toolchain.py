"""The compiler and the linker for WebAssembly: clang with its linker, or those of the package ziglang."""

from __future__ import annotations

import functools
import os
import shlex
import shutil
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from kanegen.errors import BuildError
from kanegen.extras import is_installed
from kanegen.files import temporary_folder
from kanegen.library.native import commands, compilers

VARIABLE = "KANEGEN_WASM_CC"
"""Environment variable that may name a compiler for WebAssembly which takes the options of clang."""

_ZIG = (sys.executable, "-m", "ziglang")
"""Command of the package ziglang, whose parts are a compiler and a linker."""

_TIME_LIMIT = 120.0
"""Time limit of the compiler for a program of one line, s."""

_PROBE = "int one(void) { return 1; }\n"


@dataclass(frozen=True)
class Toolchain:
    """Commands that make WebAssembly.

    Attributes:
        compile: The compiler and its arguments for WebAssembly without a C library, without names of files.
        link: Command that links objects to a module.
        option: Text that must stand before every option of the linker, such as "-Wl,".
        fingerprint: A text that differs between toolchains that may make other code.
    """

    compile: tuple[str, ...]
    link: tuple[str, ...]
    option: str
    fingerprint: str

    def linker_options(self, options: tuple[str, ...]) -> tuple[str, ...]:
        """Return options of the linker as `link` takes them."""
        return tuple(f"{self.option}{one}" for one in options)


def find() -> Toolchain:
    """Find a compiler for WebAssembly: that of `VARIABLE`, clang with wasm-ld, or the package ziglang.

    Raises:
        BuildError: If there is none; the message says how to get one.
    """
    named = os.environ.get(VARIABLE)
    if named:
        found = _clang(named, f"${VARIABLE}")
        if (objection := _objection(found)) is not None:
            raise BuildError(f"${VARIABLE}: {named} makes no WebAssembly: {objection}")
        return found
    path = shutil.which("clang")
    objection = "it is not on the path."
    if path is not None:
        found = _clang(shlex.join((path,)), "clang")
        objection = _objection(found)
        if objection is None:
            return found
    if is_installed("ziglang"):
        return _zig()
    raise BuildError(
        f"no compiler for WebAssembly. clang: {objection} Do `pip install ziglang`, or install clang and lld "
        f"with the system's package manager, or name a compiler in ${VARIABLE}."
    )


def _clang(command: str, origin: str) -> Toolchain:
    """Return the toolchain of a compiler that takes the options of clang and calls its own linker."""
    try:
        compiler = compilers.find(command)
    except BuildError as error:
        raise BuildError(f"{origin}: {str(error).removeprefix('compiler: ')}") from None
    base = (*compiler.command, "--target=wasm32")
    return Toolchain(base, (*base, "-nostdlib"), "-Wl,", compiler.fingerprint)


def _zig() -> Toolchain:
    """Return the toolchain of the package ziglang."""
    compiler = compilers.find(shlex.join((*_ZIG, "cc")))
    return Toolchain(
        (*compiler.command, "-target", "wasm32-freestanding"), (*_ZIG, "wasm-ld"), "", compiler.fingerprint
    )


@functools.cache
def _objection(toolchain: Toolchain) -> str | None:
    """Return why a toolchain makes no module from one line of C; None if it does."""
    with temporary_folder(Path(tempfile.gettempdir())) as folder:
        (folder / "one.c").write_text(_PROBE, encoding="utf-8")
        options = toolchain.linker_options(("--no-entry", "--export=one"))
        try:
            commands.make([*toolchain.compile, "-c", "one.c", "-o", "one.o"], "one.o", folder, _TIME_LIMIT)
            commands.make([*toolchain.link, "-o", "one", "one.o", *options], "one", folder, _TIME_LIMIT)
        except commands.CommandError as error:
            return str(error)
    return None
